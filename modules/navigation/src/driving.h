#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "aiding.h"
#include "fix_gate.h"
#include "foucault/core/measurement.h"
#include "foucault/diagnosis/fix_judge.h"
#include "foucault/imu/recent_rates.h"
#include "foucault/measurement/navigator.h"
#include "foucault/navigation/run_options.h"
#include "foucault/state/interfaces.h"
#include "heading_aid.h"
#include "prediction_probe.h"
#include "stop_queue.h"

namespace foucault::navigation {

/// The increments that have come so far end before this one begins.
struct HoleMet {
  ImuIncrement next;
};

/// A fix that is due now is in doubt.
struct FixInDoubt {
  GnssFix fix;                       ///< as it came
  GnssFix trusted;                   ///< with the sigmas of the configuration
  bool returns = false;              ///< no fix has held the state for a while
  std::optional<ImuIncrement> rest;  ///< of the increment on the way
};

/// What ends the phase of driving; see navigation_run.h.
using Interruption = std::variant<std::monostate, HoleMet, FixInDoubt>;

/// The phase with a state and nothing in doubt: increments move the navigator from stop to stop,
/// fixes are decided upon and used, epochs and results go to the sink.
class Driving {
 public:
  Driving(std::unique_ptr<measurement::Navigator> navigator, const NavigationRunOptions& options,
          state::Sink& sink);

  void start(const state::Epoch& initial);
  /// In order. Whatever interrupts comes back with all that has not been driven.
  Interruption take(const Measurement& measurement);
  /// Is used once the drive has come to its stamp.
  void observe(const Observed& observed);
  /// Goes on from a fix that was in doubt.
  Interruption resume(const GnssFix& doubted, const diagnosis::DoubtOutcome& outcome);
  /// The run ends here, for a new alignment: what waits, which is forgotten.
  std::vector<Measurement> take_pending() { return stops_.clear(); }

  /// The state has become worse than its covariance may say: the gate is open for ten seconds.
  void doubt_state(int64_t t_ns);
  /// Mean rates before now, which are forgotten; those of `next` if there are none.
  imu::RecentRates take_recent_rates(const ImuIncrement& next);

  int64_t time_ns() const { return time_ns_; }
  const measurement::Navigator& navigator() const { return *navigator_; }
  const diagnosis::FixJudge& judge() const { return gate_.judge(); }
  std::vector<GnssFix> pending_fixes() const { return stops_.pending_fixes(); }
  /// Of the aids, at the end.
  std::vector<std::string> remarks() const;
  int64_t late_fixes() const { return late_; }  ///< left out: they came after later ones

  /// For a fix that does not come so far.
  void leave_out(const GnssFix& fix, state::FixVerdict verdict);

 private:
  Interruption interruption();
  void take_event(const StopEvent& event);
  std::optional<HoleMet> take_increment(const ImuIncrement& increment);
  bool advance(const ImuIncrement& increment);
  void propagate(const ImuIncrement& increment);
  bool is_held() const;
  void stop();

  void meet_fix(const GnssFix& fix);
  state::FixVerdict carry_out(const diagnosis::FixDecision& decision, const GnssFix& fix,
                              state::FixResult& result);
  void use(const GnssFix& fix, state::FixResult& result);
  void use_velocity(const GnssFix& fix);
  void meet(const Observed& observed);
  void predict_ahead(const GnssFix& fix);
  void fix_used();
  void notice_bad_sigma(const GnssFix& fix);
  void notice_late(const Observed& observed);

  void emit_epoch();
  [[noreturn]] void throw_unsound(const std::string& part) const;

  std::unique_ptr<measurement::Navigator> navigator_;
  NavigationRunOptions options_;
  state::Sink& sink_;

  int64_t time_ns_ = 0;
  StopQueue stops_;
  FixGate gate_;
  Aiding aiding_;
  HeadingAid heading_;
  diagnosis::FixJudge velocity_judge_;
  std::optional<FixInDoubt> in_doubt_;
  imu::RecentRates recent_;               ///< before now, for bridging a hole
  std::optional<PredictionProbe> probe_;  ///< if predictions are wanted
  std::optional<int64_t> last_epoch_ns_;
  int64_t late_ = 0;
  bool noticed_bad_sigma_ = false;
  bool noticed_late_ = false;
};

}  // namespace foucault::navigation
