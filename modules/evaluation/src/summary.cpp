#include "foucault/evaluation/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/time.h"

namespace foucault::evaluation {
namespace {

void require_outages(const std::vector<MethodOutages>& overall) {
  if (!overall.empty() && !overall.front().empty()) return;
  for (const MethodOutages& o : overall) {
    if (o.measured > 0) continue;
    throw DataError(
        fmt::format("{}: gave nothing to measure in any outage; look at 'foucault run --method {}'",
                    o.method, o.method));
  }
  throw DataError("the methods have no outage in common; look at 'foucault run' of each");
}

std::string truth_text(const std::vector<RunFacts>& runs) {
  std::set<DriftTruth> truths;
  for (const RunFacts& run : runs) truths.insert(run.truth);
  if (truths.size() > 1) return "the reference where there is one, else the withheld fixes";
  return *truths.begin() == DriftTruth::reference ? "the reference" : "the withheld fixes";
}

std::string lengths_text(const MethodOutages& outages) {
  if (outages.shortest_s == outages.longest_s) return fmt::format("{:g} s", outages.longest_s);
  return fmt::format("{:g} to {:g} s", outages.shortest_s, outages.longest_s);
}

void append_lines(std::vector<std::string>& lines, const TextTable& table) {
  for (const std::string& line : text_lines(to_plain_text(table))) lines.push_back(line);
}

RunFacts facts_of(const ExperimentResult& result) {
  return {result.run.truth, seconds_between(result.run.first_fix_ns, result.run.last_fix_ns),
          static_cast<int64_t>(result.run.drifts.size()), result.run.scheduled, result.run.cpu_s};
}

}  // namespace

EvaluationSummary::EvaluationSummary(RunNames names) : names_(std::move(names)) {
  look_at_names();
  const bool several = recordings_ > 1;
  joins_.emplace_back(names_, Grouping::all, several && !by_imu());
  if (by_imu()) {
    joins_.emplace_back(names_, Grouping::imu);
  } else if (recordings_ <= kMostRows) {
    joins_.emplace_back(names_, Grouping::recording, !several);
  }
  shown_runs_ = ShownRuns(by_imu());
  runs_.reserve(names_.size);
}

EvaluationSummary::EvaluationSummary(const std::vector<ExperimentResult>& results) {
  std::vector<const ExperimentResult*> ordered;
  for (const auto& compared : compared_results(results)) {
    ordered.insert(ordered.end(), compared.begin(), compared.end());
  }
  const auto names = std::make_shared<std::vector<RunName>>();
  for (const ExperimentResult* result : ordered) names->push_back(*result);
  *this = EvaluationSummary({names->size(), [names](std::size_t i) { return (*names)[i]; }});
  for (const ExperimentResult* result : ordered) add(*result);
  finish();
}

void EvaluationSummary::look_at_names() {
  std::set<std::string> imus, recordings;
  for (std::size_t i = 0; i < names_.size; ++i) {
    const RunName name = names_.at(i);
    imus.insert(name.imu);
    recordings.insert(name.recording);
    if (std::find(methods_.begin(), methods_.end(), name.method) == methods_.end()) {
      methods_.push_back(name.method);
    }
  }
  recordings_ = recordings.size();
  row_header_ = imus.size() > 1 ? "IMU" : "Recording";
}

void EvaluationSummary::add(ExperimentResult result) {
  runs_.push_back(facts_of(result));
  if (!pending_.empty() && !pending_.front().is_compared_with(result)) join_pending();
  pending_.push_back(std::move(result));
}

void EvaluationSummary::join_pending() {
  std::vector<const ExperimentResult*> compared;
  for (const ExperimentResult& result : pending_) compared.push_back(&result);
  for (OutageJoin& join : joins_) join.add(compared);
  for (ExperimentResult& result : pending_) {
    if (!shown_runs_.place(result)) continue;
    result.run.drifts.clear();
    shown_.push_back(std::move(result));
  }
  pending_.clear();
}

void EvaluationSummary::finish() {
  join_pending();
  overall_ = joins_.front().take();
  if (joins_.size() > 1) rows_ = joins_.back().take();
  if (!by_imu() && (rows_.empty() || recordings_ > 1)) {
    rows_.insert(rows_.end(), overall_.begin(), overall_.end());
  }
  joins_.clear();
  require_outages(overall_);
  normalized_ = normalized_drifts(rows_);
  returns_ = pooled_returns(rows_);
  distances_ = distance_profiles(cases());
}

TextTable EvaluationSummary::rms_table() const { return drift_rms_table(rows_, row_header_); }

TextTable EvaluationSummary::difference_table() const {
  return drift_difference_table(rows_, methods_.front());
}

TextTable EvaluationSummary::statistics_table() const {
  return drift_statistics_table(rows_, row_header_);
}

TextTable EvaluationSummary::normalized_table() const {
  return normalized_drift_table(normalized_, row_header_);
}

TextTable EvaluationSummary::return_table() const {
  return evaluation::return_table(returns_, row_header_);
}

std::string outages_text(const EvaluationSummary& summary) {
  const std::size_t recordings = summary.recordings();
  return fmt::format("{} of {} in {} recording{}; truth: {}", summary.overall().front().size(),
                     lengths_text(summary.overall().front()), recordings,
                     recordings == 1 ? "" : "s", truth_text(summary.runs()));
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
