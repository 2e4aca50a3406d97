#include "foucault/content/evaluation_report.h"

#include <utility>

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

Section overview(const EvaluationReport& report) {
  Section section{"Overview"};
  section.paragraphs = report.remarks;
  section.tables = report.tables;
  if (!report.ablation.empty()) {
    section.figures.push_back(ablation_bars(report.ablation, report.methods));
  }
  if (!report.rms.empty()) section.figures.push_back(drift_bars(report.rms, report.methods));
  return section;
}

Section case_section(const DriftCase& drift_case, const MethodOrder& order) {
  Section section{drift_case.name};
  section.figures = {drift_curves(drift_case, order),       maximum_drifts(drift_case, order),
                     drift_distribution(drift_case, order), drift_growth(drift_case, order),
                     outage_errors(drift_case, order),      end_errors(drift_case, order)};
  return section;
}

Section consistency(const EvaluationReport& report) {
  Section section{"Consistency in outages"};
  section.paragraphs = {
      "Innovations tell whether the noise of the IMU fits over the interval of the fixes. Over an "
      "outage the same noise has to explain errors a thousand times as large: the squares of the "
      "errors over the sigmas that the method gave for them are 1 in the mean if it does. Above "
      "the band the method is surer of itself than it may be, and will reject true fixes when they "
      "return; below, it is better than it says. A smoother is judged in the middle of the outage.",
      "Outages are taken as independent: noise of the IMU makes their drift, and each has its own. "
      "What lasts from one to the next (biases, attitude) makes the true band a little wider."};
  section.tables = report.consistency_tables;
  for (const NormalizedErrors& errors : report.normalized) {
    section.figures.push_back(normalized_drift(errors, report.methods));
  }
  return section;
}

Section distance(const EvaluationReport& report) {
  Section section{"Distance from the start"};
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
  Section section{"Recordings"};
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
  page.links = report.links;
  page.key_numbers = report.key_numbers;
  page.sections.push_back(overview(report));
  for (const DriftCase& drift_case : report.cases) {
    page.sections.push_back(case_section(drift_case, report.methods));
  }
  if (!report.consistency_tables.empty()) page.sections.push_back(consistency(report));
  if (!report.distances.empty()) page.sections.push_back(distance(report));
  Section last = recordings(report);
  if (!last.figures.empty()) page.sections.push_back(std::move(last));
  page.listings = report.listings;
  page.footer = report.footer;
  return page;
}

}  // namespace foucault::content
