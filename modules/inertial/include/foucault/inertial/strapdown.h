#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

#include "foucault/core/measurement.h"
#include "foucault/geodesy/place.h"
#include "foucault/state/blocks.h"

/// Strapdown mechanization in the local North-East-Down frame n.
/// Sources: Savage, "Strapdown Inertial Navigation Integration Algorithm Design" (JGCD 1998);
/// Groves, "Principles of GNSS, Inertial and Multisensor Integrated Navigation Systems" (2013),
/// ch. 5; Shin, "Estimation Techniques for Low-Cost Inertial Navigation" (2005), ch. 2.
/// Units rad, m, s.
namespace foucault {

/// Position, velocity and attitude of the IMU centre.
struct StrapdownState {
  int64_t t_ns = 0;
  Geodetic position;
  Eigen::Vector3d v_n = Eigen::Vector3d::Zero();  ///< relative to the Earth, in n [m/s]
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
};

/// Position, velocity, attitude of an error state: the first nine of its rows.
using Vector9d = Eigen::Matrix<double, 9, 1>;

/// The state with an error put right: dp in metres along the ellipsoid, attitude on the right.
StrapdownState corrected(const StrapdownState& state, const Vector9d& error);

/// The error of which `to` is the corrected `from`, positions by the radii of `from`.
Vector9d difference(const StrapdownState& from, const StrapdownState& to);

/// The increment without the biases' share.
ImuIncrement without_bias(const ImuIncrement& increment, const ImuBias& bias);

/// The state at the end of an increment which begins at state.t_ns.
/// Both increments are free of biases. `previous` is the one before, for coning and sculling;
/// a default one (of no length) when there is none.
/// Second order in dt: rates of the Earth, Coriolis and gravity are those of mid-interval, the
/// position follows the mean velocity.
StrapdownState advance(const StrapdownState& state, const ImuIncrement& previous,
                       const ImuIncrement& increment);

}  // namespace foucault
