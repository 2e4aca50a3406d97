#include "foucault/evaluation/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "count_distinct.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"

namespace foucault::evaluation {
namespace {

std::vector<std::string> methods_of(const std::vector<ExperimentResult>& results) {
  std::vector<std::string> methods;
  for (const ExperimentResult& result : results) {
    if (std::find(methods.begin(), methods.end(), result.method) == methods.end()) {
      methods.push_back(result.method);
    }
  }
  return methods;
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

void append_lines(std::vector<std::string>& lines, const TextTable& table) {
  for (const std::string& line : text_lines(to_plain_text(table))) lines.push_back(line);
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
  return evaluation::return_table(returns_, row_header_);
}

std::string outages_text(const EvaluationSummary& summary) {
  const std::size_t recordings = count_distinct(summary.results(), &ExperimentResult::recording);
  return fmt::format("{} of {} in {} recording{}; truth: {}",
                     summary.overall().front().entries.size(), lengths_text(summary.overall()),
                     recordings, recordings == 1 ? "" : "s", truth_text(summary.results()));
}

std::vector<std::string> evaluation_lines(const EvaluationSummary& summary) {
  std::vector<std::string> lines{"outages    " + outages_text(summary), ""};
  append_lines(lines, summary.rms_table());
  if (summary.methods().size() > 1) {
    lines.push_back("");
    append_lines(lines, summary.difference_table());
  }
  lines.push_back("");
  for (const MethodOutages& o : summary.overall()) {
    lines.push_back(fmt::format("{:<10} {:.1f} s CPU", o.method, o.cpu_s));
  }
  return lines;
}

}  // namespace foucault::evaluation
