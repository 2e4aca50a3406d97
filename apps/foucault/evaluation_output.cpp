#include "evaluation_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/evaluation/statistics.h"
#include "text_file.h"
#include "version.h"

namespace foucault::app {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> methods_of(const std::vector<ExperimentResult>& results) {
  std::vector<std::string> methods;
  for (const ExperimentResult& result : results) {
    if (std::find(methods.begin(), methods.end(), result.method) == methods.end()) {
      methods.push_back(result.method);
    }
  }
  return methods;
}

std::size_t count_distinct(const std::vector<ExperimentResult>& results,
                           std::string ExperimentResult::*member) {
  std::set<std::string> names;
  for (const ExperimentResult& result : results) names.insert(result.*member);
  return names.size();
}

void require_outages(const std::vector<MethodOutages>& overall,
                     const std::vector<ExperimentResult>& results) {
  if (!overall.empty() && !overall.front().entries.empty()) return;
  for (const MethodOutages& o : overall) {
    const bool has_none = std::all_of(results.begin(), results.end(), [&](const auto& result) {
      return result.method != o.method || result.run.drifts.empty();
    });
    if (has_none) {
      throw DataError(fmt::format(
          "{}: gave nothing to measure in any outage; look at 'foucault run --method {}'", o.method,
          o.method));
    }
  }
  throw DataError("the methods have no outage in common; look at 'foucault run' of each");
}

Json estimate_json(const Estimate& e) {
  return {{"value", e.value}, {"low", e.low}, {"high", e.high}};
}

Json statistics_json(const std::vector<double>& values) {
  const Summary s = summarize(values);
  return {{"rms", estimate_json(s.rms)},       {"mean", estimate_json(s.mean)},
          {"median", estimate_json(s.median)}, {"p68", estimate_json(s.p68)},
          {"p95", estimate_json(s.p95)},       {"max", estimate_json(s.max)}};
}

/// RMS over the outages at each mark that all of them reach.
Json mark_json(const MethodOutages& outages, double DriftValue::*component) {
  Json json = Json::object();
  const std::vector<double>& marks_s = default_drift_marks_s();
  for (std::size_t i = 0; i < marks_s.size(); ++i) {
    std::vector<double> values;
    for (const MethodOutages::Entry& entry : outages.entries) {
      if (entry.drift->at_marks[i]) values.push_back((*entry.drift->at_marks[i]).*component);
    }
    if (values.size() != outages.entries.size()) continue;
    json[fmt::format("{}", marks_s[i])] = root_mean_square(values);
  }
  return json;
}

Json method_json(const MethodOutages& outages) {
  const std::vector<double> horizontal = outages.horizontal_max();
  const std::vector<double> vertical = outages.vertical_max();
  return {{"outages", outages.entries.size()},
          {"horizontal_rmse_m", root_mean_square(horizontal)},
          {"vertical_rmse_m", root_mean_square(vertical)},
          {"cpu_s", outages.cpu_s},
          {"missing_outages", outages.missing},
          {"horizontal_m", statistics_json(horizontal)},
          {"vertical_m", statistics_json(vertical)},
          {"horizontal_rms_m_after_s", mark_json(outages, &DriftValue::horizontal)},
          {"vertical_rms_m_after_s", mark_json(outages, &DriftValue::vertical)}};
}

Json methods_json(const std::vector<MethodOutages>& outages, const std::string& group) {
  Json json = Json::object();
  for (const MethodOutages& o : outages) {
    if (o.group == group && !o.entries.empty()) json[o.method] = method_json(o);
  }
  return json;
}

Json paired_json(const std::vector<double>& base, const std::vector<double>& other) {
  const PairedComparison c = compare_paired(base, other);
  return {{"base_rms_m", c.base_rms},
          {"other_rms_m", c.other_rms},
          {"difference_m", estimate_json(c.rms_difference)},
          {"relative", estimate_json(c.relative)},
          {"share_larger", c.share_larger},
          {"p_value", c.p_value}};
}

/// Each method against the first one of its group.
Json comparisons_json(const std::vector<MethodOutages>& outages) {
  Json json = Json::array();
  for (const MethodOutages& other : outages) {
    const auto base = std::find_if(outages.begin(), outages.end(),
                                   [&](const MethodOutages& o) { return o.group == other.group; });
    if (&*base == &other || other.entries.empty()) continue;
    json.push_back({{"group", other.group},
                    {"base", base->method},
                    {"other", other.method},
                    {"outages", other.entries.size()},
                    {"horizontal", paired_json(base->horizontal_max(), other.horizontal_max())},
                    {"vertical", paired_json(base->vertical_max(), other.vertical_max())}});
  }
  return json;
}

Json bin_json(const ProfileBin& bin) {
  Json methods = Json::object();
  for (const BinDrift& drift : bin.methods) {
    methods[drift.method] = {{"horizontal_rmse_m", estimate_json(drift.horizontal_m)},
                             {"vertical_rmse_m", estimate_json(drift.vertical_m)},
                             {"horizontal_relative", estimate_json(drift.horizontal_relative)},
                             {"vertical_relative", estimate_json(drift.vertical_relative)}};
  }
  return {{"from_km", bin.bin.from_km},
          {"to_km", bin.bin.to_km},
          {"mean_km", bin.mean_km},
          {"outages", bin.bin.outages.size()},
          {"methods", methods}};
}

/// Relative differences are from the first method.
Json distances_json(const std::vector<DistanceProfile>& profiles) {
  Json json = Json::array();
  for (const DistanceProfile& profile : profiles) {
    Json bins = Json::array();
    for (const ProfileBin& bin : profile.bins) bins.push_back(bin_json(bin));
    json.push_back({{"group", profile.group}, {"bins", bins}});
  }
  return json;
}

Json squares_json(const MethodNormalizedDrifts& method, const NormalizedDrift& drift,
                  const char* axis, const PooledSquares& squares) {
  return {{"group", method.group},
          {"method", method.method},
          {"after_s", drift.after_s},
          {"middle", drift.middle},
          {"axis", axis},
          {"mean_square", squares.mean},
          {"band_low", squares.band.low},
          {"band_high", squares.band.high},
          {"outages", squares.outages}};
}

/// An entry a group, method, time and axis; mean squares per degree of freedom.
Json normalized_json(const std::vector<MethodNormalizedDrifts>& methods) {
  Json json = Json::array();
  for (const MethodNormalizedDrifts& method : methods) {
    for (const NormalizedDrift& drift : method.times) {
      if (drift.horizontal.outages > 0) {
        json.push_back(squares_json(method, drift, "horizontal", drift.horizontal));
      }
      if (drift.vertical.outages > 0) {
        json.push_back(squares_json(method, drift, "vertical", drift.vertical));
      }
    }
  }
  return json;
}

Json returns_json(const std::vector<PooledReturns>& returns) {
  const auto number_or_null = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  Json json = Json::array();
  for (const PooledReturns& r : returns) {
    json.push_back({{"group", r.group},
                    {"method", r.method},
                    {"window_s", kReturnWindowS},
                    {"outages", r.outages},
                    {"horizontal_rms_m", r.rms_horizontal},
                    {"horizontal_max_m", r.max_horizontal},
                    {"median_settled_s", number_or_null(r.median_settled_s)},
                    {"max_settled_s", number_or_null(r.max_settled_s)},
                    {"never_settled", r.never_settled}});
  }
  return json;
}

const char* truth_name(DriftTruth truth) {
  return truth == DriftTruth::reference ? "reference" : "withheld_fixes";
}

Json runs_json(const std::vector<ExperimentResult>& results) {
  Json json = Json::array();
  for (const ExperimentResult& r : results) {
    json.push_back({{"recording", r.recording},
                    {"imu", r.imu},
                    {"method", r.method},
                    {"shift_s", r.shift_s},
                    {"truth", truth_name(r.run.truth)},
                    {"fixes_span_s", seconds_between(r.run.first_fix_ns, r.run.last_fix_ns)},
                    {"outages", r.run.drifts.size()},
                    {"scheduled_outages", r.run.scheduled},
                    {"cpu_s", r.run.cpu_s}});
  }
  return json;
}

std::string metrics_text(const EvaluationSummary& summary, const EvaluationLabels& labels) {
  Json json;
  json["methods"] = methods_json(summary.overall(), summary.overall().front().group);
  Json rows = Json::object();
  for (const MethodOutages& row : summary.rows()) {
    if (!rows.contains(row.group)) rows[row.group] = methods_json(summary.rows(), row.group);
  }
  json[summary.row_header() == "IMU" ? "imus" : "recordings"] = rows;
  json["comparisons"] = comparisons_json(summary.rows());
  json["distances"] = distances_json(summary.distances());
  json["normalized_drift"] = normalized_json(summary.normalized());
  json["after_return"] = returns_json(summary.returns());
  json["runs"] = runs_json(summary.results());
  json["interval"] = "95 % bootstrap over outages";
  json["command"] = labels.command_line;
  json["version"] = kVersion;
  json["config"] = labels.config;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_table(const TextTable& table, const std::filesystem::path& folder,
                 const std::string& name) {
  write_text_file(folder / (name + ".csv"), to_csv(table));
  write_text_file(folder / (name + ".md"), to_markdown(table));
}

void append_lines(std::vector<std::string>& lines, const std::string& text) {
  const std::vector<std::string> more = text_lines(text);
  lines.insert(lines.end(), more.begin(), more.end());
}

std::string truth_text(const std::vector<ExperimentResult>& results) {
  std::set<DriftTruth> truths;
  for (const ExperimentResult& result : results) truths.insert(result.run.truth);
  if (truths.size() > 1) return "the reference where there is one, else the withheld fixes";
  return *truths.begin() == DriftTruth::reference ? "the reference" : "the withheld fixes";
}

std::string lengths_text(const std::vector<MethodOutages>& overall) {
  std::set<double> lengths_s;
  for (const MethodOutages::Entry& entry : overall.front().entries) {
    const Outage& outage = entry.drift->outage;
    lengths_s.insert(seconds_between(outage.begin_ns, outage.end_ns));
  }
  if (lengths_s.size() == 1) return fmt::format("{:g} s", *lengths_s.begin());
  return fmt::format("{:g} to {:g} s", *lengths_s.begin(), *lengths_s.rbegin());
}

}  // namespace

EvaluationSummary::EvaluationSummary(std::vector<ExperimentResult> results)
    : results_(std::move(results)),
      methods_(methods_of(results_)),
      overall_(group_outages(results_, Grouping::all)),
      rows_(table_rows(results_)),
      row_header_(count_distinct(results_, &ExperimentResult::imu) > 1 ? "IMU" : "Recording"),
      normalized_(normalized_drifts(rows_)),
      returns_(pooled_returns(rows_)) {
  require_outages(overall_, results_);
  distances_ = distance_profiles(distance_groups());
}

const std::vector<MethodOutages>& EvaluationSummary::distance_groups() const {
  const bool together =
      row_header_ != "IMU" && count_distinct(results_, &ExperimentResult::recording) > 1;
  return together ? overall_ : rows_;
}

TextTable EvaluationSummary::rms_table() const {
  return drift_rms_table(method_drifts(rows_), row_header_);
}

TextTable EvaluationSummary::difference_table() const {
  return drift_difference_table(method_drifts(rows_), methods_.front());
}

TextTable EvaluationSummary::statistics_table() const {
  return drift_statistics_table(method_drifts(rows_), row_header_);
}

TextTable EvaluationSummary::normalized_table() const {
  return normalized_drift_table(normalized_, row_header_);
}

TextTable EvaluationSummary::return_table() const {
  return foucault::return_table(returns_, row_header_);
}

void write_evaluation(const EvaluationSummary& summary, const EvaluationLabels& labels,
                      const std::filesystem::path& folder) {
  const TextTable drifts =
      drift_record_table(drift_records(summary.results()), default_drift_marks_s());
  write_text_file(folder / "drift.csv", to_csv(drifts));
  write_text_file(folder / "metrics.json", metrics_text(summary, labels));
  if (!labels.config.empty()) write_text_file(folder / "config.yaml", labels.config);
  std::filesystem::create_directories(folder / "tables");
  write_table(summary.rms_table(), folder / "tables", "table_iii");
  write_table(summary.difference_table(), folder / "tables", "table_iv");
  write_table(summary.statistics_table(), folder / "tables", "statistics");
  write_table(summary.normalized_table(), folder / "tables", "normalized_drift");
  write_table(summary.return_table(), folder / "tables", "after_return");
  if (summary.distances().empty()) return;
  write_table(distance_table(summary.distances(), summary.row_header()), folder / "tables",
              "distance");
  write_table(distance_difference_table(summary.distances(), summary.row_header()),
              folder / "tables", "distance_difference");
}

std::string outages_text(const EvaluationSummary& summary) {
  const std::size_t recordings = count_distinct(summary.results(), &ExperimentResult::recording);
  return fmt::format("{} of {} in {} recording{}; truth: {}",
                     summary.overall().front().entries.size(), lengths_text(summary.overall()),
                     recordings, recordings == 1 ? "" : "s", truth_text(summary.results()));
}

std::vector<std::string> text_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::vector<std::string> evaluation_lines(const EvaluationSummary& summary) {
  std::vector<std::string> lines{"outages    " + outages_text(summary), ""};
  append_lines(lines, to_plain_text(summary.rms_table()));
  if (summary.methods().size() > 1) {
    lines.push_back("");
    append_lines(lines, to_plain_text(summary.difference_table()));
  }
  lines.push_back("");
  for (const MethodOutages& o : summary.overall()) {
    lines.push_back(fmt::format("{:<10} {:.1f} s CPU", o.method, o.cpu_s));
  }
  return lines;
}

}  // namespace foucault::app
