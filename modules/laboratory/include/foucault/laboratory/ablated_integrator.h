#pragma once

#include <Eigen/Core>

#include "foucault/core/measurement.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/preintegration/motion.h"

namespace foucault::laboratory {

/// Gravity along an interval.
enum class GravityAlong {
  gradient,  ///< the vector of the start and its gradient times the way, as `full` has it
  start,     ///< the vector of the start, constant
  place      ///< the normal gravity of every sample's own place
};

/// Terms of an integration that can be left out, to see what each is worth. As they are by default
/// they make `full`; with `place` nothing is left out, and what remains is the discretization of
/// the increments.
struct MotionTerms {
  bool coning = true;          ///< theta_prev x theta / 12, paper (15)
  bool sculling = true;        ///< (theta_prev x dv + dv_prev x theta) / 12, paper (18)
  bool rotation = true;        ///< of the body within a sample: theta x dv / 2, paper (18)
  bool rotation_again = true;  ///< theta x (theta x dv) / 6, the next term of its series
  bool earth_rotation = true;  ///< of the axes of w under the body: -omega_ie in its attitude
  bool coriolis = true;        ///< -2 omega_ie x v
  GravityAlong gravity = GravityAlong::gradient;
};

/// Dead reckoning in w, sample by sample, in which each term is a switch.
///
/// Within a sample the velocity increment is a force that is constant in inertial space, as in
/// Preintegrator, and the equations of motion on the turning Earth,
///     v' = Exp(-omega t) f + g(p) - 2 omega x v,   p' = v,
/// are solved by their Taylor series to the fourth power of the sample's length: exact to rounding.
/// So with default terms it is Preintegrator and predict() by another route.
class AblatedIntegrator {
 public:
  /// x0: the true state at the beginning, in the w of `frame`; its biases are not used.
  /// `previous`: the increment before the first, for coning and sculling.
  AblatedIntegrator(const state::NodeState& x0, const geodesy::LocalFrame& frame,
                    const MotionTerms& terms, const ImuIncrement& previous);

  /// An increment as long as the previous one.
  void add(const ImuIncrement& increment);

  state::NodeState state() const;

 private:
  Eigen::Vector3d rotation(const ImuIncrement& increment) const;
  Eigen::Vector3d velocity(const ImuIncrement& increment) const;
  Eigen::Vector3d gravity() const;

  geodesy::LocalFrame frame_;
  MotionTerms terms_;
  preintegration::EarthModel earth_;
  Eigen::Vector3d turning_;   ///< omega_ie of the attitude [rad/s]
  Eigen::Vector3d coriolis_;  ///< omega_ie of the Coriolis acceleration [rad/s]
  Eigen::Vector3d way_ = Eigen::Vector3d::Zero();  ///< since the start, which keeps its precision
  state::NodeState start_;
  Eigen::Vector3d v_;
  Eigen::Quaterniond q_;
  ImuIncrement previous_;
};

}  // namespace foucault::laboratory
