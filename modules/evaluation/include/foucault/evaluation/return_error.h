#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/evaluation/outage.h"

/// The return: what the estimate errs by once fixes are there again. An estimator that takes true
/// fixes for false ones shows here, not in the outage.
namespace foucault::evaluation {

/// How long the return lasts, from the first fix after an outage on; less if the next outage or
/// the end of the recording comes before.
constexpr double kReturnWindowS = 30;

/// Horizontal errors in the return from one outage.
struct ReturnError {
  double rms = 0;  ///< [m]; infinite where the estimate was not a number, as the maximum
  double maximum = 0;
  /// Time from the first fix until the error stays within the 3-sigma ellipse of the fix, [s]; none
  /// if it does not in the return.
  std::optional<double> settled_s;
};

/// Collects the errors in returns. Fixes and errors come each in order of stamps, an error after
/// the fixes up to its stamp; memory holds the fixes that no error has passed yet.
class ReturnCollector {
 public:
  /// A fix that the estimator gets, and the outage before it. True if it lies in the return.
  bool fix(const Outage& before, const GnssFix& fix);

  /// Estimate minus truth outside of outages, NED [m].
  void error(int64_t t_ns, const Eigen::Vector3d& error_n);

  /// By the index of the outage; those with an error in their return.
  std::map<int64_t, ReturnError> results() const;

 private:
  struct Return {
    int64_t outage_index = 0;
    int64_t samples = 0;
    double sum_of_squares = 0;
    double maximum = 0;
    std::optional<int64_t> settled_ns;  ///< since when all errors are within
  };
  struct FixSigma {
    int64_t t_ns;
    Eigen::Matrix2d information;  ///< inverse of its horizontal covariance [1/m^2]
  };

  bool within_three_sigma(int64_t begin_ns, int64_t t_ns, const Eigen::Vector2d& error);

  std::map<int64_t, Return> returns_;  ///< by the stamp of their first fix
  std::deque<FixSigma> fixes_;         ///< from the last one not after the last error
};

}  // namespace foucault::evaluation
