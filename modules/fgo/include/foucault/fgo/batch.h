#pragma once

#include <memory>
#include <string>
#include <vector>

#include "foucault/core/config.h"
#include "foucault/fgo/batch_solver.h"
#include "foucault/imu/recent_rates.h"
#include "foucault/measurement/navigator.h"
#include "foucault/measurement/recording.h"

/// Smoothing by one optimization over a whole log: the cost (48) with every node in the window.
namespace foucault::fgo {

/// Section `batch` of the configuration.
class BatchOptions : public Configurable {
 public:
  std::string model = "full";  ///< preintegration: refined | rough | full
  std::string start = "ekf";   ///< forward method that gives the first estimate
  double memory_mb = 2000;     ///< for what is kept of a log

  /// As many nodes take that much memory.
  std::size_t most_nodes(const state::Layout& layout) const;

  void fields(ConfigFields& f) override;
  preintegration::PreintegrationModel preintegration_model() const;
};

/// A log that is too long to be kept as a whole is smoothed in parts, in two passes over it: the
/// first finds how the parts hang together, the second gives them out as the whole would have them.
struct BatchPasses {
  std::size_t most_nodes = 0;   ///< kept at a time
  std::vector<PartLink> known;  ///< by the pass before
  std::vector<PartLink> found;  ///< by this one
  bool in_parts = false;        ///< this pass
  bool is_final() const { return !in_parts || !known.empty(); }
};

/// Runs another navigator forward and leaves the chain of its way.
/// A node stands at every observation, hold and mark, and the ends of a run; less than 6 kB each.
/// Without `passes` a log is kept as a whole. Increments are kept only while the bias is so
/// uncertain that the interval may have to be integrated again.
class BatchRecorder final : public measurement::Navigator, public measurement::Recording {
 public:
  /// Throws UsageError for noise of the IMU that is zero, naming its key; a bias may be constant.
  BatchRecorder(std::unique_ptr<measurement::Navigator> forward, const FgoOptions& options,
                preintegration::PreintegrationModel model, const imu::ImuNoise& noise,
                const state::Layout& layout = {}, std::shared_ptr<BatchPasses> passes = nullptr);

  void start(const state::Epoch& initial) override;
  void propagate(const ImuIncrement& increment) override;
  state::Innovation innovation(const measurement::Observation& observation) const override {
    return forward_->innovation(observation);
  }
  void update(const measurement::ObservationPtr& observation) override;
  void loosen(const state::NodeMatrix& added) override;
  std::unique_ptr<measurement::Navigator> ahead(double scale) const override {
    return forward_->ahead(scale);
  }
  void hold() override;
  state::Epoch epoch() const override { return forward_->epoch(); }

  std::size_t mark() override;
  bool at_node() const override { return integrator_ && integrator_->dt() == 0; }
  std::size_t size() const override { return given_out_ + passages_.size(); }
  std::deque<measurement::SmoothedEpoch> settled() override;
  std::deque<measurement::SmoothedEpoch> smoothed() override;

 private:
  /// What the forward run had at a node, without slow blocks.
  struct Passage {
    state::NavState predicted, filtered;
  };

  SquareRootPrior prior_of(const state::Epoch& epoch) const;
  void begin_interval(const state::Epoch& now);
  void close_interval();
  void add_node(const state::Epoch& now);
  void smooth_first_chain(std::deque<measurement::SmoothedEpoch>& out);
  void smooth_part(std::deque<measurement::SmoothedEpoch>& out);
  void give_out(BatchSolution& solution, std::deque<measurement::SmoothedEpoch>& out);
  measurement::SmoothedEpoch smoothed_at(const Passage& passage, const state::Epoch& epoch) const;

  std::unique_ptr<measurement::Navigator> forward_;
  FgoOptions options_;
  GraphContext context_;  ///< its frame since the first start
  imu::ImuNoise noise_;

  std::shared_ptr<BatchPasses> passes_;
  std::vector<NodeEstimate> behind_;  ///< the parts, from the pass before

  std::deque<BatchChain> chains_;                            ///< one a start
  std::deque<Passage> passages_;                             ///< one a node, all chains
  std::size_t given_out_ = 0;                                ///< nodes
  std::optional<preintegration::Preintegrator> integrator_;  ///< from the newest node on
  ImuInterval open_;
  imu::RecentRates rates_{imu::kLeverArmRateMemory};
  preintegration::EarthModel earth_;
};

}  // namespace foucault::fgo
