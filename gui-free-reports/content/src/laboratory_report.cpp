#include "foucault/content/laboratory_report.h"

#include <utility>

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

Section models_section(const LaboratoryReport& report) {
  Section section{"Models"};
  section.paragraphs = report.remarks;
  section.tables = report.tables;
  for (const LabQuantity quantity :
       {LabQuantity::position, LabQuantity::velocity, LabQuantity::attitude}) {
    section.figures.push_back(model_errors(report.motions, report.settings, quantity));
  }
  return section;
}

Section terms_section(const LaboratoryReport& report) {
  Section section{"Terms"};
  section.tables = report.term_tables;
  for (const LabQuantity quantity : {LabQuantity::position, LabQuantity::attitude}) {
    section.figures.push_back(ablation_dots(report.motions, report.settings, quantity));
  }
  return section;
}

}  // namespace

ReportPage laboratory_page(const LaboratoryReport& report) {
  ReportPage page;
  page.title = "Preintegration laboratory";
  page.subtitle = report.subtitle;
  page.key_numbers = report.key_numbers;
  page.sections.push_back(models_section(report));
  page.sections.push_back(terms_section(report));
  page.sections.push_back({"Rate and distance",
                           {},
                           {},
                           {rate_lines(report.motions, report.settings),
                            distance_lines(report.motions, report.settings)}});
  page.listings = report.listings;
  page.footer = report.footer;
  return page;
}

}  // namespace foucault::content
