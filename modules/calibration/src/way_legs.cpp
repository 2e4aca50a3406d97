#include <algorithm>

#include "foucault/calibration/recorded_way.h"

namespace foucault::calibration {
namespace {

constexpr double kFixEvery = 1;  // [s]
constexpr Eigen::Index kMotionRows = state::MotionVector::RowsAtCompileTime;
constexpr Eigen::Index kBiasRows = state::BiasVector::RowsAtCompileTime;

bool has_fix(const WayNode& node) {
  return std::any_of(node.measured.begin(), node.measured.end(),
                     [](const WayMeasurement& z) { return z.kind == NoiseOf::position; });
}

bool has_aid(const WayNode& node) {
  return std::any_of(node.measured.begin(), node.measured.end(),
                     [](const WayMeasurement& z) { return !is_of_receiver(z.kind); });
}

/// The transition F of a node: ((motion), (0, decay)).
state::NodeMatrix transition(const WayNode& node) {
  state::NodeMatrix F = state::NodeMatrix::Zero();
  F.topRows<kMotionRows>() = node.motion;
  F.diagonal().tail<kBiasRows>() = node.decay;
  return F;
}

/// x -> F_n (F_l x + input) + input_n, and covariances alike.
void lengthen(WayLeg& leg, const WayNode& node) {
  const state::NodeMatrix F = transition(node);
  const auto of_motion = node.motion.leftCols<kMotionRows>();
  state::RowsByNode<kMotionRows> motion = of_motion * leg.motion;
  motion.rightCols<kBiasRows>() += node.motion.rightCols<kBiasRows>() * leg.decay.asDiagonal();
  leg.motion = motion;
  leg.decay = node.decay.cwiseProduct(leg.decay);
  leg.input = (F * leg.input).eval();
  leg.input.head<kMotionRows>() += node.input;
  leg.by_gyro = (of_motion * leg.by_gyro * of_motion.transpose()).eval() + node.by_gyro;
  leg.by_accel = (of_motion * leg.by_accel * of_motion.transpose()).eval() + node.by_accel;
  leg.by_gyro_bias = (F * leg.by_gyro_bias * F.transpose()).eval();
  leg.by_accel_bias = (F * leg.by_accel_bias * F.transpose()).eval();
  state::part(leg.by_gyro_bias.diagonal(), state::block::gyro_bias).array() += node.dt;
  state::part(leg.by_accel_bias.diagonal(), state::block::accel_bias).array() += node.dt;
  leg.dt += node.dt;
}

}  // namespace

std::vector<WayLeg> legs_of(const std::vector<WayNode>& nodes) {
  std::vector<WayLeg> legs;
  WayLeg leg;
  double since_fix = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const WayNode& node = nodes[i];
    if (!node.begins) lengthen(leg, node);
    since_fix = node.begins ? kFixEvery : since_fix + node.dt;
    const bool takes_fix = has_fix(node) && since_fix >= kFixEvery;
    if (takes_fix) since_fix = 0;
    if (takes_fix || has_aid(node) || node.begins || node.covariance) {
      leg.to = i;
      legs.push_back(leg);
      leg = {};
    } else {
      for (const WayMeasurement& z : node.measured) leg.input -= z.correction;
    }
  }
  return legs;
}

}  // namespace foucault::calibration
