#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

#include "foucault/core/measurement.h"
#include "foucault/state/nav_state.h"

/// Strapdown mechanization in the local North-East-Down frame n.
/// Sources: Savage, "Strapdown Inertial Navigation Integration Algorithm Design" (JGCD 1998);
/// Groves, "Principles of GNSS, Inertial and Multisensor Integrated Navigation Systems" (2013),
/// ch. 5; Shin, "Estimation Techniques for Low-Cost Inertial Navigation" (2005), ch. 2.
/// Units rad, m, s.
namespace foucault::imu {

/// The increment without the biases' share.
ImuIncrement without_bias(const ImuIncrement& increment, const state::ImuBias& bias);
/// What is free of biases without the share of scale factors and cross-axis terms.
ImuIncrement without_scale(const ImuIncrement& increment, const state::ImuScale& scale);

/// The state at the end of an increment which begins at state.t_ns.
/// Both increments are free of biases. `previous` is the one before, for coning and sculling;
/// a default one (of no length) when there is none.
/// Second order in dt: rates of the Earth, Coriolis and gravity are those of mid-interval, the
/// position follows the mean velocity.
state::NavState advance(const state::NavState& state, const ImuIncrement& previous,
                        const ImuIncrement& increment);

}  // namespace foucault::imu
