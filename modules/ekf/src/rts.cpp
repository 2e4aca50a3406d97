#include "foucault/ekf/rts.h"

#include <Eigen/Cholesky>

namespace foucault::ekf {
namespace {

/// State and covariance from everything measured.
struct Smoothed {
  state::NavState state;
  state::StateMatrix covariance;
};

/// One step back. G = P_f phi' P_p^-1; the error found in the next node's prediction is carried to
/// the filtered state.
Smoothed step_back(const RtsNode& node, const RtsNode& next, const Smoothed& next_smoothed) {
  const state::StateMatrix filtered = node.filtered_covariance.full();
  const state::StateMatrix predicted = next.predicted_covariance.full();
  state::StateMatrix carried(filtered.rows(), filtered.cols());
  carried << next.motion * filtered,
      next.decay.asDiagonal() * filtered.bottomRows(next.decay.size());
  const state::StateMatrix gain = predicted.ldlt().solve(carried).transpose();
  const state::StateVector found = state::boxminus(next_smoothed.state, next.predicted);
  const state::StateMatrix change = next_smoothed.covariance - predicted;
  const state::StateMatrix covariance = filtered + gain * change * gain.transpose();
  return {state::boxplus(node.filtered, gain * found), 0.5 * (covariance + covariance.transpose())};
}

measurement::SmoothedEpoch result_of(const RtsNode& node, const Smoothed& smoothed) {
  return {smoothed.state, state::PackedSymmetric(smoothed.covariance),
          state::node_part(state::boxminus(smoothed.state, node.predicted)),
          state::node_part(state::boxminus(smoothed.state, node.filtered))};
}

}  // namespace

std::deque<measurement::SmoothedEpoch> smooth(std::deque<RtsNode> nodes) {
  std::deque<measurement::SmoothedEpoch> results;
  Smoothed smoothed;
  RtsNode next;
  while (!nodes.empty()) {
    RtsNode node = std::move(nodes.back());
    nodes.pop_back();
    const bool ends_run = results.empty() || next.begins_run;
    smoothed = ends_run ? Smoothed{node.filtered, node.filtered_covariance.full()}
                        : step_back(node, next, smoothed);
    results.push_front(result_of(node, smoothed));
    next = std::move(node);
  }
  return results;
}

void RtsRecorder::start(const state::Epoch& initial) {
  if (!nodes_.empty()) mark();
  EkfNavigator::start(initial);
  add_node();
  nodes_.back().begins_run = true;
}

void RtsRecorder::update(const measurement::ObservationPtr& observation) {
  mark();
  EkfNavigator::update(observation);
  nodes_.back().filtered = state();
  nodes_.back().filtered_covariance = state::PackedSymmetric(covariance());
}

/// What is added lies between two nodes.
void RtsRecorder::loosen(const state::NodeMatrix& added) {
  EkfNavigator::loosen(added);
  add_node();
}

std::size_t RtsRecorder::mark() {
  if (!at_node()) {
    catch_up();
    add_node();
  }
  return nodes_.size() - 1;
}

bool RtsRecorder::at_node() const {
  return !nodes_.empty() && nodes_.back().filtered.t_ns == state().t_ns;
}

void RtsRecorder::stepped(const Step& step) { phi_ = step.phi * phi_; }

void RtsRecorder::add_node() {
  RtsNode& node = nodes_.emplace_back();
  node.predicted = node.filtered = state();
  node.predicted_covariance = node.filtered_covariance = state::PackedSymmetric(covariance());
  node.motion = phi_.motion;
  node.decay = phi_.decay;
  phi_ = ekf::Phi::identity(state::state_size(state().slow.size()));
}

}  // namespace foucault::ekf
