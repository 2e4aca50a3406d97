#pragma once

#include <deque>

#include "foucault/ekf/ekf.h"
#include "foucault/measurement/recording.h"

/// Rauch-Tung-Striebel smoothing of an EKF run.
/// Source: Rauch, Tung, Striebel, AIAA Journal 3 (1965); in the error-state form of Shin (2005),
/// 4.3: corrections are smoothed about the forward solution.
namespace foucault::ekf {

/// The forward solution at one instant, and how it came there from the node before.
struct RtsNode {
  state::NavState predicted;  ///< before it was measured
  state::PackedSymmetric predicted_covariance;
  state::NavState filtered;  ///< after it; the same where nothing was measured
  state::PackedSymmetric filtered_covariance;
  /// ekf::Phi from the node before, at its filtered state.
  Eigen::MatrixXd motion;
  Eigen::VectorXd decay;
  bool begins_run = false;  ///< nothing comes from the node before
};

/// The backward pass. One result a node; the nodes are used up on the way.
std::deque<measurement::SmoothedEpoch> smooth(std::deque<RtsNode> nodes);

/// The EKF, with a node left at the start and the end of a run, wherever something was measured, at
/// every hold, and wherever marked.
/// Memory grows by about 5 kB a node, however many increments lie between.
class RtsRecorder : public EkfNavigator, public measurement::Recording {
 public:
  using EkfNavigator::EkfNavigator;

  void start(const state::Epoch& initial) override;
  void update(const measurement::ObservationPtr& observation) override;
  void loosen(const state::NodeMatrix& added) override;
  void hold() override { mark(); }

  std::size_t mark() override;
  bool at_node() const override;
  std::size_t size() const override { return nodes_.size(); }
  std::deque<measurement::SmoothedEpoch> smoothed() override { return smooth(std::move(nodes_)); }

 protected:
  void stepped(const Step& step) override;

 private:
  void add_node();

  std::deque<RtsNode> nodes_;
  ekf::Phi phi_;  ///< since the last node
};

}  // namespace foucault::ekf
