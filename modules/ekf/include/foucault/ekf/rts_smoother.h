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
/// solution.
class RtsSmoother : public Estimator {
 public:
  RtsSmoother(const ImuNoise& imu, const EkfOptions& options, Aligner aligner,
              const NavigationRunOptions& run_options, Sink& sink);

  void process(const Measurement& measurement) override { run_.process(measurement); }
  void finish() override;

 private:
  /// Keeps what the forward run gives out, in its order, and marks a node for every epoch.
  class Keeper : public Sink {
   public:
    explicit Keeper(RtsRecorder& recorder) : recorder_(recorder) {}
    void epoch(const Epoch& epoch) override;
    void fix(const FixResult& result) override;
    void notice(const Notice& notice) override;
    void give_out(Sink& sink) const;

   private:
    struct NodeEpoch {
      std::size_t node;
    };
    struct NodeFix {
      std::size_t node;
      FixResult result;
    };
    RtsRecorder& recorder_;
    std::vector<std::variant<NodeEpoch, NodeFix, Notice>> kept_;
  };

  RtsSmoother(std::unique_ptr<RtsRecorder> recorder, Aligner aligner,
              const NavigationRunOptions& run_options, Sink& sink);

  RtsRecorder& recorder_;  ///< owned by run_
  Keeper keeper_;
  NavigationRun run_;
  Sink& sink_;
};

}  // namespace foucault
