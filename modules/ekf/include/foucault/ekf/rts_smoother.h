#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "foucault/core/interfaces.h"
#include "foucault/ekf/rts.h"
#include "foucault/inertial/navigation_run.h"

namespace foucault {

/// Method `rts`: the EKF forward, then backward; every epoch is given out at finish(), from all
/// fixes. Innovations of fixes are those of the forward run, postfits those of the smoothed
/// solution. With EpochRate::imu the epochs between nodes are interpolated, see between(); memory
/// then grows by 200 bytes an epoch, else by 6 kB.
class RtsSmoother : public Estimator {
 public:
  RtsSmoother(const ImuNoise& imu, const EkfOptions& options, Aligner aligner,
              const NavigationRunOptions& run_options, Sink& sink);

  void process(const Measurement& measurement) override { run_.process(measurement); }
  void finish() override;

 private:
  /// Keeps what the forward run gives out, in its order.
  class Keeper : public Sink {
   public:
    Keeper(RtsRecorder& recorder, EpochRate rate) : recorder_(recorder), rate_(rate) {}
    void epoch(const Epoch& epoch) override;
    void fix(const FixResult& result) override;
    void notice(const Notice& notice) override;
    /// Smooths, once the forward run is over.
    void give_out(Sink& sink);

   private:
    struct NodeEpoch {
      std::size_t node;
    };
    struct BetweenEpoch {
      std::size_t node;  ///< the one before
      StrapdownState forward;
    };
    struct NodeFix {
      std::size_t node;
      FixResult result;
    };
    FixResult smoothed(const NodeFix& fix, const SmoothedNode& node) const;

    RtsRecorder& recorder_;
    EpochRate rate_;
    std::vector<std::variant<NodeEpoch, BetweenEpoch, NodeFix, FixResult, Notice>> kept_;
  };

  RtsSmoother(std::unique_ptr<RtsRecorder> recorder, Aligner aligner,
              const NavigationRunOptions& run_options, Sink& sink);

  Keeper keeper_;
  NavigationRun run_;
  Sink& sink_;
};

}  // namespace foucault
