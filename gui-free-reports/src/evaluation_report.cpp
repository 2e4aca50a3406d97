#include "foucault/reports/evaluation_report.h"

#include <utility>

namespace foucault::reports {
namespace {

Section overview(const EvaluationReport& report) {
  Section section;
  section.title = "Overview";
  section.paragraphs = report.remarks;
  section.tables = report.tables;
  if (!report.rms.empty()) section.figures.push_back(drift_bars(report.rms, report.methods));
  return section;
}

Section case_section(const DriftCase& drift_case, const MethodOrder& order) {
  Section section;
  section.title = drift_case.name;
  section.figures = {drift_curves(drift_case, order), maximum_drifts(drift_case, order),
                     drift_distribution(drift_case, order), drift_growth(drift_case, order)};
  return section;
}

Section distance(const EvaluationReport& report) {
  Section section;
  section.title = "Distance from the start";
  section.paragraphs = {
      "The distance is the straight line from the first fix of the recording to the first one "
      "withheld. The vertical turns by 0.157 mrad per kilometre: a method that takes gravity as "
      "constant in a frame fixed at the start sees the way travelled as a rotation, of 1 deg/h at "
      "30 m/s and 8 deg/h at 250 m/s."};
  section.tables = report.distance_tables;
  for (const DistanceDrift& drift : report.distances) {
    section.figures.push_back(drift_by_distance(drift, report.methods));
  }
  return section;
}

Section recordings(const EvaluationReport& report) {
  Section section;
  section.title = "Recordings";
  for (const OutageMap& map : report.maps) {
    section.figures.push_back(outage_map(map, report.methods));
  }
  for (const ErrorTimeline& timeline : report.timelines) {
    section.figures.push_back(error_timeline(timeline, report.methods));
  }
  return section;
}

}  // namespace

ReportPage evaluation_page(const EvaluationReport& report) {
  ReportPage page;
  page.title = report.title;
  page.subtitle = report.subtitle;
  page.key_numbers = report.key_numbers;
  page.sections.push_back(overview(report));
  for (const DriftCase& drift_case : report.cases) {
    page.sections.push_back(case_section(drift_case, report.methods));
  }
  if (!report.distances.empty()) page.sections.push_back(distance(report));
  Section last = recordings(report);
  if (!last.figures.empty()) page.sections.push_back(std::move(last));
  page.listings = report.listings;
  page.footer = report.footer;
  return page;
}

}  // namespace foucault::reports
