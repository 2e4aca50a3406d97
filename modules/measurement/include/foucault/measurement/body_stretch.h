#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/state/nav_state.h"

/// Velocity of the IMU in its own axes, averaged over some instants before a stamp, as a function
/// of the state at the stamp: what wheels do over a second is then one measurement at its end, with
/// all samples in it.
namespace foucault::measurement {

/// Means over instants t_i up to the end, with R_i the rotation from b at the end to b at t_i and
/// dv_i the integral of specific force from t_i to the end, in b at the end:
///   mean of v_b(t_i) = turn w + turn_by_time (dba + w x dbg - g_b) - back,  w = C' v_n,
/// g_b = C' of gravity and Coriolis acceleration; of the rotation of n only the Earth's rate in the
/// latter is kept (15 m/s times 7e-5 rad/s times half a second are 0.5 mm/s); dbg, dba: the biases
/// less those that were taken off the increments, to first order.
struct BodyStretch {
  int64_t t_begin_ns = 0, t_end_ns = 0;
  int instants = 0;
  state::ImuBias bias;                                     ///< taken off the increments
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();          ///< mean of R_i
  Eigen::Matrix3d turn_by_time = Eigen::Matrix3d::Zero();  ///< mean of R_i (t_end - t_i) [s]
  Eigen::Vector3d back = Eigen::Vector3d::Zero();          ///< mean of R_i dv_i [m/s]
  Eigen::Vector3d rate_b = Eigen::Vector3d::Zero();        ///< mean rate at t_i, raw [rad/s]

  double dt() const { return 1e-9 * static_cast<double>(t_end_ns - t_begin_ns); }  ///< [s]
};

/// Mean velocity and its derivatives by the errors of the node's blocks.
struct BodyVelocity {
  Eigen::Vector3d value_b = Eigen::Vector3d::Zero();  ///< of the IMU [m/s]
  state::RowsByState<3> J = state::RowsByState<3>::Zero(3, state::state_size(0));
};
BodyVelocity body_velocity(const BodyStretch& stretch, const state::NavState& x);

/// Collects a stretch, from its begin on.
class BodyStretchBuilder {
 public:
  /// `bias`: taken off the increments.
  void start(int64_t t_ns, const state::ImuBias& bias);

  /// In order, without holes.
  void add(const ImuIncrement& increment);
  /// Now, the end of the last increment, is one of the instants.
  void mark();

  int64_t t_end_ns() const { return t_end_ns_; }
  /// None if no instant was marked.
  std::optional<BodyStretch> stretch() const;

 private:
  state::ImuBias bias_;
  int64_t t_begin_ns_ = 0, t_end_ns_ = 0;
  /// From b at the begin to b now, and the integral of specific force in b at the begin.
  Eigen::Quaterniond q_now_begin_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d dvel_begin_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_b_ = Eigen::Vector3d::Zero();
  /// Sums over instants, R from b at the begin.
  int instants_ = 0;
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d turn_by_time_ = Eigen::Matrix3d::Zero();  ///< times t_i - t_begin
  Eigen::Vector3d turned_dvel_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rates_ = Eigen::Vector3d::Zero();
};

}  // namespace foucault::measurement
