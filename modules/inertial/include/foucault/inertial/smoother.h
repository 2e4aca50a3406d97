#pragma once

#include <deque>
#include <memory>
#include <variant>
#include <vector>

#include "foucault/inertial/navigation_run.h"
#include "foucault/state/interfaces.h"

/// What smoothers share: a forward run that leaves nodes, and afterwards every epoch from all
/// fixes.
namespace foucault {

/// The solution at a node from everything measured.
struct SmoothedEpoch {
  NavState state;
  PackedSymmetric covariance;
  /// The errors it found: in the forward run's state before the node's measurements, and after
  /// them; the same where there are none.
  NodeVector before = NodeVector::Zero();
  NodeVector after = NodeVector::Zero();

  Epoch epoch() const { return {state, covariance.full()}; }
};

/// The smoothed solution between two neighbouring nodes, where the forward run had `forward`: the
/// errors found after `begin` and before `end` are interpolated, that of the position to the third
/// order with those of the velocity. With nodes a second apart it differs from that of a node there
/// by millimetres after an outage of 60 s. The covariance is interpolated.
Epoch between(const SmoothedEpoch& begin, const SmoothedEpoch& end, const NavState& forward);

/// A Navigator that leaves nodes on its way, for smoothing once the way is over.
class Recording {
 public:
  virtual ~Recording() = default;

  /// Makes sure that there is a node at the current time; gives its index.
  virtual std::size_t mark() = 0;
  virtual bool at_node() const = 0;
  virtual std::size_t size() const = 0;

  /// One a node, in order. Called once, at the end.
  virtual std::deque<SmoothedEpoch> smoothed() = 0;
};

/// Runs a recording navigator forward and gives out everything at finish(), epochs from all fixes.
/// Innovations of fixes are those of the forward run, postfits those of the smoothed solution. With
/// EpochRate::imu the epochs between nodes are interpolated, see between(); memory then grows by
/// 200 bytes an epoch, else by what a node takes. finish() throws DataError if a node's solution is
/// not finite; nothing has been given out then.
class Smoother : public Estimator {
 public:
  /// `recording` is what `navigator` leaves; both live as long as this.
  Smoother(std::unique_ptr<Navigator> navigator, Recording& recording, Aligner aligner,
           const NavigationRunOptions& options, Sink& sink);

  void process(const Measurement& measurement) override { run_.process(measurement); }
  void finish() override;

 private:
  /// Keeps what the forward run gives out, in its order.
  class Keeper : public Sink {
   public:
    Keeper(Recording& recording, EpochRate rate, Sink& sink)
        : recording_(recording), rate_(rate), sink_(sink) {}
    void epoch(const Epoch& epoch) override;
    void fix(const FixResult& result) override;
    void observation(const ObservationResult& result) override { kept_.emplace_back(result); }
    void notice(const Notice& notice) override;
    bool wants_predictions() const override { return sink_.wants_predictions(); }
    /// Those of the forward run; they do not wait.
    void prediction(const PredictionResult& result) override { sink_.prediction(result); }
    /// Smooths, once the forward run is over.
    void give_out();

   private:
    struct NodeEpoch {
      std::size_t node;
    };
    struct BetweenEpoch {
      std::size_t node;  ///< the one before
      NavState forward;
    };
    struct NodeFix {
      std::size_t node;
      FixResult result;
    };

    Recording& recording_;
    EpochRate rate_;
    Sink& sink_;
    std::deque<std::variant<NodeEpoch, BetweenEpoch, NodeFix, FixResult, ObservationResult, Notice>>
        kept_;
  };

  Keeper keeper_;
  NavigationRun run_;
};

}  // namespace foucault
