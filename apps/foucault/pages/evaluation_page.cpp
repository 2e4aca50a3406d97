#include "pages/evaluation_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "foucault/core/time.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::app {
namespace {

using content::DriftCase;
using content::DriftRms;
using content::ErrorTimeline;
using content::GroundPath;
using content::OutageMap;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kLongestLine = 5;  ///< over longer holes between points no line is drawn [s]

/// The runs of all methods over one recording with one shift.
using ComparedRuns = std::vector<const evaluation::ExperimentResult*>;

content::Bounded bounded(const evaluation::Estimate& e) { return {e.value, e.low, e.high}; }

content::OutageCurve curve(const evaluation::DrawnOutage& outage) {
  content::OutageCurve curve;
  curve.label = fmt::format("{}, shift {} s, outage {}", outage.recording, outage.shift_s,
                            outage.drift.outage.index + 1);
  for (const evaluation::DriftSample& sample : outage.drift.samples) {
    curve.since_begin_s.push_back(sample.since_begin_s);
    curve.horizontal_m.push_back(sample.horizontal());
    curve.vertical_m.push_back(sample.vertical());
    curve.north_m.push_back(sample.error_n.x());
    curve.east_m.push_back(sample.error_n.y());
  }
  curve.max_horizontal_m = outage.drift.maximum.horizontal;
  curve.max_vertical_m = outage.drift.maximum.vertical;
  return curve;
}

content::MethodCurves method_curves(const evaluation::MethodOutages& outages) {
  content::MethodCurves curves{outages.method, {}};
  for (const auto& outage : outages.drawn) curves.outages.push_back(curve(*outage));
  return curves;
}

/// A case a group, in order of appearance.
std::vector<DriftCase> drift_cases(const std::vector<evaluation::MethodOutages>& outages) {
  std::vector<DriftCase> cases;
  for (const evaluation::MethodOutages& o : outages) {
    if (o.empty()) continue;
    if (cases.empty() || cases.back().name != o.group) cases.push_back({o.group, {}, o.size()});
    cases.back().methods.push_back(method_curves(o));
  }
  return cases;
}

std::vector<DriftRms> drift_rms(const std::vector<evaluation::MethodOutages>& rows) {
  std::vector<DriftRms> rms;
  for (const evaluation::MethodOutages& row : rows) {
    if (row.empty()) continue;
    rms.push_back({row.group, row.method, bounded(evaluation::summarize(row.horizontal_max()).rms),
                   bounded(evaluation::summarize(row.vertical_max()).rms)});
  }
  return rms;
}

std::vector<ComparedRuns> shown_runs(const evaluation::EvaluationSummary& summary) {
  std::vector<ComparedRuns> shown;
  for (const evaluation::ExperimentResult& r : summary.shown()) {
    if (shown.empty() || !shown.back().front()->is_compared_with(r)) shown.emplace_back();
    shown.back().push_back(&r);
  }
  return shown;
}

std::string name_of(const ComparedRuns& runs, const evaluation::EvaluationSummary& summary) {
  return summary.row_header() == "IMU"
             ? fmt::format("{}, {}", runs.front()->imu, runs.front()->recording)
             : runs.front()->recording;
}

bool has_other_shift(const evaluation::RunName& shown, const evaluation::RunNames& names) {
  for (std::size_t i = 0; i < names.size; ++i) {
    const evaluation::RunName name = names.at(i);
    if (name.recording == shown.recording && name.shift_s != shown.shift_s) return true;
  }
  return false;
}

/// The recording, and which of its shifts is shown if there are several.
std::string shift_text(const std::string& name, const ComparedRuns& runs,
                       const evaluation::EvaluationSummary& summary) {
  const evaluation::RunName& shown = *runs.front();
  if (!has_other_shift(shown, summary.names())) return name;
  return fmt::format("{}, only the outages shifted by {} s", name, shown.shift_s);
}

/// Points with a mark where no line is to be drawn.
template <class Point>
void walk(const std::vector<evaluation::TrackPoint>& points, Point point,
          const std::function<void()>& gap) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0 && seconds_between(points[i - 1].t_ns, points[i].t_ns) > kLongestLine) gap();
    point(points[i]);
  }
}

ErrorTimeline::Curve timeline_curve(const evaluation::ExperimentResult& run) {
  ErrorTimeline::Curve curve{run.method, {}, {}};
  const auto put = [&](double t_s, double horizontal_m) {
    curve.t_s.push_back(t_s);
    curve.horizontal_m.push_back(horizontal_m);
  };
  walk(
      run.track,
      [&](const evaluation::TrackPoint& p) {
        put(seconds_between(run.run.first_fix_ns, p.t_ns), p.horizontal());
      },
      [&] { put(curve.t_s.back() + 0.5 * kLongestLine, kNaN); });
  return curve;
}

ErrorTimeline timeline(const ComparedRuns& runs, const std::string& name) {
  ErrorTimeline timeline{name, {}, {}};
  const evaluation::OutageRunResult& first = runs.front()->run;
  for (const evaluation::Outage& outage : first.withheld) {
    timeline.outages.push_back(
        {seconds_between(first.first_fix_ns, outage.begin_ns),
         seconds_between(first.first_fix_ns, std::min(outage.end_ns, first.last_fix_ns))});
  }
  for (const evaluation::ExperimentResult* run : runs)
    timeline.curves.push_back(timeline_curve(*run));
  return timeline;
}

void add(GroundPath& path, const Eigen::Vector3d& p_w) {
  path.north_m.push_back(p_w.x());
  path.east_m.push_back(p_w.y());
}

void add_gap(GroundPath& path) { add(path, Eigen::Vector3d::Constant(kNaN)); }

/// The points inside an outage.
std::vector<evaluation::TrackPoint> during(const evaluation::ExperimentResult& run,
                                           const evaluation::Outage& outage) {
  std::vector<evaluation::TrackPoint> points;
  std::copy_if(run.track.begin(), run.track.end(), std::back_inserter(points),
               [&](const evaluation::TrackPoint& p) {
                 return p.t_ns > outage.begin_ns &&
                        p.t_ns <= outage.end_ns + evaluation::kStampToleranceNs;
               });
  return points;
}

OutageMap outage_map(const ComparedRuns& runs, const std::string& name) {
  OutageMap map;
  map.name = name;
  const evaluation::ExperimentResult& first = *runs.front();
  if (first.track.empty()) return map;
  const geodesy::LocalFrame frame(first.track.front().position);
  const auto truth = [&](const evaluation::TrackPoint& p) -> Eigen::Vector3d {
    return frame.to_local(p.position) - frame.R_w_n(p.position) * p.error_n;
  };
  walk(
      first.track, [&](const evaluation::TrackPoint& p) { add(map.truth, truth(p)); },
      [&] { add_gap(map.truth); });
  for (const evaluation::Outage& outage : first.run.withheld) {
    for (const evaluation::TrackPoint& p : during(first, outage))
      add(map.truth_in_outages, truth(p));
    add_gap(map.truth_in_outages);
  }
  for (const evaluation::ExperimentResult* run : runs) {
    OutageMap::Estimate estimate{run->method, {}};
    for (const evaluation::Outage& outage : run->run.withheld) {
      for (const evaluation::TrackPoint& p : during(*run, outage)) {
        add(estimate.path, frame.to_local(p.position));
      }
      add_gap(estimate.path);
    }
    map.estimates.push_back(std::move(estimate));
  }
  return map;
}

content::DistanceDrift::Method distance_method(const evaluation::MethodOutages& outages,
                                               const evaluation::DistanceProfile& profile) {
  content::DistanceDrift::Method method;
  method.method = outages.method;
  for (const auto& outage : outages.drawn) {
    method.distance_km.push_back(outage->drift.distance_m * 1e-3);
    method.horizontal_m.push_back(outage->drift.maximum.horizontal);
    method.vertical_m.push_back(outage->drift.maximum.vertical);
  }
  for (const evaluation::ProfileBin& bin : profile.bins) {
    for (const evaluation::BinDrift& drift : bin.methods) {
      if (drift.method != outages.method) continue;
      method.bins.push_back({bin.mean_km, bounded(drift.horizontal_m), bounded(drift.vertical_m)});
    }
  }
  return method;
}

std::vector<content::DistanceDrift> distance_drifts(const evaluation::EvaluationSummary& summary) {
  std::vector<content::DistanceDrift> drifts;
  for (const evaluation::DistanceProfile& profile : summary.distances()) {
    content::DistanceDrift drift{profile.group, {}};
    for (const evaluation::MethodOutages& o : summary.cases()) {
      if (o.group != profile.group) continue;
      drift.methods.push_back(distance_method(o, profile));
      drift.all = o.size();
    }
    drifts.push_back(std::move(drift));
  }
  return drifts;
}

std::vector<page::Table> distance_tables(const evaluation::EvaluationSummary& summary) {
  if (summary.distances().empty()) return {};
  std::vector<page::Table> tables{
      report_table(evaluation::distance_table(summary.distances(), summary.row_header()),
                   "RMS over the outages of a bin of the largest drift in each, with the 95 % "
                   "bootstrap interval.")};
  if (summary.methods().size() > 1) {
    tables.push_back(report_table(
        evaluation::distance_difference_table(summary.distances(), summary.row_header()),
        "The interval is a 95 % bootstrap over the outages of the bin, drawn in pairs."));
  }
  return tables;
}

content::Bounded bounded(const evaluation::PooledSquares& squares) {
  if (squares.outages == 0) return {kNaN, kNaN, kNaN};
  return {squares.mean, squares.band.low, squares.band.high};
}

content::NormalizedErrors::Method normalized_method(
    const evaluation::MethodNormalizedDrifts& drifts, const std::vector<std::string>& times) {
  content::NormalizedErrors::Method method{drifts.method, {}, {}};
  for (const std::string& time : times) {
    const auto found = std::find_if(drifts.times.begin(), drifts.times.end(),
                                    [&](const evaluation::NormalizedDrift& drift) {
                                      return evaluation::time_text(drift) == time;
                                    });
    const evaluation::NormalizedDrift drift =
        found == drifts.times.end() ? evaluation::NormalizedDrift{} : *found;
    method.horizontal.push_back(bounded(drift.horizontal));
    method.vertical.push_back(bounded(drift.vertical));
  }
  return method;
}

/// An entry an IMU, else one for the last group: all recordings together, or the only one.
std::vector<content::NormalizedErrors> normalized_errors(
    const evaluation::EvaluationSummary& summary) {
  const std::vector<std::string> times = evaluation::times_of(summary.normalized());
  std::vector<content::NormalizedErrors> all;
  for (const evaluation::MethodNormalizedDrifts& drifts : summary.normalized()) {
    if (summary.row_header() != "IMU" && drifts.group != summary.rows().back().group) continue;
    if (all.empty() || all.back().name != drifts.group) all.push_back({drifts.group, times, {}});
    all.back().methods.push_back(normalized_method(drifts, times));
  }
  return all;
}

std::vector<page::Table> consistency_tables(const evaluation::EvaluationSummary& summary) {
  std::vector<page::Table> tables;
  if (!summary.normalized().empty()) {
    tables.push_back(report_table(
        summary.normalized_table(),
        "In brackets the band that holds the mean with 95 % if the sigmas are right (chi-square of "
        "2 or 1 degrees of freedom an outage). Where the truth is a withheld fix, its covariance "
        "is "
        "added."));
  }
  if (!summary.returns().empty()) {
    tables.push_back(report_table(
        summary.return_table(),
        "From the first fix after an outage on. Never: the error was still, or again, outside of "
        "the 3-sigma ellipse of the fixes when these seconds were over. Without a reference the "
        "fixes themselves are the truth, which the method has used: metres are real, centimetres "
        "say little."));
  }
  return tables;
}

std::vector<page::KeyNumber> key_numbers(const evaluation::EvaluationSummary& summary) {
  std::vector<page::KeyNumber> numbers;
  for (const evaluation::MethodOutages& o : summary.overall()) {
    numbers.push_back({fmt::format("{}, horizontal RMS", o.method),
                       fmt::format("{:.2f}", evaluation::root_mean_square(o.horizontal_max())), "m",
                       fmt::format("vertical {:.2f} m, {} outages",
                                   evaluation::root_mean_square(o.vertical_max()), o.size())});
  }
  return numbers;
}

std::vector<page::Table> report_tables(const evaluation::EvaluationSummary& summary) {
  std::vector<page::Table> tables{report_table(
      summary.rms_table(), "RMS over the outages of the largest drift in each, as in Table III.")};
  if (summary.methods().size() > 1) {
    tables.push_back(report_table(
        summary.difference_table(),
        "As in Table IV. The interval is a 95 % bootstrap over outages, drawn in pairs: where it "
        "holds zero, these outages do not tell the two methods apart."));
  }
  tables.push_back(report_table(summary.statistics_table()));
  return tables;
}

page::Table ablation_table(const evaluation::EvaluationSummary& summary,
                           const std::vector<evaluation::AblationCase>& ablation) {
  return report_table(
      evaluation::ablation_table(evaluation::ablation_rows(summary.overall(), ablation)),
      "RMS over the same outages of the largest drift in each; differences are from the same "
      "method with the configuration as it is. The interval is a 95 % bootstrap over outages, "
      "drawn in pairs: where it holds zero, these outages do not tell what the part is worth. "
      "Parts that the recordings have no use for are left out. All that follows is of the "
      "configuration as it is.");
}

}  // namespace

content::EvaluationReport evaluation_report(const evaluation::EvaluationSummary& summary,
                                            const EvaluationLabels& labels) {
  content::EvaluationReport report;
  report.title = labels.title;
  report.links = labels.links;
  report.subtitle = "Outages: " + evaluation::outages_text(summary);
  report.methods = summary.methods();
  report.remarks = labels.remarks;
  report.key_numbers = key_numbers(summary);
  report.tables = report_tables(summary);
  report.rms = drift_rms(summary.rows());
  report.cases = drift_cases(summary.cases());
  report.distances = distance_drifts(summary);
  report.distance_tables = distance_tables(summary);
  report.normalized = normalized_errors(summary);
  report.consistency_tables = consistency_tables(summary);
  for (const ComparedRuns& runs : shown_runs(summary)) {
    const std::string name = name_of(runs, summary);
    report.timelines.push_back(timeline(runs, name));
    report.maps.push_back(outage_map(runs, name));
    report.timelines.back().subtitle = report.maps.back().subtitle =
        shift_text(name, runs, summary);
  }
  const auto& [command_line, config, version] = labels.origin;
  if (!command_line.empty()) report.listings.push_back({"Command", command_line});
  if (!config.empty()) report.listings.push_back({"Configuration", config});
  report.footer = fmt::format("foucault {}", version);
  return report;
}

page::Table report_table(const evaluation::TextTable& table, const std::string& note) {
  return {table.title, note, false, table.header, table.rows};
}

content::EvaluationReport ablation_report(const evaluation::EvaluationSummary& summary,
                                          const evaluation::EvaluationSummary& as_configured,
                                          const EvaluationLabels& labels) {
  content::EvaluationReport report = evaluation_report(as_configured, labels);
  report.tables.insert(report.tables.begin(), ablation_table(summary, labels.ablation));
  for (const evaluation::AblationRow& row :
       evaluation::ablation_rows(summary.overall(), labels.ablation)) {
    report.ablation.push_back(
        {row.what.method, row.what.without, row.horizontal_rms_m, row.vertical_rms_m});
  }
  return report;
}

}  // namespace foucault::app
