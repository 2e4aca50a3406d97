#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "foucault/state/epoch.h"

namespace foucault::state {

/// What was told before a run of that which it estimates, and in which axes users think of it.
struct Told {
  Layout layout;
  double time_offset_s = 0;
  Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();      ///< IMU to antenna [m]
  Eigen::Quaterniond q_v_b = Eigen::Quaterniond::Identity();  ///< the mounting as told
};

/// A recording tells something of a number if it leaves at most this of the sigma that was told.
constexpr double kLeftWhereTold = 0.7;

/// The epoch with slow blocks as users know them: the whole time offset; lever arms along the
/// vehicle's forward, right, down, as its mounting was found, that to the antenna as a whole. Its
/// covariance follows.
Epoch as_users_know(const Epoch& epoch, const Told& told);

/// The same of what was told before anything was measured: arms with the sigmas they were told by,
/// though what the mounting is was not known.
Epoch prior_as_users_know(const Told& told);

}  // namespace foucault::state
