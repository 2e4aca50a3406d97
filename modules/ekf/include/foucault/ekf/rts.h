#pragma once

#include <vector>

#include "foucault/ekf/ekf.h"

/// Rauch-Tung-Striebel smoothing of an EKF run.
/// Source: Rauch, Tung, Striebel, AIAA Journal 3 (1965); in the error-state form of Shin (2005),
/// 4.3: corrections are smoothed about the forward solution.
namespace foucault {

/// The forward solution at one instant, and how it came there from the node before.
struct RtsNode {
  ekf::FullState predicted;              ///< before the fix
  Eigen::MatrixXd predicted_covariance;  ///< 15x15 or 21x21
  ekf::FullState filtered;               ///< after it; the same where there is none
  Eigen::MatrixXd filtered_covariance;
  Eigen::MatrixXd phi;                              ///< from the node before, at its filtered state
  bool begins_run = false;                          ///< nothing comes from the node before
  Eigen::Vector3d p_b_a = Eigen::Vector3d::Zero();  ///< lever arm of the fix [m]
};

/// The solution at a node from all fixes.
struct SmoothedNode {
  ekf::FullState state;
  Matrix15d covariance;
  Vector15d before;  ///< the error it found in the predicted state
  Vector15d after;   ///< in the filtered state
};

/// The backward pass. One result a node.
std::vector<SmoothedNode> smooth(const std::vector<RtsNode>& nodes);

Epoch to_epoch(const SmoothedNode& node);

/// The smoothed solution between two neighbouring nodes, where the forward run had `forward`: the
/// errors found after `begin` and before `end` are interpolated, that of the position to the third
/// order with those of the velocity. With nodes a second apart it differs from that of a node there
/// by millimetres after an outage of 60 s. The covariance is interpolated.
Epoch between(const SmoothedNode& begin, const SmoothedNode& end, const StrapdownState& forward);

/// The EKF, with a node left at the start and the end of a run, at every fix and hold, and wherever
/// marked.
/// Memory grows by about 6 kB a node, however many increments lie between.
class RtsRecorder : public EkfNavigator {
 public:
  using EkfNavigator::EkfNavigator;

  void start(const Epoch& initial) override;
  void update(const GnssFix& fix) override;
  void hold() override { mark(); }

  /// Makes sure that there is a node at the current time; gives its index.
  std::size_t mark();
  bool at_node() const;

  const std::vector<RtsNode>& nodes() const { return nodes_; }

 protected:
  void stepped(const ekf::Matrix& phi) override;

 private:
  void add_node();

  std::vector<RtsNode> nodes_;
  ekf::Matrix phi_;  ///< since the last node
};

}  // namespace foucault
