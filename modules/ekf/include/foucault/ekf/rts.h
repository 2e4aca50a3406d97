#pragma once

#include <vector>

#include "foucault/ekf/ekf.h"
#include "foucault/inertial/smoother.h"

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

/// The EKF, with a node left at the start and the end of a run, at every fix and hold, and wherever
/// marked.
/// Memory grows by about 6 kB a node, however many increments lie between.
class RtsRecorder : public EkfNavigator, public Recording {
 public:
  using EkfNavigator::EkfNavigator;

  void start(const Epoch& initial) override;
  void update(const GnssFix& fix) override;
  void hold() override { mark(); }

  std::size_t mark() override;
  bool at_node() const override;
  std::size_t size() const override { return nodes_.size(); }
  std::vector<SmoothedEpoch> smoothed() override;

 protected:
  void stepped(const ekf::Matrix& phi) override;

 private:
  void add_node();

  std::vector<RtsNode> nodes_;
  ekf::Matrix phi_;  ///< since the last node
};

}  // namespace foucault
