#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "foucault/fgo/chain.h"
#include "foucault/fgo/fgo_options.h"
#include "foucault/fgo/gnss_factor.h"
#include "foucault/fgo/imu_interval.h"
#include "foucault/fgo/prior_factor.h"
#include "foucault/fgo/state_block.h"
#include "foucault/inertial/navigator.h"

namespace foucault {

/// GNSS/INS by sliding-window factor graph optimization, paper section IV.
///
/// A node stands at every fix and at every hold(); neighbours are joined by a preintegration
/// factor; the window (48) is solved by Ceres at every fix. A node added by hold() brings no
/// information, so nothing is solved there. Nodes older than window_s are marginalized into a
/// square-root prior. w is the NED at the place of start().
class WindowNavigator final : public Navigator {
 public:
  WindowNavigator(const FgoOptions& options, PreintegrationModel model, const ImuNoise& noise);
  ~WindowNavigator() override;

  void start(const Epoch& initial) override;
  void propagate(const ImuIncrement& increment) override;
  Innovation innovation(const GnssFix& fix) const override;
  void update(const GnssFix& fix) override;
  void hold() override;
  Epoch epoch() const override;

  std::size_t nodes() const { return nodes_.size(); }

 private:
  struct Node {
    /// What the past and this node's fixes say of it, linearized at an attitude.
    struct Forward {
      NodeInformation information;
      Eigen::Quaterniond attitude;
    };
    int64_t t_ns = 0;
    StateBlock x{};
    std::vector<std::unique_ptr<GnssFactor>> fixes;
    std::optional<Forward> forward;
  };
  struct Interval : ImuInterval {
    ceres::ResidualBlockId block = nullptr;
  };
  struct Prediction {
    NodeState x;
    Matrix15d covariance;
  };

  void begin_interval();
  void add_node();
  void solve();
  bool reintegrate_moved_biases();
  void marginalize_old();
  void marginalize_first();
  void set_prior(const SquareRootPrior& prior);
  NodeInformation information(const Node& node) const;
  void update_covariance();
  Prediction prediction() const;
  NodeState last_state() const { return read_block(nodes_.back().x.data()); }
  bool at_node() const { return integrator_->dt() == 0; }

  FgoOptions options_;
  PreintegrationModel model_;
  ImuNoise noise_;
  StateManifold manifold_;
  std::unique_ptr<ceres::LossFunction> loss_;

  std::optional<LocalFrame> frame_;
  EarthModel earth_;  ///< of the interval from the newest node on
  std::deque<Node> nodes_;
  std::deque<Interval> intervals_;  ///< one less than nodes
  std::unique_ptr<PriorFactor> prior_;
  ceres::ResidualBlockId prior_block_ = nullptr;
  std::optional<Preintegrator> integrator_;   ///< from the newest node on
  Interval open_;                             ///< its increments
  Matrix15d covariance_ = Matrix15d::Zero();  ///< of the newest node
  std::unique_ptr<ceres::Problem> problem_;   ///< last: refers to the members above
};

}  // namespace foucault
