#pragma once

#include <string>
#include <vector>

#include "foucault/evaluation/distance.h"
#include "foucault/evaluation/experiment.h"
#include "foucault/evaluation/outage_consistency.h"

/// What an evaluation amounts to.
namespace foucault::evaluation {

/// Results, joined in the ways in which they are shown. Differences are from the first method.
class EvaluationSummary {
 public:
  /// Throws DataError if the methods have no outage in common, naming the one that has none.
  explicit EvaluationSummary(std::vector<ExperimentResult> results);
  EvaluationSummary(const EvaluationSummary&) = delete;
  EvaluationSummary& operator=(const EvaluationSummary&) = delete;

  const std::vector<ExperimentResult>& results() const { return results_; }
  const std::vector<std::string>& methods() const { return methods_; }

  /// All outages, an entry a method.
  const std::vector<MethodOutages>& overall() const { return overall_; }
  /// The rows of the tables, see table_rows().
  const std::vector<MethodOutages>& rows() const { return rows_; }
  /// What heads the column that names the rows: "IMU" or "Recording".
  const std::string& row_header() const { return row_header_; }

  /// Groups of outages that distances() tells apart: IMUs, else all recordings together.
  const std::vector<MethodOutages>& distance_groups() const;
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
  std::vector<ExperimentResult> results_;
  std::vector<std::string> methods_;
  std::vector<MethodOutages> overall_;
  std::vector<MethodOutages> rows_;
  std::string row_header_;
  std::vector<DistanceProfile> distances_;
  std::vector<MethodNormalizedDrifts> normalized_;
  std::vector<PooledReturns> returns_;
};

/// How long, how often and against what, in one sentence.
std::string outages_text(const EvaluationSummary& summary);

/// The tables and what they rest on, for the terminal.
std::vector<std::string> evaluation_lines(const EvaluationSummary& summary);

}  // namespace foucault::evaluation
