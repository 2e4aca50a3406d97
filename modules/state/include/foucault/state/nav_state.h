#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

#include "foucault/core/measurement.h"
#include "foucault/state/blocks.h"

/// States and their errors. An error is true minus estimated; state (+) error is the true state,
/// and x (+) (y (-) x) = y.
namespace foucault::state {

/// State of the IMU's centre in the local North-East-Down n of its own place.
/// Error: position in metres north, east, down along the ellipsoid, the rest as blocks.h has it.
struct NavState {
  int64_t t_ns = 0;
  Geodetic position;
  Eigen::Vector3d velocity_n = Eigen::Vector3d::Zero();  ///< relative to the Earth [m/s]
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  ImuBias bias;
  SlowVector slow;  ///< values of the slow blocks
};

/// The error may be that of a node alone: slow blocks stay as they are then.
NavState boxplus(const NavState& x, const StateVector& error);
/// Positions by the radii of `x`. As many rows as `x` has.
StateVector boxminus(const NavState& y, const NavState& x);

/// The same in the world frame w of a graph, paper (47), without slow blocks, which a graph holds
/// once. Error: position and velocity in w.
struct NodeState {
  Eigen::Vector3d p_w_b = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d v_w_b = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Quaterniond q_w_b = Eigen::Quaterniond::Identity();
  ImuBias bias;
};

NodeState boxplus(const NodeState& x, const NodeVector& error);
NodeVector boxminus(const NodeState& y, const NodeState& x);

}  // namespace foucault::state
