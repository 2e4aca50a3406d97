#pragma once

#include <ceres/loss_function.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "foucault/fgo/chain.h"
#include "foucault/fgo/fgo_options.h"
#include "foucault/fgo/imu_interval.h"
#include "foucault/fgo/observation_factor.h"
#include "foucault/imu/recent_rates.h"
#include "foucault/measurement/navigator.h"

namespace foucault::fgo {

/// GNSS/INS by sliding-window factor graph optimization, paper section IV.
///
/// A node stands at every observation and at every hold(); neighbours are joined by a
/// preintegration factor; slow blocks are a border of the window; the cost (48) over the window is
/// minimized at every observation. Nodes older than window_s are marginalized into a square-root
/// prior. w is the NED at the place of start().
///
/// Only what changed is solved again. The factors are linear but for the attitudes, so the part of
/// the window whose attitudes stay within kSettled of where it was linearized is summed up by its
/// quadratic form, which elimination along the chain leaves on its last node: Ceres gets that form
/// as a prior and the nodes behind it. Its result is carried back through the settled part; where
/// an attitude leaves kSettled, a bias asks for a new integration, or an observation bends with the
/// border, the window is solved again from there on. After a start or an outage that is the whole
/// window, in calm times two nodes.
class WindowNavigator final : public measurement::Navigator {
 public:
  /// Throws UsageError for noise of the IMU that is zero, naming its key; a bias may be constant.
  WindowNavigator(const FgoOptions& options, preintegration::PreintegrationModel model,
                  const imu::ImuNoise& noise, const state::Layout& layout = {});
  ~WindowNavigator() override;

  void start(const state::Epoch& initial) override;
  void propagate(const ImuIncrement& increment) override;
  state::Innovation innovation(const measurement::Observation& observation) const override;
  void update(const measurement::ObservationPtr& observation) override;
  /// The window ends here: what it knows becomes the prior of a node at the current time.
  void loosen(const state::NodeMatrix& added) override;
  std::unique_ptr<measurement::Navigator> ahead(double scale) const override;
  void hold() override;
  state::Epoch epoch() const override;

  std::size_t nodes() const { return nodes_.size(); }

 private:
  /// What the past and the node's own observations say of it and the border, as a quadratic form at
  /// a state.
  struct Linearization {
    state::NodeState at;
    state::SlowVector slow;
    NodeInformation information;
  };
  struct Node {
    int64_t t_ns = 0;
    state::NodeState x;
    std::deque<ObservationFactor> observations;
    Linearization past;
  };
  /// Between a node and the next.
  struct Interval : ImuInterval {
    Elimination elimination;  ///< of the node before it, at the linearizations of both
  };
  struct Prediction {
    state::NodeState x;
    state::StateMatrix covariance;  ///< with that of the border
  };

  void begin_window(int64_t t_ns, const state::NodeState& x, const state::StateMatrix& covariance);
  void begin_interval();
  Prediction prediction() const;
  void add_node(const state::NodeState& x, const preintegration::Preintegration& pre);
  void solve();
  int64_t optimize(std::size_t from);
  void linearize(std::size_t from);
  void carry_back(std::size_t from);
  std::size_t first_unsettled();
  bool has_moved(const Node& node) const;
  bool has_bent(const ObservationFactor& observation, const Node& node) const;
  void add_observations(Node& node) const;
  void marginalize_old();
  bool at_node() const { return integrator_->dt() == 0; }

  FgoOptions options_;
  GraphContext context_;  ///< its frame since start()
  imu::ImuNoise noise_;
  std::unique_ptr<ceres::LossFunction> loss_;

  preintegration::EarthModel earth_;  ///< of the interval from the newest node on
  std::deque<Node> nodes_;
  std::deque<Interval> intervals_;  ///< one less than nodes
  state::SlowVector slow_;          ///< the border
  SquareRootPrior prior_;           ///< on the first node, without its observations
  std::optional<preintegration::Preintegrator> integrator_;  ///< from the newest node on
  ImuInterval open_;                                         ///< its increments
  imu::RecentRates rates_{imu::kLeverArmRateMemory};
  state::StateMatrix covariance_;  ///< of the newest node and the border
  bool is_trial_ = false;          ///< drives ahead of another, which tells what solving takes
};

}  // namespace foucault::fgo
