#include "foucault/navigation/navigation_run.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/position.h"
#include "foucault/core/profile.h"
#include "foucault/core/time.h"
#include "foucault/core/time_mismatch.h"
#include "foucault/diagnosis/fix_doubt.h"
#include "foucault/diagnosis/fix_guard.h"
#include "foucault/diagnosis/fix_judge.h"
#include "foucault/diagnosis/fix_screen.h"
#include "foucault/diagnosis/imu_guard.h"
#include "foucault/diagnosis/plausibility.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/imu/increments.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/measurement/gnss_velocity.h"
#include "imu_hole.h"
#include "known_biases.h"
#include "prediction_probe.h"
#include "sound_epoch.h"

namespace foucault::navigation {

namespace {

constexpr double kRecentRatesMemory = 0.3;     // [s]: beyond vibration, well within a manoeuvre
constexpr double kHoleThatMayHideATurn = 0.5;  // [s]
constexpr double kLongestWait = 3;             // [s], for fixes after a hole
constexpr double kNoticeableGap = 0.2;         // [s]: a few lost samples are not worth a line
/// Fixes further from the IMU in time are of another recording, or of another clock.
constexpr int64_t kElsewhenNs = 3600 * kNanosecondsPerSecond;

std::string text(int64_t t_ns) { return fmt::format("{:.3f} s", to_seconds(t_ns)); }

bool covariance_is_valid(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite() || covariance.diagonal().minCoeff() <= 0) return false;
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance);
  return llt.info() == Eigen::Success;
}

/// A minus B [m], in the NED of B.
Eigen::Vector3d difference_n(const Geodetic& a, const Geodetic& b) {
  return LocalFrame(b).to_local(a);
}

Geodetic antenna_of(const Epoch& epoch, const Eigen::Vector3d& p_b_a) {
  return LocalFrame(epoch.position).to_geodetic(epoch.q_n_b * p_b_a);
}

}  // namespace

NavigationRun::~NavigationRun() = default;

NavigationRun::NavigationRun(std::unique_ptr<Navigator> navigator, Aligner aligner,
                             const NavigationRunOptions& options, Sink& sink)
    : navigator_(std::move(navigator)),
      aligner_(std::move(aligner)),
      options_(options),
      sink_(sink),
      guard_(std::make_unique<ImuGuard>()),
      fix_guard_(std::make_unique<FixGuard>()),
      plausibility_(std::make_unique<Plausibility>()),
      screen_(std::make_unique<FixScreen>()),
      judge_(std::make_unique<FixJudge>(options.gnss)),
      velocity_judge_(std::make_unique<FixJudge>(options.gnss)),
      recent_{kRecentRatesMemory} {
  if (sink.wants_predictions()) probe_ = std::make_unique<PredictionProbe>();
}

void NavigationRun::process(const Measurement& measurement) {
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) {
    process_increment(*increment);
  } else if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
    process_fix(*fix);
  } else {
    pass_on(measurement);
  }
}

void NavigationRun::pass_on(const Measurement& measurement) {
  if (aligned_) {
    take(measurement);
  } else {
    align(measurement);
  }
}

void NavigationRun::process_increment(const ImuIncrement& increment) {
  const ImuGuard::Verdict verdict = guard_->look_at(increment);
  if (!verdict.notice.empty()) {
    sink_.notice({increment.t_end_ns, NoticeKind::skipped, verdict.notice});
  }
  if (!verdict.increment) return;
  ++counts_.increments;
  usual_interval_.add(verdict.increment->dt());
  ImuIncrement usable = *verdict.increment;
  if (verdict.accel_repeats) {
    constexpr double kRepeatLasts = 3;  // [s] that the error stays the same
    usable.extra_accel_noise_density = options_.gaps.accel_sigma_m_s2 * std::sqrt(kRepeatLasts);
    doubt_state(usable.t_end_ns);
  }
  plausibility_->add(usable);
  pass_on(usable);
}

void NavigationRun::process_fix(const GnssFix& fix) {
  GnssFix usable = fix;
  options_.aids.apply_to(usable);
  const FixClass fix_class = classify(usable);
  counts_.add(fix_class, fix.t_ns);
  switch (fix_class) {
    case FixClass::elsewhen:
      if (!counts_.first_elsewhen_s) {
        counts_.first_elsewhen_s = seconds_between(*guard_->last_end_ns(), fix.t_ns);
      }
      return;
    case FixClass::repeated:
    case FixClass::held:
      return leave_out(fix, FixVerdict::out_of_order);
    case FixClass::bad_position:
      return leave_out(fix, FixVerdict::bad_sigma);
    case FixClass::usable:
      plausibility_->add(usable);
      break;
    case FixClass::bad_sigma:
    case FixClass::low_quality:
      break;
  }
  pass_on(usable);
}

/// What is not to be used of a fix that is good otherwise is taken off it.
NavigationRun::FixClass NavigationRun::classify(GnssFix& fix) {
  const std::optional<int64_t> imu_ns = guard_->last_end_ns();
  if (imu_ns && std::abs(fix.t_ns - *imu_ns) > kElsewhenNs) return FixClass::elsewhen;
  if (is_repeated(fix)) return FixClass::repeated;
  last_fix_seen_ = fix;
  const FixGuard::Verdict verdict = fix_guard_->look_at(fix);
  if (verdict.held) return FixClass::held;
  if (!verdict.fix) return FixClass::bad_position;
  fix = *verdict.fix;
  if (!covariance_is_valid(options_.gnss.weighted(fix).position_covariance)) {
    return FixClass::bad_sigma;
  }
  if (fix.quality < options_.gnss.lowest_quality()) return FixClass::low_quality;
  return FixClass::usable;
}

void NavigationRun::Counts::add(FixClass fix_class, int64_t t_ns) {
  Class& of_this = fixes[fix_class];
  if (of_this.count++ == 0) of_this.first_ns = t_ns;
}

int64_t NavigationRun::Counts::of(FixClass fix_class) const {
  const auto found = fixes.find(fix_class);
  return found == fixes.end() ? 0 : found->second.count;
}

int64_t NavigationRun::Counts::all_fixes() const {
  int64_t sum = 0;
  for (const auto& [fix_class, of_this] : fixes) sum += of_this.count;
  return sum;
}

bool NavigationRun::is_repeated(const GnssFix& fix) const {
  if (!last_fix_seen_ || last_fix_seen_->t_ns != fix.t_ns) return false;
  const Geodetic &a = fix.antenna, &b = last_fix_seen_->antenna;
  return a.latitude == b.latitude && a.longitude == b.longitude && a.height == b.height;
}

void NavigationRun::leave_out(const GnssFix& fix, FixVerdict verdict) {
  if (!aligned_) return;
  FixResult result;
  result.t_ns = fix.t_ns;
  result.verdict = verdict;
  result.quality = fix.quality;
  result.antenna = fix.antenna;
  sink_.fix(result);
}

// Alignment -------------------------------------------------------------------------------------

bool NavigationRun::is_usable(const GnssFix& fix) const {
  return is_position(fix.antenna) &&
         covariance_is_valid(options_.gnss.weighted(fix).position_covariance) &&
         fix.quality >= options_.gnss.lowest_quality();
}

/// Fixes that cannot align, or need not be looked at, pass the screen unseen.
void NavigationRun::align(const Measurement& measurement) {
  if (options_.gnss.gate_false_alarm == 0) {
    align_screened(measurement, true);
    return;
  }
  screen_->add(measurement);
  while (!aligned_) {
    const std::optional<FixScreen::Screened> screened = screen_->next();
    if (!screened) return;
    align_screened(screened->measurement, screened->plausible);
  }
}

void NavigationRun::align_screened(const Measurement& measurement, bool plausible) {
  held_.push_back(measurement);
  show_aligner(measurement, plausible);
  if (aligner_.initial()) {
    for (const Measurement& waiting : screen_->take_all()) held_.push_back(waiting);
    start(*aligner_.initial());
  } else {
    drop_what_no_start_needs();
  }
}

void NavigationRun::show_aligner(const Measurement& measurement, bool plausible) {
  const StageTimer timer(Stage::align);
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) aligner_.add(*increment);
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
    if (plausible && is_usable(*fix)) aligner_.add(options_.gnss.weighted(*fix));
  }
}

void NavigationRun::drop_what_no_start_needs() {
  const int64_t earliest_ns = aligner_.earliest_start_ns();
  while (!held_.empty() && stamp(held_.front()) < earliest_ns) held_.pop_front();
}

void NavigationRun::start(const Epoch& aligned) {
  const Epoch initial = before_hole_ ? with_known_biases(aligned, *before_hole_) : aligned;
  const NoticeKind kind = started_before_ ? NoticeKind::realigned : NoticeKind::aligned;
  sink_.notice({initial.t_ns, kind, aligner_.summary()});
  aligned_ = true;
  started_before_ = true;
  time_ns_ = initial.t_ns;
  last_node_ns_ = initial.t_ns;
  judge_->start(initial.t_ns);
  velocity_judge_->start(initial.t_ns);
  last_used_ns_ = initial.t_ns;
  if (probe_) probe_->restart();
  navigator_->start(initial);
  emit_epoch();

  std::deque<Measurement> replay;
  replay.swap(held_);
  for (const Measurement& measurement : replay) {
    if (stamp(measurement) > initial.t_ns) take(measurement);
  }
}

void NavigationRun::realign(const ImuIncrement& next) {
  sink_.notice({next.t_begin_ns, NoticeKind::imu_gap,
                fmt::format("no IMU data for {:.1f} s from {}; aligning anew, biases are kept",
                            seconds_between(time_ns_, next.t_begin_ns), text(time_ns_))});
  aligned_ = false;
  before_hole_ = navigator_->epoch();
  std::multimap<int64_t, Event> pending;
  pending.swap(pending_);
  recent_ = RecentRates{kRecentRatesMemory};
  last_fix_ns_.reset();
  fix_interval_ns_ = 0;
  aligner_.restart();
  screen_->restart();
  for (const auto& [t_ns, event] : pending) {
    const Measurement measurement = std::visit([](const auto& e) { return Measurement(e); }, event);
    if (stamp(measurement) >= next.t_begin_ns) take(measurement);
  }
  take(next);
}

// The aligned run -------------------------------------------------------------------------------

void NavigationRun::take(const Measurement& measurement) {
  if (!aligned_) {  // a hole found while replaying has ended the alignment
    align(measurement);
  } else if (doubt_) {
    look_beyond_doubt(measurement);
  } else if (hole_) {
    look_beyond_hole(measurement);
  } else if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) {
    take_increment(*increment);
  } else if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
    take_event(*fix);
  } else if (const auto* request = std::get_if<EpochRequest>(&measurement)) {
    take_event(*request);
  }
}

void NavigationRun::take_event(const Event& event) {
  const auto stamp_of = [](const Event& e) {
    return std::visit([](const auto& m) { return m.t_ns; }, e);
  };
  if (stamp_of(event) >= time_ns_) {
    pending_.emplace(stamp_of(event), event);
    if (stamp_of(event) == time_ns_) handle_stop();
  } else if (const auto* fix = std::get_if<GnssFix>(&event)) {
    ++counts_.late;
    leave_out(*fix, FixVerdict::out_of_order);
  }
}

void NavigationRun::take_increment(const ImuIncrement& increment) {
  if (increment.t_end_ns <= time_ns_) return;  // before the start
  ImuIncrement rest = increment;
  if (rest.t_begin_ns < time_ns_) rest = split(increment, time_ns_).second;
  if (rest.t_begin_ns > time_ns_) {
    meet_hole(rest);
    return;
  }
  if (!advance(rest)) return;
  recent_.add(rest);
  if (options_.rate == EpochRate::imu) emit_epoch();
}

/// Short holes are bridged at once, long ones end the alignment. In between what follows is held
/// back until the course after the hole tells how the vehicle has turned in it.
void NavigationRun::meet_hole(const ImuIncrement& next) {
  const double gap = seconds_between(time_ns_, next.t_begin_ns);
  if (gap > options_.gaps.max_gap_s) {
    realign(next);
    return;
  }
  if (recent_.seen_s == 0) recent_.add(next);
  hole_ = std::make_unique<ImuHole>();
  hole_->before.t_ns = time_ns_;
  hole_->gyro_before_b = recent_.gyro_b;
  hole_->accel_before_b = recent_.accel_b;
  hole_->interval = usual_interval_.length;
  hole_->after = next;
  recent_ = RecentRates{kRecentRatesMemory};
  beyond_hole_.push_back(next);
  if (gap < kHoleThatMayHideATurn) {
    leave_hole();
  } else {
    hole_->before = navigator_->epoch();
  }
}

void NavigationRun::look_beyond_hole(const Measurement& measurement) {
  const auto* increment = std::get_if<ImuIncrement>(&measurement);
  const bool next_hole = increment && increment->t_begin_ns > beyond_hole_end_ns();
  beyond_hole_.push_back(measurement);
  const double waited = seconds_between(hole_->after.t_begin_ns, stamp(measurement));
  if (std::holds_alternative<GnssFix>(measurement)) hole_->turn = turn_over(*hole_, beyond_hole_);
  if (hole_->turn || next_hole || waited > kLongestWait) leave_hole();
}

int64_t NavigationRun::beyond_hole_end_ns() const {
  for (auto m = beyond_hole_.rbegin(); m != beyond_hole_.rend(); ++m) {
    if (const auto* increment = std::get_if<ImuIncrement>(&*m)) return increment->t_end_ns;
  }
  return hole_->after.t_end_ns;
}

/// Propagates over the hole, then over what was held back.
void NavigationRun::leave_hole() {
  const std::unique_ptr<ImuHole> hole = std::move(hole_);
  std::deque<Measurement> beyond;
  beyond.swap(beyond_hole_);
  const bool noticeable = hole->length() >= kNoticeableGap;
  if (noticeable) doubt_state(hole->after.t_begin_ns);
  // Fixes in the hole came before its end was known; those after it wait their turn.
  const int64_t step_ns = hole->step_ns();
  std::vector<ImuIncrement> made_up;
  for (int64_t begin_ns = time_ns_; begin_ns < hole->after.t_begin_ns;) {
    const int64_t end_ns = std::min(begin_ns + step_ns, hole->after.t_begin_ns);
    made_up.push_back(made_up_increment(*hole, options_.gaps, begin_ns, end_ns));
    begin_ns = end_ns;
  }
  for (const ImuIncrement& increment : made_up) take(increment);
  recent_ = RecentRates{kRecentRatesMemory};
  if (noticeable) {
    sink_.notice({time_ns_, NoticeKind::imu_gap,
                  fmt::format("no IMU data for {:.3f} s up to {}; bridged{}", hole->length(),
                              text(hole->after.t_begin_ns),
                              hole->turn ? ", with the turn that GNSS shows" : "")});
  }
  for (const Measurement& measurement : beyond) take(measurement);
}

void NavigationRun::UsualInterval::add(double dt) {
  memory = std::min(memory + dt, kRecentRatesMemory);
  length += std::min(1.0, dt / memory) * (dt - length);
}

/// Propagates over the increment, which begins now, with a stop wherever something is due. False if
/// a doubt has come up; what is left of the increment is held back then.
bool NavigationRun::advance(const ImuIncrement& increment) {
  ImuIncrement rest = increment;
  while (const std::optional<int64_t> stop_ns = next_stop(rest.t_end_ns)) {
    if (*stop_ns >= rest.t_end_ns) {
      propagate(rest);
      handle_stop();
      return !doubt_;
    }
    const auto [until_stop, after_stop] = split(rest, *stop_ns);
    propagate(until_stop);
    handle_stop();
    rest = after_stop;
    if (doubt_) {
      look_beyond_doubt(rest);
      return false;
    }
  }
  propagate(rest);
  return true;
}

void NavigationRun::propagate(const ImuIncrement& increment) {
  navigator_->propagate(increment);
  if (probe_) probe_->propagate(increment);
  time_ns_ = increment.t_end_ns;
}

/// The next stamp up to end_ns at which to stop, later than now.
std::optional<int64_t> NavigationRun::next_stop(int64_t end_ns) const {
  int64_t stop_ns = std::max(hold_due_ns(), time_ns_ + 1);
  if (!pending_.empty()) stop_ns = std::min(stop_ns, pending_.begin()->first);
  if (stop_ns > end_ns) return std::nullopt;
  return stop_ns;
}

/// A fix expected about when the hold is due is waited for: stamps that jitter must not make pairs
/// of nodes a millisecond apart.
int64_t NavigationRun::hold_due_ns() const {
  const int64_t interval_ns = nanoseconds(options_.node_interval_s);
  const int64_t due_ns = last_node_ns_ + interval_ns;
  if (!last_fix_ns_ || fix_interval_ns_ == 0) return due_ns;
  const int64_t grace_ns = interval_ns / 20;
  const int64_t off_ns = std::abs(*last_fix_ns_ + fix_interval_ns_ - due_ns);
  const bool jitter = off_ns > 1000 && off_ns < grace_ns;
  return jitter ? due_ns + grace_ns : due_ns;
}

/// Everything due now: fixes first, then a hold if still needed, then one epoch.
void NavigationRun::handle_stop() {
  while (!pending_.empty() && pending_.begin()->first <= time_ns_) {
    const Event event = pending_.begin()->second;
    pending_.erase(pending_.begin());
    if (const auto* fix = std::get_if<GnssFix>(&event)) handle_fix(*fix);
    if (doubt_) return;
  }
  if (time_ns_ >= hold_due_ns()) hold();
  emit_epoch();
}

void NavigationRun::hold() {
  navigator_->hold();
  last_node_ns_ = time_ns_;
}

void NavigationRun::emit_epoch() {
  if (last_epoch_ns_ == time_ns_) return;
  last_epoch_ns_ = time_ns_;
  const Epoch epoch = navigator_->epoch();
  if (const std::optional<std::string> part = unsound_part(epoch)) throw_unsound(*part);
  sink_.epoch(epoch);
}

void NavigationRun::throw_unsound(const std::string& part) const {
  throw DataError(fmt::format(
      "the solution's {} is not finite at {} ({}); cut what is damaged or far off there out of the "
      "log, see `foucault check`, and look at the noise of the IMU (imu.*)",
      part, text(time_ns_),
      last_fix_ns_ ? "the last fix was used at " + text(*last_fix_ns_)
                   : std::string("no fix was used since the start")));
}

// Fixes -----------------------------------------------------------------------------------------

/// A fix that is in doubt is handled once the doubt is resolved.
void NavigationRun::handle_fix(const GnssFix& fix) {
  FixResult result;
  result.t_ns = fix.t_ns;
  result.quality = fix.quality;
  result.antenna = fix.antenna;
  result.p_b_a = fix.p_b_a;
  const GnssFix trusted = options_.gnss.weighted(fix);
  if (!is_position(fix.antenna) || !covariance_is_valid(trusted.position_covariance)) {
    result.verdict = FixVerdict::bad_sigma;
  } else {
    const Innovation innovation = navigator_->innovation(GnssPosition(trusted));
    result.innovation_n = result.postfit_n = innovation.value;
    result.innovation_covariance = innovation.covariance;
    if (!is_usable(fix)) {
      result.verdict = FixVerdict::low_quality;
    } else {
      const std::optional<FixDecision> decision = decide(trusted, innovation);
      if (!decision) return doubt(fix, trusted);
      result.verdict = carry_out(*decision, trusted, result);
    }
  }
  if (result.verdict != FixVerdict::used) notice_first_rejection(fix, result.verdict);
  sink_.fix(result);
}

/// None: it is in doubt.
std::optional<FixDecision> NavigationRun::decide(const GnssFix& fix, const Innovation& innovation) {
  if (std::optional<FixDecision> decision = decided_before(fix)) return decision;
  const bool believed = judge_->believes(fix.t_ns, innovation);
  if (!believed || returns_after_outage(fix)) return std::nullopt;
  return FixDecision{FixDecision::Action::use, fix, {}};
}

/// So long without fixes is more than one or two that were left out, and long enough for a drift.
bool NavigationRun::is_unheld(const GnssFix& fix) const {
  constexpr double kUnheld = 2.5;  // [s]
  return seconds_between(last_used_ns_, fix.t_ns) > kUnheld && !judge_->gate_is_open(fix.t_ns);
}

/// Unheld for longer than usual in this recording.
bool NavigationRun::returns_after_outage(const GnssFix& fix) const {
  constexpr double kOutageIntervals = 3.5;  // of fixes
  const double interval = 1e-9 * static_cast<double>(fix_interval_ns_);
  return is_unheld(fix) && seconds_between(last_used_ns_, fix.t_ns) > kOutageIntervals * interval;
}

void NavigationRun::doubt(const GnssFix& fix, const GnssFix& trusted) {
  doubted_fix_ = fix;
  doubt_ = std::make_unique<FixDoubt>(options_.gnss, *judge_, *navigator_, trusted, is_unheld(fix));
  for (const auto& [t_ns, event] : pending_) {  // they are in order, and wait where they are
    if (const auto* next = std::get_if<GnssFix>(&event)) show_doubt(*next);
  }
}

/// True once the doubt is decided.
bool NavigationRun::show_doubt(const Measurement& measurement) {
  const auto* fix = std::get_if<GnssFix>(&measurement);
  if (!fix) return doubt_->add(measurement);
  return is_usable(*fix) && doubt_->add(options_.gnss.weighted(*fix));
}

std::optional<FixDecision> NavigationRun::decided_before(const GnssFix& fix) {
  const auto found = decided_.find(fix.t_ns);
  if (found == decided_.end()) return std::nullopt;
  const FixDecision decision = found->second;
  decided_.erase(found);
  return decision;
}

void NavigationRun::doubt_state(int64_t t_ns) {
  judge_->doubt_state(t_ns);
  velocity_judge_->doubt_state(t_ns);
}

/// Holds back what follows a fix in doubt until it is known what it was.
void NavigationRun::look_beyond_doubt(const Measurement& measurement) {
  beyond_doubt_.push_back(measurement);
  if (show_doubt(measurement)) resolve_doubt();
}

/// Goes through what was held back, with what is known of it now.
void NavigationRun::resolve_doubt() {
  const DoubtOutcome outcome = doubt_->outcome();
  doubt_.reset();
  std::deque<Measurement> beyond;
  beyond.swap(beyond_doubt_);
  for (const std::string& line : outcome.notices) {
    sink_.notice({time_ns_, NoticeKind::fix_rejected, line});
  }
  decided_.clear();
  for (const FixDecision& decision : outcome.fixes) decided_.emplace(decision.fix.t_ns, decision);
  for (const double square : outcome.level) judge_->remember(square);
  if (outcome.loosened) navigator_->loosen(*outcome.loosened);
  if (outcome.state_was_wrong) doubt_state(outcome.fixes.back().fix.t_ns);
  handle_fix(*doubted_fix_);
  handle_stop();
  for (const Measurement& measurement : beyond) take(measurement);
}

FixVerdict NavigationRun::carry_out(const FixDecision& decision, const GnssFix& fix,
                                    FixResult& result) {
  switch (decision.action) {
    case FixDecision::Action::leave_out:
      return FixVerdict::gated;
    case FixDecision::Action::use_corrected:
      navigator_->update(gnss_position(decision.corrected));
      remember_fix_time();
      return FixVerdict::corrected;
    case FixDecision::Action::use:
      break;
  }
  use(fix, result);
  predict_ahead(fix);
  return FixVerdict::used;
}

void NavigationRun::use(const GnssFix& fix, FixResult& result) {
  navigator_->update(gnss_position(fix));
  remember_fix_time();
  if (fix.velocity_n && options_.aids.uses_gnss_velocity()) use_velocity(fix);
  const Epoch epoch = navigator_->epoch();
  result.postfit_n = difference_n(fix.antenna, antenna_of(epoch, fix.p_b_a));
}

void NavigationRun::use_velocity(const GnssFix& fix) {
  if (!covariance_is_valid(fix.velocity_covariance)) return;
  const ObservationPtr velocity = gnss_velocity(fix);
  const Innovation innovation = navigator_->innovation(*velocity);
  const bool believed = velocity_judge_->believes(fix.t_ns, innovation);
  if (believed) navigator_->update(velocity);
  sink_.observation({fix.t_ns, velocity->name(), static_cast<int>(innovation.value.size()),
                     mahalanobis_squared(innovation), believed});
}

void NavigationRun::predict_ahead(const GnssFix& fix) {
  if (!probe_) return;
  const std::optional<PredictionResult> prediction = probe_->meet(fix, *navigator_);
  if (prediction) sink_.prediction(*prediction);
}

void NavigationRun::remember_fix_time() {
  if (last_fix_ns_) fix_interval_ns_ = time_ns_ - *last_fix_ns_;
  last_fix_ns_ = last_used_ns_ = time_ns_;
  last_node_ns_ = time_ns_;
}

void NavigationRun::notice_first_rejection(const GnssFix& fix, FixVerdict verdict) {
  if (verdict != FixVerdict::bad_sigma || noticed_bad_) return;
  noticed_bad_ = true;
  sink_.notice({fix.t_ns, NoticeKind::fix_rejected,
                fmt::format("fix at {} has no usable sigma or position; such fixes are left out",
                            text(fix.t_ns))});
}

// The end ---------------------------------------------------------------------------------------

void NavigationRun::finish() {
  while (!aligned_) {
    const std::optional<FixScreen::Screened> screened = screen_->next(true);
    if (!screened) break;
    align_screened(screened->measurement, screened->plausible);
  }
  while (hole_ || doubt_) doubt_ ? resolve_doubt() : leave_hole();
  throw_if_nothing_usable();
  if (!started_before_) throw DataError(aligner_.why_not());
  notice_left_out();
}

void NavigationRun::notice_left_out() {
  std::vector<std::string> lines = guard_->summary();
  for (const std::string& line : fix_guard_->summary()) lines.push_back(line);
  if (const int64_t repeated = counts_.of(FixClass::repeated); repeated > 0) {
    lines.push_back(fmt::format("{} fixes repeat the one before them and were left out", repeated));
  }
  if (counts_.late > 0) {
    lines.push_back(fmt::format(
        "{} fixes came after later ones and were left out; sort the log by time", counts_.late));
  }
  if (const int64_t elsewhen = counts_.of(FixClass::elsewhen); elsewhen > 0) {
    lines.push_back(fmt::format("{} fixes were left out, the first stamped {}", elsewhen,
                                describe_mismatch(*counts_.first_elsewhen_s)));
  }
  for (const std::string& line : lines) sink_.notice({time_ns_, NoticeKind::skipped, line});
}

void NavigationRun::throw_if_nothing_usable() const {
  if (2 * guard_->left_out() > guard_->seen()) {
    std::string why;
    for (const std::string& line : guard_->summary()) why += (why.empty() ? "" : "; ") + line;
    throw DataError(fmt::format("{}; sort the IMU data by time and remove what is damaged", why));
  }
  if (counts_.increments == 0) {
    throw DataError(
        "no IMU data in the log; import a recording with angular rates and specific force");
  }
  const int64_t fixes = counts_.all_fixes();
  if (fixes == 0) {
    throw DataError("no GNSS fix in the log; import a recording with positions");
  }
  if (counts_.of(FixClass::usable) > 0) return;
  if (2 * counts_.of(FixClass::elsewhen) > fixes) {
    throw DataError(fmt::format("GNSS and IMU do not overlap in time: the fixes are stamped {}",
                                describe_mismatch(*counts_.first_elsewhen_s)));
  }
  throw DataError(
      fmt::format("none of the {} GNSS fixes can be used: {}; give sigmas in the "
                  "import, or gnss.sigma_floor_m where they are zero",
                  fixes, unusable_fixes()));
}

/// How many of each kind, with the first: "4 with a sigma that ..., the first at ...".
std::string NavigationRun::unusable_fixes() const {
  const std::pair<FixClass, std::string> kinds[] = {
      {FixClass::bad_sigma, "with a sigma that is zero, negative or not finite"},
      {FixClass::bad_position, "with no position (zero, not finite, out of range or reach)"},
      {FixClass::low_quality, "below gnss.min_quality=" + options_.gnss.min_quality},
      {FixClass::repeated, "that repeat the one before them"},
      {FixClass::held, "that repeat the position before them under a new stamp"},
      {FixClass::elsewhen, "stamped far from the IMU"}};
  std::string list;
  for (const auto& [fix_class, what] : kinds) {
    const auto found = counts_.fixes.find(fix_class);
    if (found == counts_.fixes.end()) continue;
    list += fmt::format("{}{} {}, the first at {}", list.empty() ? "" : "; ", found->second.count,
                        what, text(found->second.first_ns));
  }
  return list;
}

}  // namespace foucault::navigation
