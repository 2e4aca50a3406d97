#pragma once

#include <memory>
#include <string>
#include <vector>

#include "foucault/core/config.h"
#include "foucault/fgo/fgo_options.h"
#include "foucault/fgo/gnss_factor.h"
#include "foucault/fgo/imu_interval.h"
#include "foucault/fgo/prior_factor.h"
#include "foucault/inertial/smoother.h"

/// Smoothing by one optimization over a whole log: the cost (48) with every node in the window.
namespace foucault {

/// Section `batch` of the configuration.
class BatchOptions : public Configurable {
 public:
  std::string model = "full";  ///< preintegration: refined | rough | full
  std::string start = "ekf";   ///< forward method that gives the first estimate

  void fields(ConfigFields& f) override;
  PreintegrationModel preintegration_model() const;
};

/// A chain of nodes, each joined to the next by an interval: nodes.size() == intervals.size() + 1.
struct BatchNode {
  int64_t t_ns = 0;
  NodeState x;  ///< first estimate
  std::vector<LocalFix> fixes;
};
struct BatchChain {
  LocalFrame frame{Geodetic{}};  ///< w
  SquareRootPrior prior;         ///< on the first node
  std::vector<BatchNode> nodes;
  std::vector<ImuInterval> intervals;
};

struct BatchSolution {
  std::vector<NodeState> x;
  std::vector<Matrix15d> covariance_w;  ///< of each node, from everything
};

/// Minimizes the cost by Ceres from the nodes' first estimates; intervals whose bias has moved are
/// integrated again if their increments were kept, and in `full` gravity is that of where the
/// nodes come to lie. Time and memory are linear in the nodes: the
/// covariances come from eliminating the chain from both ends, not from inverting it.
/// Throws std::runtime_error if the problem cannot be solved.
BatchSolution solve(BatchChain& chain, const FgoOptions& options, PreintegrationModel model,
                    const ImuNoise& noise);

/// Runs another navigator forward and leaves the chain of its way.
/// A node stands at every fix, hold and mark, and the ends of a run; about 6 kB each while it
/// runs, 55 kB while it is solved. Increments are kept only while the bias is so uncertain that the
/// interval may have to be integrated again.
class BatchRecorder final : public Navigator, public Recording {
 public:
  /// Throws UsageError for noise of the IMU that is zero, naming its key; a bias may be constant.
  BatchRecorder(std::unique_ptr<Navigator> forward, const FgoOptions& options,
                PreintegrationModel model, const ImuNoise& noise);

  void start(const Epoch& initial) override;
  void propagate(const ImuIncrement& increment) override;
  Innovation innovation(const Observation& observation) const override {
    return forward_->innovation(observation);
  }
  void update(const ObservationPtr& observation) override;
  void loosen(const Matrix15d& added) override;
  std::unique_ptr<Navigator> ahead(double scale) const override { return forward_->ahead(scale); }
  void hold() override;
  Epoch epoch() const override { return forward_->epoch(); }

  std::size_t mark() override;
  bool at_node() const override { return integrator_ && integrator_->dt() == 0; }
  std::size_t size() const override { return passages_.size(); }
  std::deque<SmoothedEpoch> smoothed() override;

 private:
  /// What the forward run had at a node.
  struct Passage {
    NavState predicted, filtered;
  };

  Matrix15d covariance_w(const Epoch& now) const;
  void begin_interval(const Epoch& now);
  void close_interval();
  void add_node(const Epoch& now);
  SmoothedEpoch smoothed_at(const Passage& passage, const Epoch& epoch) const;

  std::unique_ptr<Navigator> forward_;
  FgoOptions options_;
  PreintegrationModel model_;
  ImuNoise noise_;

  std::optional<LocalFrame> frame_;          ///< at the first start
  std::vector<BatchChain> chains_;           ///< one a start
  std::vector<Passage> passages_;            ///< one a node, all chains
  std::optional<Preintegrator> integrator_;  ///< from the newest node on
  ImuInterval open_;
  EarthModel earth_;
};

/// Method `batch`.
std::unique_ptr<Estimator> make_batch_smoother(std::unique_ptr<Navigator> forward,
                                               const FgoOptions& options, PreintegrationModel model,
                                               const ImuNoise& noise, Aligner aligner,
                                               const NavigationRunOptions& run_options, Sink& sink);

}  // namespace foucault
