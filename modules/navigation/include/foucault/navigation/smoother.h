#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "foucault/measurement/recording.h"
#include "foucault/navigation/navigation_run.h"
#include "foucault/state/forward_sink.h"

/// Smoothing: a forward run that leaves nodes, and afterwards every epoch from all fixes.
namespace foucault::navigation {

/// The smoothed solution between two neighbouring nodes, where the forward run had `forward`: the
/// errors found after `begin` and before `end` are interpolated, that of the position to the third
/// order with those of the velocity. With nodes a second apart it differs from that of a node there
/// by millimetres after an outage of 60 s. The covariance is interpolated.
state::Epoch between(const measurement::SmoothedEpoch& begin, const measurement::SmoothedEpoch& end,
                     const state::NavState& forward);

/// Runs a recording navigator forward, of which a ForwardSink is told the epochs, and gives out
/// epochs from all fixes: everything at finish(), of a recording in parts some before.
/// Innovations of fixes are those of the forward run, postfits those of the smoothed solution. With
/// EpochRate::imu the epochs between nodes are interpolated, see between(); memory then grows by
/// 200 bytes an epoch, else by what a node takes. finish() throws DataError if a node's solution is
/// not finite; nothing has been given out then.
class Smoother : public Run {
 public:
  /// `recording` is what `navigator` leaves; both live as long as this. Residuals of fixes are by
  /// the layout of the options.
  Smoother(std::unique_ptr<measurement::Navigator> navigator, measurement::Recording& recording,
           alignment::Aligner aligner, const NavigationRunOptions& options, state::Sink& sink);

  void process(const Measurement& measurement) override;
  void observe(int64_t t_ns, const measurement::ObservationPtr& observation) override {
    run_.observe(t_ns, observation);
  }
  void finish() override;

 private:
  /// Keeps what the forward run gives out, in its order.
  class Keeper : public state::Sink {
   public:
    Keeper(measurement::Recording& recording, EpochRate rate, state::Sink& sink,
           const state::Layout& layout)
        : recording_(recording),
          rate_(rate),
          sink_(sink),
          layout_(layout),
          forward_(dynamic_cast<state::ForwardSink*>(&sink)) {}
    /// Of the recording, used or not.
    void first_fix(int64_t t_ns) {
      if (!first_fix_ns_) first_fix_ns_ = t_ns;
    }
    void epoch(const state::Epoch& epoch) override;
    void fix(const state::FixResult& result) override;
    void observation(const state::ObservationResult& result) override {
      kept_.emplace_back(result);
    }
    void notice(const state::Notice& notice) override;
    bool wants_predictions() const override { return sink_.wants_predictions(); }
    void catching_up(std::size_t left) override { sink_.catching_up(left); }
    void warning(const state::Notice& notice) override { warnings_.push_back(notice); }
    /// Those of the forward run; they do not wait.
    void prediction(const state::PredictionResult& result) override { sink_.prediction(result); }
    /// Smooths, once the forward run is over.
    void give_out();

   private:
    void give_out_settled();
    void give_out(std::deque<measurement::SmoothedEpoch> nodes);
    struct NodeEpoch {
      std::size_t node;
    };
    struct BetweenEpoch {
      std::size_t node;  ///< the one before
      state::NavState forward;
    };
    struct NodeFix {
      std::size_t node;
      state::FixResult result;
    };

    measurement::Recording& recording_;
    EpochRate rate_;
    state::Sink& sink_;
    state::Layout layout_;
    std::optional<int64_t> first_fix_ns_;
    state::ForwardSink* forward_;  ///< the same, if it is one
    using Kept = std::variant<NodeEpoch, BetweenEpoch, NodeFix, state::FixResult,
                              state::ObservationResult, state::Notice>;

    /// Gives it out if its nodes are there.
    bool give(const Kept& kept);
    /// Null if it is not there yet.
    const measurement::SmoothedEpoch* node_at(std::size_t node) const;
    state::FixResult with_postfit(const state::FixResult& forward, const state::NavState& x) const;

    std::deque<Kept> kept_;
    std::deque<measurement::SmoothedEpoch> nodes_;  ///< smoothed; a few before what is kept
    std::size_t nodes_gone_ = 0;                    ///< before them
    std::vector<state::Notice> warnings_;
  };

  Keeper keeper_;
  NavigationRun run_;
};

/// A smoother on a navigator that is itself the recording: RtsRecorder, BatchRecorder.
template <class Recorder>
std::unique_ptr<Run> make_smoother(std::unique_ptr<Recorder> recorder, alignment::Aligner aligner,
                                   const NavigationRunOptions& options, state::Sink& sink) {
  measurement::Recording& recording = *recorder;
  return std::make_unique<Smoother>(std::move(recorder), recording, std::move(aligner), options,
                                    sink);
}
template <class Recorder>
std::unique_ptr<Run> make_smoother(std::unique_ptr<Recorder> recorder,
                                   const NavigationRunOptions& options, state::Sink& sink) {
  return make_smoother(std::move(recorder), aligner_of(options), options, sink);
}

}  // namespace foucault::navigation
