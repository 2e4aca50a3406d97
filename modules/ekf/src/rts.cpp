#include "foucault/ekf/rts.h"

#include <Eigen/Cholesky>

namespace foucault {
namespace {

/// State and covariance from all fixes, every component of the filter's.
struct Smoothed {
  ekf::FullState state;
  Eigen::MatrixXd covariance;
};

/// One step back. G = P_f phi' P_p^-1; the error found in the next node's prediction is carried to
/// the filtered state.
Smoothed step_back(const RtsNode& node, const RtsNode& next, const Smoothed& next_smoothed) {
  const Eigen::MatrixXd carried = next.phi * node.filtered_covariance;
  const Eigen::MatrixXd gain = next.predicted_covariance.ldlt().solve(carried).transpose();
  const ekf::Vector found =
      difference(next.predicted, next_smoothed.state, static_cast<int>(gain.rows()));
  const Eigen::MatrixXd change = next_smoothed.covariance - next.predicted_covariance;
  const Eigen::MatrixXd covariance = node.filtered_covariance + gain * change * gain.transpose();
  return {corrected(node.filtered, gain * found), 0.5 * (covariance + covariance.transpose())};
}

SmoothedNode result_of(const RtsNode& node, const Smoothed& smoothed) {
  return {smoothed.state, smoothed.covariance.topLeftCorner<15, 15>(),
          difference(node.predicted, smoothed.state, error_state::kSize),
          difference(node.filtered, smoothed.state, error_state::kSize)};
}

Epoch to_epoch(const SmoothedNode& node) {
  const ekf::FullState& state = node.state;
  Epoch epoch;
  epoch.t_ns = state.motion.t_ns;
  epoch.position = state.motion.position;
  epoch.velocity_n = state.motion.v_n;
  epoch.q_n_b = state.motion.q_n_b;
  epoch.bias = state.bias;
  epoch.covariance = node.covariance;
  return epoch;
}

}  // namespace

std::vector<SmoothedNode> smooth(const std::vector<RtsNode>& nodes) {
  std::vector<SmoothedNode> results(nodes.size());
  Smoothed smoothed;
  for (std::size_t k = nodes.size(); k-- > 0;) {
    const bool ends_run = k + 1 == nodes.size() || nodes[k + 1].begins_run;
    smoothed = ends_run ? Smoothed{nodes[k].filtered, nodes[k].filtered_covariance}
                        : step_back(nodes[k], nodes[k + 1], smoothed);
    results[k] = result_of(nodes[k], smoothed);
  }
  return results;
}

void RtsRecorder::start(const Epoch& initial) {
  if (!nodes_.empty()) mark();
  EkfNavigator::start(initial);
  add_node();
  nodes_.back().begins_run = true;
}

void RtsRecorder::update(const GnssFix& fix) {
  catch_up();
  add_node();
  EkfNavigator::update(fix);
  RtsNode& node = nodes_.back();
  node.filtered = state();
  node.filtered_covariance = covariance();
  node.p_b_a = fix.p_b_a;
}

std::size_t RtsRecorder::mark() {
  if (!at_node()) {
    catch_up();
    add_node();
  }
  return nodes_.size() - 1;
}

bool RtsRecorder::at_node() const {
  return !nodes_.empty() && nodes_.back().filtered.motion.t_ns == state().motion.t_ns;
}

std::vector<SmoothedEpoch> RtsRecorder::smoothed() {
  const std::vector<SmoothedNode> nodes = smooth(nodes_);
  std::vector<SmoothedEpoch> out;
  out.reserve(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    out.push_back({to_epoch(nodes[k]), nodes[k].before, nodes[k].after, nodes_[k].p_b_a});
  return out;
}

void RtsRecorder::stepped(const ekf::Matrix& phi) { phi_ = (phi * phi_).eval(); }

void RtsRecorder::add_node() {
  RtsNode node;
  node.predicted = node.filtered = state();
  node.predicted_covariance = node.filtered_covariance = covariance();
  node.phi = phi_;
  phi_ = ekf::Matrix::Identity(node.predicted_covariance.rows(), node.predicted_covariance.cols());
  nodes_.push_back(std::move(node));
}

}  // namespace foucault
