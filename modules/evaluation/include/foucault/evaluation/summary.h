#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "foucault/evaluation/distance.h"
#include "foucault/evaluation/experiment.h"
#include "foucault/evaluation/outage_consistency.h"
#include "foucault/evaluation/outage_join.h"
#include "foucault/evaluation/shown_runs.h"

/// What an evaluation amounts to.
namespace foucault::evaluation {

/// What is kept of every run.
struct RunFacts {
  DriftTruth truth = DriftTruth::withheld_fixes;
  double fixes_span_s = 0;
  int64_t outages = 0;
  int64_t scheduled = 0;
  double cpu_s = 0;
};

/// Results, joined in the ways in which they are shown, while they come and go. Differences are
/// from the first method.
/// Memory: 40 bytes a run and 32 an outage and method, twice as much of the latter where recordings
/// or IMUs have rows of their own; samples and tracks of what is drawn.
class EvaluationSummary {
 public:
  explicit EvaluationSummary(RunNames names);
  /// Of all of them, in any order. Throws as finish().
  explicit EvaluationSummary(const std::vector<ExperimentResult>& results);

  /// The result of the next run, in the order of their names.
  void add(ExperimentResult result);
  /// Of all of them. What follows is there afterwards. Throws DataError if the methods have no
  /// outage in common, naming the one that has none.
  void finish();

  const RunNames& names() const { return names_; }
  /// In the order of the names.
  const std::vector<RunFacts>& runs() const { return runs_; }
  std::size_t recordings() const { return recordings_; }
  /// Of which tracks are drawn; they have nothing but these and what was withheld.
  const std::vector<ExperimentResult>& shown() const { return shown_; }
  const std::vector<std::string>& methods() const { return methods_; }

  /// All outages, an entry a method.
  const std::vector<MethodOutages>& overall() const { return overall_; }
  /// The rows of Table III: IMUs if there are several, else recordings with a last row "all
  /// recordings" if there are several of these; that row alone if there are more than kMostRows.
  const std::vector<MethodOutages>& rows() const { return rows_; }
  static constexpr std::size_t kMostRows = 1000;
  /// What heads the column that names the rows: "IMU" or "Recording".
  const std::string& row_header() const { return row_header_; }

  /// Groups of outages that figures and distances() tell apart: IMUs, else all recordings together.
  /// They have what is to be drawn.
  const std::vector<MethodOutages>& cases() const {
    return recordings_ > 1 && !by_imu() ? overall_ : rows_;
  }
  /// Drift by distance from the start; none if no recording goes far enough.
  const std::vector<DistanceProfile>& distances() const { return distances_; }

  /// Errors over their sigmas, and the returns, of each of rows().
  const std::vector<MethodNormalizedDrifts>& normalized() const { return normalized_; }
  const std::vector<PooledReturns>& returns() const { return returns_; }

  TextTable rms_table() const;         ///< Table III
  TextTable difference_table() const;  ///< Table IV
  TextTable statistics_table() const;
  TextTable normalized_table() const;
  TextTable return_table() const;

 private:
  bool by_imu() const { return row_header_ == "IMU"; }
  void look_at_names();
  void join_pending();

  RunNames names_;
  std::size_t recordings_ = 0;
  std::vector<std::string> methods_;
  std::string row_header_;
  std::vector<OutageJoin> joins_;          ///< all; rows, if there are any
  std::vector<ExperimentResult> pending_;  ///< what is compared with the last one
  ShownRuns shown_runs_{false};
  std::vector<ExperimentResult> shown_;
  std::vector<RunFacts> runs_;
  std::vector<MethodOutages> overall_;
  std::vector<MethodOutages> rows_;
  std::vector<DistanceProfile> distances_;
  std::vector<MethodNormalizedDrifts> normalized_;
  std::vector<PooledReturns> returns_;
};

/// How long, how often and against what, in one sentence.
std::string outages_text(const EvaluationSummary& summary);

/// The tables and what they rest on, for the terminal.
std::vector<std::string> evaluation_lines(const EvaluationSummary& summary);

}  // namespace foucault::evaluation
