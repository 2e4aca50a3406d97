#include "driving.h"

#include <fmt/format.h>

#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/position.h"
#include "foucault/core/time.h"
#include "foucault/imu/increments.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/measurement/gnss_velocity.h"
#include "sound_epoch.h"

namespace foucault::navigation {

using diagnosis::FixDecision;
using state::FixResult;
using state::FixVerdict;

namespace {

constexpr double kRecentRatesMemory = 0.3;  // [s]: beyond vibration, well within a manoeuvre

/// Made up to bridge a hole: no rates that were measured.
bool is_made_up(const ImuIncrement& increment) { return increment.extra_gyro_noise_density > 0; }

FixResult result_of(const GnssFix& fix) {
  FixResult result;
  result.t_ns = fix.t_ns;
  result.quality = fix.quality;
  result.antenna = fix.antenna;
  return result;
}

}  // namespace

Driving::Driving(std::unique_ptr<measurement::Navigator> navigator,
                 const NavigationRunOptions& options, state::Sink& sink)
    : navigator_(std::move(navigator)),
      options_(options),
      sink_(sink),
      stops_(options.node_interval_s),
      gate_(options.gnss),
      aiding_(options, sink),
      heading_(options, sink),
      velocity_judge_(options.gnss),
      recent_{kRecentRatesMemory} {
  if (sink.wants_predictions()) probe_.emplace();
}

void Driving::start(const state::Epoch& initial) {
  time_ns_ = initial.t_ns;
  stops_.start(time_ns_);
  gate_.start(time_ns_);
  velocity_judge_.start(time_ns_);
  heading_.start(time_ns_);
  if (probe_) probe_->restart();
  aiding_.start(time_ns_, initial.bias);
  navigator_->start(initial);
  emit_epoch();
}

Interruption Driving::take(const Measurement& measurement) {
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) {
    if (const std::optional<HoleMet> hole = take_increment(*increment)) return *hole;
  } else if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
    take_event(*fix);
  } else if (const auto* request = std::get_if<EpochRequest>(&measurement)) {
    take_event(*request);
  } else if (const auto* speed = std::get_if<WheelSpeed>(&measurement)) {
    aiding_.add(*speed);
  }
  return interruption();
}

Interruption Driving::resume(const GnssFix& doubted, const diagnosis::DoubtOutcome& outcome) {
  for (const std::string& line : outcome.notices) {
    sink_.notice({time_ns_, state::NoticeKind::fix_rejected, line});
  }
  gate_.learn(outcome);
  if (outcome.loosened) navigator_->loosen(*outcome.loosened);
  if (outcome.state_was_wrong) doubt_state(outcome.fixes.back().fix.t_ns);
  meet_fix(doubted);
  stop();
  return interruption();
}

Interruption Driving::interruption() {
  if (!in_doubt_) return {};
  return *std::exchange(in_doubt_, std::nullopt);
}

void Driving::doubt_state(int64_t t_ns) {
  gate_.doubt_state(t_ns);
  velocity_judge_.doubt_state(t_ns);
  heading_.doubt_state(t_ns);
}

std::vector<std::string> Driving::remarks() const {
  std::vector<std::string> all;
  for (const std::optional<std::string>& remark : {aiding_.remark(), heading_.remark()}) {
    if (remark) all.push_back(*remark);
  }
  return all;
}

imu::RecentRates Driving::take_recent_rates(const ImuIncrement& next) {
  if (recent_.seen_s == 0) recent_.add(next);
  return std::exchange(recent_, imu::RecentRates{kRecentRatesMemory});
}

// From stop to stop -----------------------------------------------------------------------------

void Driving::take_event(const StopEvent& event) {
  if (stamp(event) >= time_ns_) {
    stops_.add(event);
    if (stamp(event) == time_ns_) stop();
  } else if (const auto* fix = std::get_if<GnssFix>(&event)) {
    ++late_;
    leave_out(*fix, FixVerdict::out_of_order);
  }
}

void Driving::observe(const Observed& observed) {
  if (observed.t_ns <= time_ns_) return notice_late(observed);
  stops_.add(observed);
}

std::optional<HoleMet> Driving::take_increment(const ImuIncrement& increment) {
  if (increment.t_end_ns <= time_ns_) return std::nullopt;  // before the start
  ImuIncrement rest = increment;
  if (rest.t_begin_ns < time_ns_) rest = imu::split(increment, time_ns_).second;
  if (rest.t_begin_ns > time_ns_) return HoleMet{rest};
  if (!advance(rest)) return std::nullopt;
  if (!is_made_up(rest)) recent_.add(rest);
  if (options_.rate == EpochRate::imu) emit_epoch();
  return std::nullopt;
}

/// Propagates over the increment, which begins now, with a stop wherever something is due. False if
/// a doubt has come up on the way.
bool Driving::advance(const ImuIncrement& increment) {
  ImuIncrement rest = increment;
  while (const std::optional<int64_t> stop_ns = stops_.next(time_ns_, rest.t_end_ns)) {
    if (*stop_ns >= rest.t_end_ns) {
      propagate(rest);
      stop();
      return !in_doubt_;
    }
    const auto [until_stop, after_stop] = imu::split(rest, *stop_ns);
    propagate(until_stop);
    stop();
    rest = after_stop;
    if (in_doubt_) {
      in_doubt_->rest = rest;
      return false;
    }
  }
  propagate(rest);
  return true;
}

void Driving::propagate(const ImuIncrement& increment) {
  navigator_->propagate(increment);
  aiding_.propagate(increment, is_made_up(increment));
  if (probe_) probe_->propagate(increment);
  time_ns_ = increment.t_end_ns;
}

/// A fix was used a moment ago.
bool Driving::is_held() const {
  constexpr double kHeld = 1.5;  // [s]
  const std::optional<int64_t> fix_ns = stops_.last_fix_ns();
  return fix_ns && seconds_between(*fix_ns, time_ns_) < kHeld;
}

/// Everything due now: what was measured first, then a hold if still needed, then aids, then one
/// epoch.
void Driving::stop() {
  while (const std::optional<StopEvent> event = stops_.take_due(time_ns_)) {
    if (const auto* fix = std::get_if<GnssFix>(&*event)) meet_fix(*fix);
    if (const auto* observed = std::get_if<Observed>(&*event)) meet(*observed);
    if (in_doubt_) return;
  }
  if (stops_.hold_is_due(time_ns_)) {
    navigator_->hold();
    stops_.held(time_ns_);
  }
  if (aiding_.is_due(time_ns_)) aiding_.stop(time_ns_, is_held(), *navigator_);
  emit_epoch();
}

void Driving::emit_epoch() {
  if (last_epoch_ns_ == time_ns_) return;
  last_epoch_ns_ = time_ns_;
  const state::Epoch epoch = navigator_->epoch();
  if (const std::optional<std::string> part = unsound_part(epoch)) throw_unsound(*part);
  sink_.epoch(epoch);
}

void Driving::throw_unsound(const std::string& part) const {
  const std::optional<int64_t> last_fix_ns = stops_.last_fix_ns();
  throw DataError(fmt::format(
      "the solution's {} is not finite at {} ({}); cut what is damaged or far off there out of the "
      "log, see `foucault check`, and look at the noise of the IMU (imu.*)",
      part, utc_text(time_ns_),
      last_fix_ns ? "the last fix was used at " + utc_text(*last_fix_ns)
                  : std::string("no fix was used since the start")));
}

// Fixes -----------------------------------------------------------------------------------------

/// A fix that is in doubt is met again once the doubt is resolved.
void Driving::meet_fix(const GnssFix& fix) {
  FixResult result = result_of(fix);
  result.p_b_a = fix.p_b_a;
  const GnssFix trusted = options_.gnss.weighted(fix);
  if (!is_position(fix.antenna) || !options_.gnss.has_valid_sigma(fix)) {
    result.verdict = FixVerdict::bad_sigma;
    notice_bad_sigma(fix);
    return sink_.fix(result);
  }
  const state::Innovation innovation = navigator_->innovation(measurement::GnssPosition(trusted));
  result.innovation_n = result.postfit_n = innovation.value;
  result.innovation_covariance = innovation.covariance;
  result.verdict = FixVerdict::low_quality;
  if (fix.quality >= options_.gnss.lowest_quality()) {
    const std::optional<FixDecision> decision =
        gate_.decide(trusted, innovation, stops_.fix_interval());
    if (!decision) {
      in_doubt_ = FixInDoubt{fix, trusted, gate_.is_unheld(trusted), {}};
      return;
    }
    result.verdict = carry_out(*decision, trusted, result);
  }
  sink_.fix(result);
}

FixVerdict Driving::carry_out(const FixDecision& decision, const GnssFix& fix, FixResult& result) {
  switch (decision.action) {
    case FixDecision::Action::leave_out:
      return FixVerdict::gated;
    case FixDecision::Action::use_corrected:
      navigator_->update(measurement::gnss_position(decision.corrected));
      fix_used();
      return FixVerdict::corrected;
    case FixDecision::Action::use:
      break;
  }
  use(fix, result);
  predict_ahead(fix);
  return FixVerdict::used;
}

void Driving::use(const GnssFix& fix, FixResult& result) {
  navigator_->update(measurement::gnss_position(fix));
  fix_used();
  if (fix.velocity_n && options_.aids.uses_gnss_velocity()) use_velocity(fix);
  heading_.use(fix, *navigator_);
  result.postfit_n = navigator_->innovation(measurement::GnssPosition(fix)).value;
}

void Driving::use_velocity(const GnssFix& fix) {
  if (!diagnosis::is_valid_covariance(fix.velocity_covariance)) return;
  const measurement::ObservationPtr velocity = measurement::gnss_velocity(fix);
  const state::Innovation innovation = navigator_->innovation(*velocity);
  const bool believed = velocity_judge_.believes(fix.t_ns, innovation);
  if (believed) navigator_->update(velocity);
  sink_.observation({fix.t_ns, velocity->name(), static_cast<int>(innovation.value.size()),
                     diagnosis::mahalanobis_squared(innovation), believed});
}

void Driving::predict_ahead(const GnssFix& fix) {
  if (!probe_) return;
  const std::optional<state::PredictionResult> prediction = probe_->meet(fix, *navigator_);
  if (prediction) sink_.prediction(*prediction);
}

void Driving::fix_used() {
  stops_.fix_used(time_ns_);
  gate_.used(time_ns_);
}

void Driving::meet(const Observed& observed) {
  if (aiding_.use(observed.t_ns, observed.observation, *navigator_)) stops_.held(time_ns_);
}

void Driving::notice_late(const Observed& observed) {
  if (std::exchange(noticed_late_, true)) return;
  sink_.notice({observed.t_ns, state::NoticeKind::skipped,
                fmt::format("{} at {} came after later measurements; such are left out",
                            observed.observation->name(), utc_text(observed.t_ns))});
}

void Driving::notice_bad_sigma(const GnssFix& fix) {
  if (std::exchange(noticed_bad_sigma_, true)) return;
  sink_.notice({fix.t_ns, state::NoticeKind::fix_rejected,
                fmt::format("fix at {} has no usable sigma or position; such fixes are left out",
                            utc_text(fix.t_ns))});
}

void Driving::leave_out(const GnssFix& fix, FixVerdict verdict) {
  FixResult result = result_of(fix);
  result.verdict = verdict;
  sink_.fix(result);
}

}  // namespace foucault::navigation
