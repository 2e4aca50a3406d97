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

  void fields(ConfigFields& f) override;
  PreintegrationModel preintegration_model() const;
};

/// Runs another navigator forward and leaves the chain of its way.
/// A node stands at every observation, hold and mark, and the ends of a run; less than 6 kB each.
/// Increments are kept only while the bias is so uncertain that the
/// interval may have to be integrated again.
class BatchRecorder final : public Navigator, public Recording {
 public:
  /// Throws UsageError for noise of the IMU that is zero, naming its key; a bias may be constant.
  BatchRecorder(std::unique_ptr<Navigator> forward, const FgoOptions& options,
                PreintegrationModel model, const ImuNoise& noise, const Layout& layout = {});

  void start(const Epoch& initial) override;
  void propagate(const ImuIncrement& increment) override;
  Innovation innovation(const Observation& observation) const override {
    return forward_->innovation(observation);
  }
  void update(const ObservationPtr& observation) override;
  void loosen(const NodeMatrix& added) override;
  std::unique_ptr<Navigator> ahead(double scale) const override { return forward_->ahead(scale); }
  void hold() override;
  Epoch epoch() const override { return forward_->epoch(); }

  std::size_t mark() override;
  bool at_node() const override { return integrator_ && integrator_->dt() == 0; }
  std::size_t size() const override { return passages_.size(); }
  std::deque<SmoothedEpoch> smoothed() override;

 private:
  /// What the forward run had at a node, without slow blocks.
  struct Passage {
    NavState predicted, filtered;
  };

  SquareRootPrior prior_of(const Epoch& epoch) const;
  void begin_interval(const Epoch& now);
  void close_interval();
  void add_node(const Epoch& now);
  SmoothedEpoch smoothed_at(const Passage& passage, const Epoch& epoch) const;

  std::unique_ptr<Navigator> forward_;
  FgoOptions options_;
  GraphContext context_;  ///< its frame since the first start
  ImuNoise noise_;

  std::deque<BatchChain> chains_;            ///< one a start
  std::deque<Passage> passages_;             ///< one a node, all chains
  std::optional<Preintegrator> integrator_;  ///< from the newest node on
  ImuInterval open_;
  RecentRates rates_{kLeverArmRateMemory};
  EarthModel earth_;
};

}  // namespace foucault::fgo
