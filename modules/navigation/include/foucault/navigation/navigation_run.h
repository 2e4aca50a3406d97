#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <variant>

#include "foucault/alignment/alignment.h"
#include "foucault/measurement/navigator.h"
#include "foucault/navigation/run.h"
#include "foucault/navigation/run_options.h"
#include "foucault/state/interfaces.h"

namespace foucault::navigation {

class Aligning;
class Bridging;
class Doubting;
class Driving;
class Intake;
struct FixInDoubt;
struct HoleMet;
struct Start;
using Interruption = std::variant<std::monostate, HoleMet, FixInDoubt>;

/// The driver that all methods share: alignment, then a Navigator fed in order of time.
/// - Increments are split at the stamps of fixes, requests and holds.
/// - A hold comes when node_interval_s has passed since the last fix that was used (or hold).
/// - Epochs go to the sink at the start, after every fix, hold and request, one a stamp; with
///   EpochRate::imu also at the end of every increment.
/// - Holes between increments are bridged (GapOptions), those of half a second and more not before
///   fixes after the hole tell how the vehicle turned in it, at most 3 s later; beyond max_gap_s
///   the run aligns again.
/// - Fixes are gated by the chi-square test of their innovation (3 degrees of freedom), relative to
///   the median of recent ones where that is above its expectation. Where one does not pass, or is
///   the first after an outage, what follows is held back until it shows whether the fixes or the
///   state are wrong (diagnosis/fix_doubt.h), 90 s at most; epochs and fixes are given out that
///   much later, as if it had been known at once. After a hole the gate is open for ten seconds.
/// - Velocities of fixes that were used are gated in the same way, by themselves, if the aids have
///   them.
/// - Before the alignment, fixes that no vehicle can reach from their neighbours are left out.
/// - Positions given again and again under new stamps count once (out_of_order).
/// - Fixes that are no position, or that no vehicle reaches from the others, are left out, counted
///   and named.
/// - Fixes that repeat the one before them, come late, or are stamped more than an hour from the
///   IMU are left out (out_of_order).
/// - Increments that are not finite, or do not come after the one before, are left out, counted and
///   named; samples of a clipped or stuck gyroscope are a hole, those of such an
///   accelerometer get more noise.
/// - If the sink wants predictions, fixes are now and then predicted 5, 15 and 30 s ahead.
/// - Fixes up to the alignment's start stamp are not used again and have no FixResult.
/// - After a new alignment the biases known before it still count, with doubled sigmas.
/// process() throws DataError for what makes a recording useless: units of the IMU, turned axes,
/// clocks that are seconds apart; and at the first epoch that is not finite, so that none comes
/// out. Memory is bounded: before alignment, at most what the Aligner may still start from is held.
/// finish() throws DataError if there was no IMU, no usable fix, or no alignment, or if more than
/// half of the increments had to be left out: why, and what to do about it.
class NavigationRun : public Run {
 public:
  NavigationRun(std::unique_ptr<measurement::Navigator> navigator,
                const NavigationRunOptions& options, state::Sink& sink);
  /// With an aligner of one's own.
  NavigationRun(std::unique_ptr<measurement::Navigator> navigator, alignment::Aligner aligner,
                const NavigationRunOptions& options, state::Sink& sink);
  ~NavigationRun() override;

  void process(const Measurement& measurement) override;
  void observe(int64_t t_ns, const measurement::ObservationPtr& observation) override;
  void finish() override;

 private:
  /// Each a class of its own, in src/.
  enum class Phase { aligning, driving, bridging, doubting };

  void go_through(const Measurement& measurement);
  void go_through_waiting();
  void take(const Measurement& measurement);
  bool end_phase();

  void begin(const Start& start);
  void interrupt(const Interruption& interruption);
  void meet_hole(const ImuIncrement& next);
  void bridge();
  void realign(const ImuIncrement& next);
  void doubt(const FixInDoubt& in_doubt);
  void resolve();

  /// Before what waits already.
  template <class Measurements>
  void put_first(const Measurements& measurements);

  state::Sink& sink_;
  NavigationRunOptions options_;
  Phase phase_ = Phase::aligning;
  std::deque<Measurement> waiting_;  ///< to be gone through, in order
  std::unique_ptr<Intake> intake_;
  std::unique_ptr<Aligning> aligning_;
  std::unique_ptr<Driving> driving_;
  std::unique_ptr<Bridging> bridging_;  ///< in that phase
  std::unique_ptr<Doubting> doubting_;  ///< in that phase
  bool started_ = false;
  std::optional<state::Epoch> before_hole_;  ///< the last state before a new alignment
};

}  // namespace foucault::navigation
