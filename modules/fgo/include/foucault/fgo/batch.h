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
  preintegration::PreintegrationModel preintegration_model() const;
};

/// Runs another navigator forward and leaves the chain of its way.
/// A node stands at every observation, hold and mark, and the ends of a run; less than 6 kB each.
/// Increments are kept only while the bias is so uncertain that the
/// interval may have to be integrated again.
class BatchRecorder final : public measurement::Navigator, public measurement::Recording {
 public:
  /// Throws UsageError for noise of the IMU that is zero, naming its key; a bias may be constant.
  BatchRecorder(std::unique_ptr<measurement::Navigator> forward, const FgoOptions& options,
                preintegration::PreintegrationModel model, const imu::ImuNoise& noise,
                const state::Layout& layout = {});

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
  std::size_t size() const override { return passages_.size(); }
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
  measurement::SmoothedEpoch smoothed_at(const Passage& passage, const state::Epoch& epoch) const;

  std::unique_ptr<measurement::Navigator> forward_;
  FgoOptions options_;
  GraphContext context_;  ///< its frame since the first start
  imu::ImuNoise noise_;

  std::deque<BatchChain> chains_;                            ///< one a start
  std::deque<Passage> passages_;                             ///< one a node, all chains
  std::optional<preintegration::Preintegrator> integrator_;  ///< from the newest node on
  ImuInterval open_;
  imu::RecentRates rates_{imu::kLeverArmRateMemory};
  preintegration::EarthModel earth_;
};

}  // namespace foucault::fgo
