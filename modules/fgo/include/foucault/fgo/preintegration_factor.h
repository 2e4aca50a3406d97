#pragma once

#include <ceres/cost_function.h>

#include <array>
#include <optional>

#include "foucault/fgo/state_block.h"
#include "foucault/preintegration/motion.h"
#include "foucault/state/layout.h"

namespace foucault {

/// Whitened rows of an interval: r + J_x0 d0 + J_x1 d1 + J_slow d_border.
struct IntervalRows {
  NodeVector r;
  NodeMatrix J_x0, J_x1;
  NodeBySlow J_slow;
};

/// A Preintegration without its covariance: a fifth of its size.
struct PreintegratedMotion {
  int64_t t_begin_ns, t_end_ns;
  double dt;
  Eigen::Quaterniond dq;
  Eigen::Vector3d dv, dp, idp, iidp;
  ImuBias bias;
  double gyro_bias_decay, accel_bias_decay;
  Eigen::Matrix3d J_dp_bg, J_dp_ba, J_dv_bg, J_dv_ba, J_dq_bg;
};

/// Residual (49) between two neighbouring nodes, whitened by the covariance (43).
/// Blocks: node k-1, node k, and the border if there is one. The square-root information is built
/// once, here. 1.7 kB: a batch keeps one for each of its nodes.
class PreintegrationFactor final : public ceres::CostFunction {
 public:
  /// Throws std::invalid_argument if the covariance is not positive definite.
  PreintegrationFactor(const Preintegration& pre, const EarthModel& earth,
                       const Layout& layout = {});

  IntervalRows linearize(const NodeState& x0, const NodeState& x1, const SlowVector& slow) const;

  /// The residual alone.
  NodeVector residual(const NodeState& x0, const NodeState& x1, const SlowVector& slow) const;

  const PreintegratedMotion& motion() const { return motion_; }
  const EarthModel& earth() const { return earth_; }
  /// With its covariance, from the square-root information.
  Preintegration preintegration() const;

  /// The same measurement on the Earth as it is elsewhere.
  void set_earth(const EarthModel& earth) { earth_ = earth; }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  NodeMatrix sqrt_information() const;

  PreintegratedMotion motion_;
  EarthModel earth_;
  /// Inverse Cholesky factor of the covariance, its lower triangle.
  std::array<double, kNodeSize*(kNodeSize + 1) / 2> sqrt_information_;
  int slow_size_;
};

/// A node's covariance carried over an interval, with the border's.
StateMatrix predict_covariance(const NodeState& x0, const NodeState& x1, const SlowVector& slow,
                               const Preintegration& pre, const EarthModel& earth,
                               const Layout& layout, const StateMatrix& covariance);

}  // namespace foucault
