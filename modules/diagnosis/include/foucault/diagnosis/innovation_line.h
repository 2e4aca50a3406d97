#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>

namespace foucault::diagnosis {

/// An innovation that did not pass the gate.
struct InnovationSample {
  int64_t t_ns = 0;
  Eigen::Vector3d value_n = Eigen::Vector3d::Zero();     ///< [m]
  Eigen::Vector3d variance_n = Eigen::Vector3d::Zero();  ///< of the fix alone [m^2]
  double square = 0;                                     ///< normalized
};
using InnovationSamples = std::deque<InnovationSample>;  ///< in order of time, at least two

/// Such innovations as a straight line over time: a step fault if it stands still, a ramp fault if
/// it grows.
struct InnovationLine {
  int64_t t_ns = 0;                                    ///< of the last of them
  Eigen::Vector3d offset_n = Eigen::Vector3d::Zero();  ///< there [m]
  Eigen::Vector3d rate_n = Eigen::Vector3d::Zero();    ///< [m/s]
  Eigen::Vector3d offset_variance_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_variance_n = Eigen::Vector3d::Zero();  ///< of the state's velocity included

  Eigen::Vector3d at(int64_t t_ns) const;
  Eigen::Vector3d variance_at(int64_t t_ns) const;

  /// Grows by more than it and the state's velocity are uncertain.
  bool drifts(const Eigen::Vector3d& velocity_variance_n) const;
};

/// Least squares. The line's errors are those of the fixes and of the state's velocity.
InnovationLine fit_line(const InnovationSamples& samples,
                        const Eigen::Vector3d& velocity_variance_n);

/// Within the noise of the fixes and what an acceleration of this sigma [m/s^2] may bend a line by.
bool lie_on(const InnovationSamples& samples, const InnovationLine& line,
            double acceleration_sigma);

/// Their mean may be zero, and their scatter is what sigmas that are too small leave of it.
bool scatter_about_zero(const InnovationSamples& samples);

/// By the ratio of von Neumann, the mean square of steps over the variance: 2 for white noise, 0
/// for what is smooth.
bool are_smooth(const InnovationSamples& samples);

}  // namespace foucault::diagnosis
