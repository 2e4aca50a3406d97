#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "initial_state.h"
#include "rest_detector.h"
#include "track.h"

namespace foucault::alignment {

/// A rest, and the first fix in it.
struct FoundRest {
  RestMeans means;
  GnssFix first;
};

/// What a rest tells at one of its fixes, of a vehicle heading north.
AlignmentFindings findings_at_rest(const RestMeans& means, const GnssFix& fix,
                                   const imu::ImuNoise& noise, const Eigen::Quaterniond& q_v_b);

/// What fixes and the forces between them tell at the first of them, of a vehicle heading north:
/// turned there by the gyroscopes, the mean specific force is what accelerates the antenna, less
/// gravity. Nothing is known of the gyroscopes' bias but its prior.
/// Precondition: `steps` hold the fixes, and the increments from the first to the last.
AlignmentFindings findings_in_motion(const std::vector<GnssFix>& fixes,
                                     const std::deque<Step>& steps, const imu::ImuNoise& noise,
                                     const Eigen::Quaterniond& q_v_b);

/// Attitude and biases found at one time, at an earlier one.
struct CarriedBack {
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  state::ImuBias bias;
  /// Of attitude, gyroscope and accelerometer bias.
  Eigen::Matrix<double, 9, 9> covariance = Eigen::Matrix<double, 9, 9>::Zero();

  /// For a run that uses the same data again: as if they had said `factor` times less, beside the
  /// priors of the biases.
  void reuse(double factor, const imu::ImuNoise& noise);
};

/// R(t) = E(t) R(0) B(t), with E the Earth's turn and B that of the gyroscopes less their bias; of
/// the errors, dtheta(0) = B dtheta(t) + (integral of B) db + the gyroscopes' noise since.
CarriedBack carried_back(const state::Epoch& found, const std::deque<Step>& steps, int64_t to_ns,
                         const imu::ImuNoise& noise);

/// The state at the first of `fixes`, attitude and biases as found. Its velocity is that with which
/// the increments lead to one of the other fixes, p(T) - p(0) = v T + twice integrated
/// acceleration: to the one of the least variance, which grows with T by the errors of attitude and
/// bias; or that measured by the first fix itself. Precondition: as findings_in_motion().
state::Epoch state_in_motion(const std::vector<GnssFix>& fixes, const std::deque<Step>& steps,
                             const CarriedBack& found);

}  // namespace foucault::alignment
