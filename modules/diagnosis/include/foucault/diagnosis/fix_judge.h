#pragma once

#include <cstdint>
#include <deque>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/gnss_options.h"
#include "foucault/measurement/navigator.h"

namespace foucault::diagnosis {

/// e' S^-1 e.
double mahalanobis_squared(const Eigen::Vector3d& value, const Eigen::Matrix3d& covariance);
double mahalanobis_squared(const state::Innovation& innovation);
/// Probability that the square of a normalized innovation of so many dimensions is larger.
double chi_square_tail(double square, int dimension);

/// Decides whether measurements of one kind, fixes for example, agree with the prediction: by the
/// chi-square test of their dimension, relative to the median
/// of recent normalized innovations and to the mean of recent believed ones where these are above
/// their expectation. Where sigmas are too small, throughout or in turns, an outlier is what stands
/// out of the others. What becomes of a fix that does not agree, FixDoubt finds out from those that
/// follow it.
class FixJudge {
 public:
  /// `dimension`: of what is judged, 1 to 3.
  explicit FixJudge(const GnssOptions& options, int dimension = 3)
      : options_(options), dimension_(dimension) {}

  /// The state has started anew.
  void start(int64_t t_ns);
  /// The state has become worse than its covariance may say: the gate is open for ten seconds.
  void doubt_state(int64_t t_ns);

  /// No fix is ever doubted.
  bool is_off() const { return options_.gate_false_alarm == 0; }
  bool gate_is_open(int64_t t_ns) const { return is_off() || t_ns <= gate_open_until_ns_; }
  bool state_is_doubted(int64_t t_ns) const { return t_ns <= state_doubted_until_ns_; }

  /// Whether a fix is believed at first sight; remembers what it has seen.
  bool believes(int64_t t_ns, const state::Innovation& innovation);
  /// The chi-square test alone.
  bool passes(double square) const;

  /// Mean square of normalized innovations over its expectation, at least 1.
  double level() const;
  void remember(double square);

 private:
  GnssOptions options_;
  int dimension_;
  int64_t gate_open_until_ns_ = INT64_MIN;
  int64_t state_doubted_until_ns_ = INT64_MIN;
  std::deque<double> squares_;  ///< normalized innovations squared, the last ones
  double believed_level_ =
      1;  ///< mean normalized innovation squared of believed ones, over its expectation
};

}  // namespace foucault::diagnosis
