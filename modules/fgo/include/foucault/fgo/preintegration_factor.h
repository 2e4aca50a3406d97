#pragma once

#include <ceres/cost_function.h>

#include <array>

#include "foucault/fgo/state_block.h"
#include "foucault/preintegration/motion.h"
#include "foucault/state/layout.h"

namespace foucault::fgo {

/// Whitened rows of an interval: r + J_x0 d0 + J_x1 d1 + J_slow d_border.
struct IntervalRows {
  state::NodeVector r;
  state::NodeMatrix J_x0, J_x1;
  state::NodeBySlow J_slow;
};

/// Residual (49) between two neighbouring nodes, whitened by the covariance (43).
/// Blocks: node k-1, node k, and the border if there is one. The square-root information is built
/// once, here. 2.4 kB: a batch keeps one for each of its nodes.
class PreintegrationFactor final : public ceres::CostFunction {
 public:
  /// Throws std::invalid_argument if the covariance is not positive definite.
  PreintegrationFactor(const preintegration::Preintegration& pre,
                       const preintegration::EarthModel& earth, const state::Layout& layout = {});

  IntervalRows linearize(const state::NodeState& x0, const state::NodeState& x1,
                         const state::SlowVector& slow) const;

  /// The residual alone.
  state::NodeVector residual(const state::NodeState& x0, const state::NodeState& x1,
                             const state::SlowVector& slow) const;

  int64_t t_begin_ns() const { return deltas_.t_begin_ns; }
  /// An angle [rad] by which the interval turns otherwise than it was integrated, if these are the
  /// bias and the slow blocks.
  double turned_by(const state::ImuBias& bias, const state::SlowVector& slow) const;

  const preintegration::EarthModel& earth() const { return earth_; }
  /// With its covariance, from the square-root information.
  preintegration::Preintegration preintegration() const;

  /// The same measurement on the Earth as it is elsewhere.
  void set_earth(const preintegration::EarthModel& earth) { earth_ = earth; }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  state::NodeMatrix sqrt_information() const;

  preintegration::MotionDeltas deltas_;
  preintegration::EarthModel earth_;
  /// Inverse Cholesky factor of the covariance, its lower triangle.
  static constexpr int kRows = state::NodeVector::RowsAtCompileTime;
  std::array<double, kRows*(kRows + 1) / 2> sqrt_information_;
  state::Layout layout_;
};

}  // namespace foucault::fgo
