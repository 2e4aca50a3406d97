#include "foucault/navigation/navigation_run.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "aligning.h"
#include "bridging.h"
#include "doubting.h"
#include "driving.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "intake.h"
#include "known_biases.h"

namespace foucault::navigation {

using state::NoticeKind;

alignment::Aligner aligner_of(const NavigationRunOptions& options) {
  return {options.alignment, options.imu, options.mounting, options.layout};
}

NavigationRun::~NavigationRun() = default;

NavigationRun::NavigationRun(std::unique_ptr<measurement::Navigator> navigator,
                             const NavigationRunOptions& options, state::Sink& sink)
    : NavigationRun(std::move(navigator), aligner_of(options), options, sink) {}

NavigationRun::NavigationRun(std::unique_ptr<measurement::Navigator> navigator,
                             alignment::Aligner aligner, const NavigationRunOptions& options,
                             state::Sink& sink)
    : sink_(sink),
      options_(options),
      intake_(std::make_unique<Intake>(options)),
      aligning_(std::make_unique<Aligning>(std::move(aligner), options.gnss)),
      driving_(std::make_unique<Driving>(std::move(navigator), options, sink)) {}

/// What passes the intake goes through the phases: aligning, then driving, interrupted by bridging
/// and doubting. What a phase has held back is gone through again, first, once it ends.
void NavigationRun::process(const Measurement& measurement) {
  const Admitted admitted = intake_->admit(measurement);
  if (!admitted.notice.empty()) {
    sink_.notice({stamp(measurement), NoticeKind::skipped, admitted.notice});
  }
  if (admitted.weakens_state) driving_->doubt_state(stamp(measurement));
  if (admitted.left_out && phase_ != Phase::aligning) {
    driving_->leave_out(std::get<GnssFix>(measurement), *admitted.left_out);
  }
  if (admitted.measurement) go_through(*admitted.measurement);
}

/// Waits where the drive has not come to yet, whatever the phase.
void NavigationRun::observe(int64_t t_ns, const measurement::ObservationPtr& observation) {
  if (!observation) throw std::invalid_argument("no observation");
  driving_->observe({t_ns, observation});
}

void NavigationRun::go_through(const Measurement& measurement) {
  take(measurement);
  go_through_waiting();
}

void NavigationRun::go_through_waiting() {
  while (!waiting_.empty()) {
    const Measurement next = std::move(waiting_.front());
    waiting_.pop_front();
    sink_.catching_up(waiting_.size());
    take(next);
  }
}

void NavigationRun::take(const Measurement& measurement) {
  switch (phase_) {
    case Phase::aligning:
      if (const std::optional<Start> start = aligning_->take(measurement)) begin(*start);
      return;
    case Phase::driving:
      return interrupt(driving_->take(measurement));
    case Phase::bridging:
      if (bridging_->take(measurement)) bridge();
      return;
    case Phase::doubting:
      if (doubting_->take(measurement)) resolve();
      return;
  }
}

void NavigationRun::finish() {
  while (end_phase()) go_through_waiting();
  intake_->throw_if_nothing_usable();
  if (!started_) throw DataError(aligning_->why_not());
  for (const std::string& line : intake_->summary(driving_->late_fixes())) {
    sink_.notice({driving_->time_ns(), NoticeKind::skipped, line});
  }
  for (const std::string& remark : driving_->remarks()) {
    sink_.notice({driving_->time_ns(), NoticeKind::skipped, remark});
  }
  for (const state::Notice& warning : intake_->warnings()) sink_.warning(warning);
}

/// Nothing follows: whether something was still held back.
bool NavigationRun::end_phase() {
  switch (phase_) {
    case Phase::aligning: {
      const std::optional<Start> start = aligning_->finish();
      if (start) begin(*start);
      return start.has_value();
    }
    case Phase::driving:
      return false;
    case Phase::bridging:
      bridge();
      return true;
    case Phase::doubting:
      resolve();
      return true;
  }
  return false;
}

// From phase to phase ---------------------------------------------------------------------------

void NavigationRun::begin(const Start& start) {
  const state::Epoch initial =
      before_hole_ ? with_known_biases(start.initial, *before_hole_) : start.initial;
  sink_.notice(
      {initial.t_ns, started_ ? NoticeKind::realigned : NoticeKind::aligned, aligning_->summary()});
  phase_ = Phase::driving;
  started_ = true;
  driving_->start(initial);
  put_first(start.since);
}

void NavigationRun::interrupt(const Interruption& interruption) {
  if (const auto* hole = std::get_if<HoleMet>(&interruption)) meet_hole(hole->next);
  if (const auto* in_doubt = std::get_if<FixInDoubt>(&interruption)) doubt(*in_doubt);
}

/// Short holes are bridged at once, long ones end the alignment. In between what follows is held
/// back until the course after the hole tells how the vehicle has turned in it.
void NavigationRun::meet_hole(const ImuIncrement& next) {
  constexpr double kMayHideATurn = 0.5;  // [s]
  const imu::RecentRates rates = driving_->take_recent_rates(next);
  const double gap = seconds_between(driving_->time_ns(), next.t_begin_ns);
  if (gap > options_.gaps.max_gap_s) return realign(next);
  const bool waits = gap >= kMayHideATurn;
  ImuHole hole;
  if (waits) hole.before = driving_->navigator().epoch();
  hole.before.t_ns = driving_->time_ns();
  hole.gyro_before_b = rates.gyro_b;
  hole.accel_before_b = rates.accel_b;
  hole.interval = intake_->usual_interval();
  hole.after = next;
  bridging_ = std::make_unique<Bridging>(hole);
  phase_ = Phase::bridging;
  if (!waits) bridge();
}

/// Goes on over the hole, then over what was held back.
void NavigationRun::bridge() {
  constexpr double kNoticeable = 0.2;  // [s]: a few lost samples are not worth a line
  const std::unique_ptr<Bridging> bridging = std::move(bridging_);
  const ImuHole& hole = bridging->hole();
  phase_ = Phase::driving;
  put_first(bridging->held());
  put_first(bridging->bridge(options_.gaps));
  if (hole.length() < kNoticeable) return;
  const int64_t end_ns = hole.after.t_begin_ns;
  driving_->doubt_state(end_ns);
  sink_.notice({end_ns, NoticeKind::imu_gap,
                fmt::format("no IMU data for {:.3f} s up to {}; bridged{}", hole.length(),
                            utc_text(end_ns), hole.turn ? ", with the turn that GNSS shows" : "")});
}

void NavigationRun::realign(const ImuIncrement& next) {
  const int64_t now_ns = driving_->time_ns();
  sink_.notice({next.t_begin_ns, NoticeKind::imu_gap,
                fmt::format("no IMU data for {:.1f} s from {}; aligning anew, biases are kept",
                            seconds_between(now_ns, next.t_begin_ns), utc_text(now_ns))});
  before_hole_ = driving_->navigator().epoch();
  phase_ = Phase::aligning;
  aligning_->restart();
  std::vector<Measurement> held;
  for (const Measurement& event : driving_->take_pending()) {
    if (stamp(event) >= next.t_begin_ns) held.push_back(event);
  }
  held.push_back(next);
  put_first(held);
}

void NavigationRun::doubt(const FixInDoubt& in_doubt) {
  phase_ = Phase::doubting;
  doubting_ = std::make_unique<Doubting>(
      in_doubt.fix,
      std::make_unique<diagnosis::FixDoubt>(options_.gnss, driving_->judge(), driving_->navigator(),
                                            in_doubt.trusted, in_doubt.returns),
      options_.gnss);
  for (const GnssFix& fix : driving_->pending_fixes()) doubting_->show(fix);
  if (in_doubt.rest) waiting_.push_front(*in_doubt.rest);
}

/// Goes on from the fix that was in doubt, then over what was held back.
void NavigationRun::resolve() {
  const std::unique_ptr<Doubting> doubting = std::move(doubting_);
  phase_ = Phase::driving;
  put_first(doubting->held());
  interrupt(driving_->resume(doubting->doubted(), doubting->outcome()));
}

template <class Measurements>
void NavigationRun::put_first(const Measurements& measurements) {
  waiting_.insert(waiting_.begin(), measurements.begin(), measurements.end());
}

}  // namespace foucault::navigation
