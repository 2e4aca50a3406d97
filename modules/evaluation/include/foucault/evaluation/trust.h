#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "foucault/core/consistency.h"
#include "foucault/evaluation/separation.h"
#include "foucault/state/result.h"

/// Whether a run can be believed, judged from what was kept: the innovations of used fixes, how
/// many stood out of them, and the states that were given out.
namespace foucault::evaluation {

/// States that were given out.
struct StateCount {
  int64_t given_out = 0;
  int64_t begin_ns = 0;  ///< stamp of the first
  int64_t not_finite = 0;
  int64_t first_not_finite_ns = 0;
};

/// Fixes that could be compared with a prediction.
struct FixCount {
  int64_t used = 0;
  int64_t rejected = 0;
};

/// Courses of a run against its headings.
class CourseOffset {
 public:
  /// Slow epochs have no course. heading_sigma [rad].
  void add(const Eigen::Vector3d& velocity_n, double heading, double heading_sigma);

  /// That the vehicle moved to the right of where it points [rad], on the mean; none if it did so
  /// in all directions, or hardly moved.
  std::optional<double> mean() const;
  double sigma() const;  ///< of the heading, mean [rad]

 private:
  int64_t samples_ = 0;
  std::complex<double> sum_;
  double sigma_sum_ = 0;
};

/// Measurements of one kind beside positions.
struct AidMetrics {
  int dimension = 0;
  int64_t used = 0;
  int64_t rejected = 0;
  double nis_sum = 0;  ///< of used ones: innovation squared by its covariance
  /// Its expectation is the dimension.
  double mean_nis() const { return used > 0 ? nis_sum / static_cast<double>(used) : 0; }
};
using Aids = std::map<std::string, AidMetrics>;  ///< by name

/// Every number of it, covariance included.
bool is_finite(const state::Epoch& epoch);

/// Of what a run amounts to. The size of innovations is the root of mean NIS / 3, 1 if their
/// covariances are right.
/// - Condemned: a size above 3, also of the horizontal components alone, or below 0.3; a state that
/// is not finite; fewer than ten used fixes; more than a quarter of the fixes rejected.
/// - Named: a course that is 30 deg and more off the heading on the mean, which may be so, or the
/// axes, the accelerometer's sign or the clocks are wrong.
/// - Named: a size above 1.5 or below 0.5; a stretch above 3.
/// - An aid of which ten and more were used by the same bounds upwards.
/// A size counts only if the mean is outside the band in which that of as many independent
/// innovations as these are worth lies with 99.9 %.
Trust trust_in(const Consistency& consistency, const StateCount& states, const Aids& aids = {},
               const FixCount& fixes = {}, const CourseOffset& course = {});

/// Of a smoothed run, by what smoothing made of the run forward. Ten samples and more count, and
/// sizes above 3, which a single independent sample of three components reaches once in 10 000
/// times; errors of states last, and how many samples are independent is not known.
/// - Condemned: velocity or attitude. The two describe different motions.
/// - Named: position. Fixes hold it in both; the run forward was too sure of it, as of a lever arm.
void judge_separation(Trust& trust, const SeparationMetrics& separation);

}  // namespace foucault::evaluation
