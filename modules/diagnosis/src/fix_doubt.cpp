#include "foucault/diagnosis/fix_doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/imu/increments.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/state/blocks.h"

namespace foucault::diagnosis {
namespace {

using Action = FixDecision::Action;
using Eigen::Vector3d;

constexpr double kJumpStays = 30;        // [s]
constexpr double kLongestDoubt = 90;     // [s]
constexpr double kNoMoreFixes = 30;      // [s]
constexpr double kNoticeableHole = 0.2;  // [s], in the IMU
constexpr double kLookAfter = 5;         // [s]
constexpr std::size_t kLookNeeds = 6;    // fixes
constexpr double kWindow = 10;           // [s] that a look goes back
constexpr double kThinning = 0.25;       // [s] between fixes in it
constexpr double kSigmasTooSmall = 30;   // factor that sigmas may be too small by
constexpr int kMissesThatEndLine = 3;
/// For so long [s] the errors of a line stay the same, and do not average out.
constexpr double kLineMemory = 10;
constexpr double kGravity = 9.8;

Vector3d velocity_variance(const state::Epoch& epoch) {
  return state::part(epoch.covariance.diagonal(), state::block::velocity);
}

/// What the state does not know of its acceleration: tilt and accelerometer bias [m/s^2].
double acceleration_sigma(const state::Epoch& epoch) {
  return std::hypot(kGravity * epoch.sigma_of(state::block::attitude).maxCoeff(),
                    epoch.sigma_of(state::block::accel_bias).maxCoeff());
}

/// At the same rates.
ImuIncrement stretched_back(const ImuIncrement& increment, int64_t begin_ns) {
  ImuIncrement out = increment;
  out.t_begin_ns = begin_ns;
  const double factor = out.dt() / increment.dt();
  out.dtheta_b *= factor;
  out.dvel_b *= factor;
  return out;
}

std::string when(int64_t t_ns) { return fmt::format("{:.3f} s", to_seconds(t_ns)); }

}  // namespace

Vector3d InnovationLine::at(int64_t at_ns) const {
  return offset_n + seconds_between(t_ns, at_ns) * rate_n;
}

Vector3d InnovationLine::variance_at(int64_t at_ns) const {
  const double dt = seconds_between(t_ns, at_ns);
  return offset_variance_n + dt * dt * rate_variance_n;
}

FixDoubt::FixDoubt(const GnssOptions& options, const FixJudge& judge,
                   const measurement::Navigator& navigator, const GnssFix& fix, bool returns)
    : options_(options),
      judge_(judge),
      start_(navigator.ahead(1)),
      ahead_(navigator.ahead(1)),
      begin_(navigator.epoch()),
      held_(begin_),
      time_ns_(fix.t_ns),
      last_fix_ns_(fix.t_ns),
      from_ns_(fix.t_ns) {
  const state::Innovation innovation = navigator.innovation(measurement::GnssPosition(fix));
  begin_innovation_n_ = innovation.value;
  begin_variance_n_ = innovation.covariance.diagonal();
  if (returns) trial_.emplace(navigator, fix, judge.level());
  meet(fix);
}

// Driving ahead ---------------------------------------------------------------------------------

bool FixDoubt::add(const Measurement& measurement) {
  if (decided_) return true;
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) add_increment(*increment);
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
    if (fix->t_ns > time_ns_) waiting_.emplace(fix->t_ns, *fix);
    if (fix->t_ns == time_ns_) meet(*fix);
  }
  return decided_;
}

void FixDoubt::add_increment(const ImuIncrement& increment) {
  if (increment.t_end_ns <= time_ns_) return;
  ImuIncrement rest = increment;
  if (rest.t_begin_ns < time_ns_) rest = imu::split(rest, time_ns_).second;
  if (seconds_between(time_ns_, rest.t_begin_ns) > kNoticeableHole) return settle_at_end();
  if (rest.t_begin_ns > time_ns_) rest = stretched_back(rest, time_ns_);
  while (!decided_ && !waiting_.empty() && waiting_.begin()->first <= rest.t_end_ns) {
    const GnssFix fix = waiting_.begin()->second;
    waiting_.erase(waiting_.begin());
    if (fix.t_ns > time_ns_ && fix.t_ns < rest.t_end_ns) {
      const auto [before, after] = imu::split(rest, fix.t_ns);
      propagate(before);
      rest = after;
    } else if (fix.t_ns > time_ns_) {
      propagate(rest);
    }
    meet(fix);
  }
  if (decided_) return;
  if (rest.t_end_ns > time_ns_) propagate(rest);
  if (seconds_between(last_fix_ns_, time_ns_) > kNoMoreFixes) settle_at_end();
}

void FixDoubt::propagate(const ImuIncrement& increment) {
  ahead_->propagate(increment);
  driven_.push_back(increment);
  if (trial_) trial_->propagate(increment);
  time_ns_ = increment.t_end_ns;
}

void FixDoubt::meet(const GnssFix& fix) {
  const state::Innovation innovation = ahead_->innovation(measurement::GnssPosition(fix));
  const double square = mahalanobis_squared(innovation.value, innovation.covariance);
  const double since_last = seconds_between(last_fix_ns_, fix.t_ns);
  last_fix_ns_ = fix.t_ns;
  if (seconds_between(begin_.t_ns, fix.t_ns) > kLongestDoubt) {
    leave_out(fix);
    return line_ && !line_drifts_ ? move_state() : blame_state();
  }
  if (line_ && !trial_) return follow_line(fix, innovation, since_last);
  if (!trial_ && judge_.passes(square)) {
    outcome_.fixes.push_back({Action::use, fix, {}});
    decided_ = true;
    return;
  }
  leave_out(fix);
  const Rejected rejected{fix.t_ns, innovation.value, innovation.covariance,
                          fix.position_covariance.diagonal(), square};
  if (trial_) return meet_returning(rejected);
  if (recent_.empty() || seconds_between(recent_.back().t_ns, fix.t_ns) >= kThinning) {
    recent_.push_back(rejected);
  }
  while (recent_.size() > look_needs() &&
         seconds_between(recent_.front().t_ns, fix.t_ns) > kWindow) {
    recent_.pop_front();
  }
  look_at();
}

void FixDoubt::meet_returning(const Rejected& rejected) {
  if (line_) return follow_offset(rejected);
  recent_.push_back(rejected);
  const auto since_tried = [&] {
    return seconds_between(outcome_.fixes[tried_.back()].fix.t_ns, rejected.t_ns);
  };
  if (!tried_.empty() && since_tried() < kThinning) return;
  tried_.push_back(outcome_.fixes.size() - 1);
  trial_->add(outcome_.fixes.back().fix);
  if (trial_->is_over()) judge_return();
}

DoubtOutcome FixDoubt::outcome() {
  if (!decided_) settle_at_end();
  return outcome_;
}

// After an outage -------------------------------------------------------------------------------

void FixDoubt::judge_return() {
  const ReturnTrial::Verdict verdict = trial_->verdict();
  offset_is_certain_ = verdict.certainly;
  if (verdict.offset) return begin_offset();
  for (FixDecision& decision : outcome_.fixes) decision.action = Action::use;
  for (std::size_t i = 0; i < tried_.size(); ++i) {
    if (!verdict.used[i]) outcome_.fixes[tried_[i]].action = Action::leave_out;
  }
  outcome_.state_was_wrong = verdict.scale > 1;
  decided_ = true;
}

/// The fixes are off in position alone. The IMU knows how they go on.
void FixDoubt::begin_offset() {
  outcome_.notices.push_back(
      fmt::format("fixes since {}, the first after an outage, are off by {:.2f} m, but not their "
                  "motion; left out unless it stays",
                  when(begin_.t_ns), begin_innovation_n_.norm()));
  line_ = InnovationLine();
  line_->t_ns = begin_.t_ns;
  line_->offset_n = begin_innovation_n_;
  for (const Rejected& r : std::deque<Rejected>(recent_)) {
    if (!decided_) follow_offset(r);
  }
}

/// An offset goes on as the state's velocity lets it; where it does not, the fixes have jumped, and
/// those before or those after are in error: which of them, the prediction tells that no fix of the
/// doubt has touched.
void FixDoubt::follow_offset(const Rejected& fix) {
  const double dt = seconds_between(line_->t_ns, fix.t_ns);
  const Vector3d variance_n =
      2 * judge_.level() * fix.variance_n + dt * dt * velocity_variance(ahead_->epoch());
  const Vector3d change_n = fix.innovation_n - line_->offset_n;
  if (judge_.passes(mahalanobis_squared(change_n, variance_n.asDiagonal()))) {
    line_->t_ns = fix.t_ns;
    line_->offset_n = fix.innovation_n;
    line_missed_ = 0;
    return;
  }
  if (line_missed_++ == 0) first_missed_ns_ = fix.t_ns;
  if (line_missed_ < kMissesThatEndLine) return;
  const bool after_is_nearer =
      fix.square < mahalanobis_squared(line_->offset_n, fix.innovation_covariance);
  end_offset(after_is_nearer, fix.t_ns);
}

void FixDoubt::end_offset(bool later_are_true, int64_t now_ns) {
  outcome_.notices.push_back(
      fmt::format("fixes have jumped shortly before {}; those {} are believed", when(now_ns),
                  later_are_true ? "after it" : "before it"));
  for (FixDecision& decision : outcome_.fixes) {
    const bool is_true = (decision.fix.t_ns >= first_missed_ns_) == later_are_true;
    decision.action = is_true ? Action::use : Action::leave_out;
  }
  outcome_.state_was_wrong = !later_are_true;
  decided_ = true;
}

// While the state is held -----------------------------------------------------------------------

std::size_t FixDoubt::look_needs() const {
  return std::max(kLookNeeds, static_cast<std::size_t>(options_.reinstate_after) + 1);
}

/// What the fixes of the doubt are, once there are enough.
void FixDoubt::look_at() {
  const auto in_a_row = static_cast<int64_t>(outcome_.fixes.size());
  if (judge_.state_is_doubted(last_fix_ns_) && in_a_row > options_.reinstate_after) {
    outcome_.state_was_wrong = true;
    return believe_all();
  }
  if (recent_.size() < look_needs() ||
      seconds_between(recent_.front().t_ns, recent_.back().t_ns) < kLookAfter) {
    return;
  }
  if (scatters_about_zero()) {
    for (const Rejected& rejected : recent_) outcome_.level.push_back(rejected.square);
    return believe_all();
  }
  const InnovationLine line = fit();
  if (!lies_on(line)) {
    if (is_smooth()) blame_state();
    return;
  }
  line_drifts_ = drifts(line);
  return !line_drifts_ || goes_on(line) ? begin_line(line) : blame_state();
}

void FixDoubt::begin_line(const InnovationLine& line) {
  line_ = line;
  outcome_.notices.push_back(
      line_drifts_
          ? fmt::format("fixes since {} drift away by {:.2f} m/s, which the IMU excludes; used "
                        "without the drift",
                        when(begin_.t_ns), line.rate_n.norm())
          : fmt::format("fixes since {} are off by {:.2f} m; used without that unless it stays",
                        when(begin_.t_ns), line.offset_n.norm()));
}

void FixDoubt::follow_line(const GnssFix& fix, const state::Innovation& innovation,
                           double since_last) {
  const Vector3d error_n = line_->at(fix.t_ns);
  const Vector3d left_n = innovation.value - error_n;
  const Eigen::Matrix3d variance_n = line_->variance_at(fix.t_ns).asDiagonal();
  const Eigen::Matrix3d& S = innovation.covariance;
  const bool is_back = judge_.passes(mahalanobis_squared(innovation.value, S));
  const bool is_on_line = judge_.passes(mahalanobis_squared(left_n, S + variance_n));
  const bool line_is_nearer =
      mahalanobis_squared(left_n, S) < mahalanobis_squared(innovation.value, S);
  if (is_back && !(is_on_line && line_is_nearer)) return end_line(fix);
  leave_out(fix);
  if (!is_on_line) return miss_line();
  line_missed_ = 0;
  use_corrected(error_n, variance_n, since_last);
}

/// Agrees with the IMU again.
void FixDoubt::end_line(const GnssFix& fix) {
  outcome_.notices.push_back(
      fmt::format("fixes agree with the IMU again; {} since {} were not taken as they are",
                  outcome_.fixes.size(), when(begin_.t_ns)));
  outcome_.fixes.push_back({Action::use, fix, {}});
  decided_ = true;
}

/// The last fix less the line. Its errors stay where those of fixes average out.
void FixDoubt::use_corrected(const Vector3d& error_n, const Eigen::Matrix3d& variance_n,
                             double since_last) {
  FixDecision& decision = outcome_.fixes.back();
  decision.action = Action::use_corrected;
  decision.corrected = decision.fix;
  decision.corrected.antenna = geodesy::LocalFrame(decision.fix.antenna).to_geodetic(-error_n);
  const double times = std::max(1.0, kLineMemory / std::max(0.01, since_last));
  decision.corrected.position_covariance += times * variance_n;
  ahead_->update(measurement::gnss_position(decision.corrected));
}

void FixDoubt::miss_line() {
  if (++line_missed_ < kMissesThatEndLine) return;
  from_ns_ = last_fix_ns_;
  from_n_ = line_->at(last_fix_ns_);
  line_.reset();
  line_missed_ = 0;
  recent_.clear();
  held_.covariance.setZero();
}

// What comes out --------------------------------------------------------------------------------

void FixDoubt::leave_out(const GnssFix& fix) {
  outcome_.fixes.push_back({Action::leave_out, fix, {}});
}

void FixDoubt::believe_all() {
  for (FixDecision& decision : outcome_.fixes) decision.action = Action::use;
  decided_ = true;
}

/// The state was wrong from the first fix on: position, motion and biases; by a drift if there was
/// an outage. Unless it is likelier that its sigmas are too small, and some fixes outliers.
void FixDoubt::blame_state() {
  believe_all();
  outcome_.state_was_wrong = trial_.has_value();
  const state::NodeMatrix added = looseness();
  Pass best;
  if (!trial_) {
    std::unique_ptr<measurement::Navigator> loosened = start_->ahead(1);
    loosened->loosen(added);
    best = drive_again(std::move(loosened));
    outcome_.loosened = added;
    for (double scale = 1; scale <= kLargestScale; scale *= 2) {
      Pass pass = drive_again(start_->ahead(scale));
      pass.log_probability -= std::log(scale);
      if (!pass.believes_most() || pass.log_probability < best.log_probability) continue;
      best = pass;
      outcome_.loosened.reset();
    }
    for (std::size_t i = 0; i < best.is_true.size(); ++i) {
      if (!best.is_true[i]) outcome_.fixes[i].action = Action::leave_out;
    }
  }
  const char* verdict = outcome_.loosened || trial_
                            ? "the state is taken for wrong there"
                            : "those that contradict each other are left out";
  outcome_.notices.push_back(
      fmt::format("fixes since {} contradict the IMU, the first by {:.2f} m; {}", when(begin_.t_ns),
                  begin_innovation_n_.norm(), verdict));
}

bool FixDoubt::Pass::believes_most() const {
  const auto count = std::count(is_true.begin(), is_true.end(), true);
  return 2 * static_cast<std::size_t>(count) >= is_true.size();
}

FixDoubt::Pass FixDoubt::drive_again(std::unique_ptr<measurement::Navigator> navigator) const {
  Pass pass;
  std::size_t driven = 0;
  for (const FixDecision& decision : outcome_.fixes) {
    while (driven < driven_.size() && driven_[driven].t_end_ns <= decision.fix.t_ns) {
      navigator->propagate(driven_[driven++]);
    }
    GnssFix trusted = decision.fix;
    trusted.position_covariance *= judge_.level();
    const FixLikelihood likelihood =
        likelihood_of(navigator->innovation(measurement::GnssPosition(trusted)));
    pass.log_probability += likelihood.log_density;
    pass.is_true.push_back(likelihood.is_true);
    if (likelihood.is_true) navigator->update(measurement::gnss_position(trusted));
  }
  return pass;
}

/// Its position was wrong, not its motion. After an outage it has come there by a drift, for which
/// its covariance is enough.
void FixDoubt::move_state() {
  const double off = line_->offset_n.norm();
  outcome_.notices.push_back(fmt::format(
      "fixes off by {:.2f} m since {} have stayed so and are believed", off, when(begin_.t_ns)));
  outcome_.state_was_wrong = true;
  if (!trial_) {
    outcome_.loosened = state::NodeMatrix::Zero();
    state::part(outcome_.loosened->diagonal(), state::block::position).setConstant(off * off);
  }
  believe_all();
}

/// There is nothing more to see.
void FixDoubt::settle_at_end() {
  if (decided_) return;
  if (trial_ && !line_) judge_return();
  const bool constant = line_ && !line_drifts_;
  const bool stays = seconds_between(begin_.t_ns, last_fix_ns_) > kJumpStays;
  if (constant && (stays || (trial_ && !offset_is_certain_))) move_state();
  decided_ = true;
}

/// As much doubt about position, velocity and attitude as the fixes show; the sigmas of biases grow
/// to the double.
state::NodeMatrix FixDoubt::looseness() const {
  constexpr double kSpeed = 3;      // [m/s]: an error of the velocity beyond is one of attitude
  constexpr double kLargest = 0.5;  // [rad]
  const InnovationLine line = line_ ? *line_ : recent_.size() > 2 ? fit() : InnovationLine{};
  const double rate = line.rate_n.norm();
  const double turn = std::min(kLargest, rate / std::max(kSpeed, begin_.velocity_n.norm()));
  state::NodeMatrix added = state::NodeMatrix::Zero();
  auto variance = added.diagonal();
  state::part(variance, state::block::position).setConstant(begin_innovation_n_.squaredNorm());
  state::part(variance, state::block::velocity).setConstant(rate * rate + 0.01);
  state::part(variance, state::block::attitude).setConstant(turn * turn);
  state::part(variance, state::block::gyro_bias) =
      3 * begin_.sigma_of(state::block::gyro_bias).cwiseAbs2();
  state::part(variance, state::block::accel_bias) =
      3 * begin_.sigma_of(state::block::accel_bias).cwiseAbs2();
  return added;
}

// What innovations look like --------------------------------------------------------------------

/// Least squares. The line's errors are those of the fixes and of the state's velocity.
InnovationLine FixDoubt::fit() const {
  const double n = static_cast<double>(recent_.size());
  InnovationLine line;
  line.t_ns = recent_.back().t_ns;
  double mean_t = 0;
  Vector3d mean = Vector3d::Zero(), variance = Vector3d::Zero();
  for (const Rejected& r : recent_) {
    mean_t += seconds_between(line.t_ns, r.t_ns) / n;
    mean += r.innovation_n / n;
    variance += judge_.level() * r.variance_n / n;
  }
  double tt = 0;
  Vector3d tv = Vector3d::Zero();
  for (const Rejected& r : recent_) {
    const double t = seconds_between(line.t_ns, r.t_ns) - mean_t;
    tt += t * t;
    tv += t * (r.innovation_n - mean);
  }
  line.rate_n = tv / tt;
  line.offset_n = mean - mean_t * line.rate_n;
  line.offset_variance_n = variance * (1 / n + mean_t * mean_t / tt);
  line.rate_variance_n = variance / tt + velocity_variance(held_);
  return line;
}

bool FixDoubt::scatters_about_zero() const {
  const double n = static_cast<double>(recent_.size());
  Vector3d mean = Vector3d::Zero(), squares = Vector3d::Zero(), variance = Vector3d::Zero();
  for (const Rejected& r : recent_) {
    mean += r.innovation_n / n;
    squares += r.innovation_n.cwiseAbs2() / n;
    variance += judge_.level() * r.variance_n / n;
  }
  const Vector3d scatter = squares - mean.cwiseAbs2();
  constexpr double kSigmas = 4;
  return (mean.cwiseAbs2() - kSigmas * kSigmas / n * scatter).maxCoeff() <= 0 &&
         (scatter - kSigmasTooSmall * kSigmasTooSmall * variance).maxCoeff() <= 0;
}

/// Within the noise of the fixes and what the IMU may bend a line by.
bool FixDoubt::lies_on(const InnovationLine& line) const {
  const double n = static_cast<double>(recent_.size());
  Vector3d squares = Vector3d::Zero(), variance = Vector3d::Zero();
  for (const Rejected& r : recent_) {
    squares += (r.innovation_n - line.at(r.t_ns)).cwiseAbs2() / n;
    variance += judge_.level() * r.variance_n / n;
  }
  const double span = seconds_between(recent_.front().t_ns, recent_.back().t_ns);
  const double bend = acceleration_sigma(held_) * span * span / 16;
  const Vector3d limit = 2 * variance.cwiseSqrt() + 3 * bend * Vector3d::Ones();
  return (squares.cwiseSqrt() - limit).maxCoeff() <= 0;
}

/// By more than the line and the state's velocity are uncertain.
bool FixDoubt::drifts(const InnovationLine& line) const {
  const Vector3d sigma = (line.rate_variance_n + velocity_variance(ahead_->epoch())).cwiseSqrt();
  return (line.rate_n.cwiseAbs() - 4 * sigma).maxCoeff() > 0;
}

/// From nothing, up to where the gate took notice, or from the line before it; and the way of some
/// fixes.
bool FixDoubt::goes_on(const InnovationLine& line) const {
  constexpr double kGateSigmas = 8;
  const double way = kMissesThatEndLine * seconds_between(recent_[0].t_ns, recent_[1].t_ns);
  const Vector3d most = kGateSigmas * std::sqrt(judge_.level()) * begin_variance_n_.cwiseSqrt() +
                        way * line.rate_n.cwiseAbs();
  return ((line.at(from_ns_) - from_n_).cwiseAbs() - most).maxCoeff() <= 0;
}

/// By the ratio of von Neumann: 2 for noise, 0 for what is smooth.
bool FixDoubt::is_smooth() const {
  Vector3d mean = Vector3d::Zero();
  for (const Rejected& r : recent_) mean += r.innovation_n / static_cast<double>(recent_.size());
  double variance = 0, steps = 0;
  for (std::size_t i = 0; i < recent_.size(); ++i) {
    variance += (recent_[i].innovation_n - mean).squaredNorm();
    if (i > 0) steps += (recent_[i].innovation_n - recent_[i - 1].innovation_n).squaredNorm();
  }
  return steps < variance;
}

}  // namespace foucault::diagnosis
