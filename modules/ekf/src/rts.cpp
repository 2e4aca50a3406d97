#include "foucault/ekf/rts.h"

#include <Eigen/Cholesky>

namespace foucault {
namespace {

/// One step back. G = P_f phi' P_p^-1; the correction of the next node, about its prediction, is
/// carried to the filtered state.
void smooth_node(RtsNode& node, const RtsNode& next) {
  const Eigen::MatrixXd carried = next.phi * node.filtered_covariance;
  const Eigen::MatrixXd gain = next.predicted_covariance.ldlt().solve(carried).transpose();
  const int size = static_cast<int>(gain.rows());
  const ekf::Vector correction = difference(next.predicted, next.filtered, size);
  node.filtered = corrected(node.filtered, gain * correction);
  const Eigen::MatrixXd change = next.filtered_covariance - next.predicted_covariance;
  const Eigen::MatrixXd smoothed = node.filtered_covariance + gain * change * gain.transpose();
  node.filtered_covariance = 0.5 * (smoothed + smoothed.transpose());
}

}  // namespace

void smooth(std::vector<RtsNode>& nodes) {
  for (std::size_t k = nodes.size(); k-- > 1;) {
    if (!nodes[k].begins_run) smooth_node(nodes[k - 1], nodes[k]);
  }
}

void RtsRecorder::start(const Epoch& initial) {
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
  if (nodes_.empty() || nodes_.back().filtered.motion.t_ns != state().motion.t_ns) {
    catch_up();
    add_node();
  }
  return nodes_.size() - 1;
}

void RtsRecorder::stepped(const ekf::Matrix& phi) { phi_ = (phi * phi_).eval(); }

void RtsRecorder::add_node() {
  RtsNode node;
  node.predicted = node.filtered = state();
  node.predicted_covariance = node.filtered_covariance = covariance();
  node.phi = phi_;
  nodes_.push_back(std::move(node));
  const auto size = nodes_.back().predicted_covariance.rows();
  phi_ = ekf::Matrix::Identity(size, size);
}

}  // namespace foucault
