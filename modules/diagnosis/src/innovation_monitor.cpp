#include "foucault/diagnosis/innovation_monitor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/time.h"
#include "foucault/diagnosis/return_trial.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/state/blocks.h"

namespace foucault::diagnosis {
namespace {

using Action = FixDecision::Action;
using Eigen::Vector3d;
using measurement::Navigator;
using state::NodeMatrix;
using state::part;
namespace block = state::block;

// Chosen, on simulated ramps and jumps (a ramp to 20 m leaves 0.4 m): by fewer or sooner, noise
// makes lines; over more a consumer IMU bends them.
constexpr double kLookAfter = 5;       // [s]
constexpr std::size_t kLookNeeds = 6;  // fixes
constexpr double kWindow = 10;         // [s] that a look goes back
/// The window of a line: for so long [s] its errors stay the same, and do not average out.
constexpr double kLineMemory = kWindow;
constexpr double kGravity = 9.8;  // to two digits, by which a tilt is an acceleration

/// What the state does not know of its acceleration: tilt and accelerometer bias [m/s^2].
double acceleration_sigma(const state::Epoch& epoch) {
  return std::hypot(kGravity * epoch.sigma_of(state::block::attitude).maxCoeff(),
                    epoch.sigma_of(state::block::accel_bias).maxCoeff());
}

}  // namespace

InnovationMonitor::InnovationMonitor(const GnssOptions& options, const FixJudge& judge,
                                     DoubtBegin begin, Lookahead& ahead)
    : FaultExclusion(judge, std::move(begin)),
      reinstate_after_(options.reinstate_after),
      ahead_(ahead),
      held_(begin_.state),
      from_ns_(begin_.state.t_ns) {}

void InnovationMonitor::meet(const MetFix& met) {
  if (line_) return follow_line(met);
  if (judge_.passes(met.square)) return use(met.fix);
  leave_out(met.fix);
  remember(met);
  look_at();
}

void InnovationMonitor::remember(const MetFix& met) {
  if (recent_.empty() || seconds_between(recent_.back().t_ns, met.fix.t_ns) >= kThinning) {
    recent_.push_back(sample(met));
  }
  while (recent_.size() > look_needs() &&
         seconds_between(recent_.front().t_ns, met.fix.t_ns) > kWindow) {
    recent_.pop_front();
  }
}

std::size_t InnovationMonitor::look_needs() const {
  return std::max(kLookNeeds, static_cast<std::size_t>(reinstate_after_) + 1);
}

/// What the fixes of the doubt are, once there are enough.
void InnovationMonitor::look_at() {
  const auto in_a_row = static_cast<int64_t>(outcome_.fixes.size());
  if (judge_.state_is_doubted(last_fix_ns_) && in_a_row > reinstate_after_) {
    outcome_.state_was_wrong = true;
    return believe_all();
  }
  if (recent_.size() < look_needs() ||
      seconds_between(recent_.front().t_ns, recent_.back().t_ns) < kLookAfter) {
    return;
  }
  if (scatter_about_zero(recent_)) {
    for (const InnovationSample& s : recent_) outcome_.level.push_back(s.square);
    return believe_all();
  }
  const InnovationLine line = fit();
  if (!lie_on(recent_, line, acceleration_sigma(held_))) {
    if (are_smooth(recent_)) blame_state();
    return;
  }
  const bool drifts = line.drifts(velocity_variance(ahead_.epoch()));
  if (drifts && !goes_on(line)) return blame_state();
  begin_line(line, drifts);
}

InnovationLine InnovationMonitor::fit() const {
  return fit_line(recent_, velocity_variance(held_));
}

/// From nothing, up to where the gate took notice, or from the line before it; and the way of some
/// fixes.
bool InnovationMonitor::goes_on(const InnovationLine& line) const {
  constexpr double kGateSigmas = 8;  // 6 of the gate at 1e-7, and the noise of the line
  const double way = kMissesThatEndLine * seconds_between(recent_[0].t_ns, recent_[1].t_ns);
  const Vector3d most = kGateSigmas * std::sqrt(judge_.level()) * begin_.variance_n.cwiseSqrt() +
                        way * line.rate_n.cwiseAbs();
  return ((line.at(from_ns_) - from_n_).cwiseAbs() - most).maxCoeff() <= 0;
}

// A line ----------------------------------------------------------------------------------------

void InnovationMonitor::begin_line(const InnovationLine& line, bool drifts) {
  line_ = line;
  line_drifts_ = drifts;
  notice(drifts ? fmt::format("fixes since {} drift away by {:.2f} m/s, which the IMU excludes; "
                              "used without the drift",
                              since(), line.rate_n.norm())
                : fmt::format("fixes since {} are off by {:.2f} m; used without that unless it "
                              "stays",
                              since(), line.offset_n.norm()));
}

void InnovationMonitor::follow_line(const MetFix& met) {
  const Eigen::Matrix3d& S = met.innovation_covariance;
  const Vector3d left_n = met.innovation_n - line_->at(met.fix.t_ns);
  const Eigen::Matrix3d variance_n = line_->variance_at(met.fix.t_ns).asDiagonal();
  const bool is_back = judge_.passes(met.square);
  const bool is_on_line = judge_.passes(mahalanobis_squared(left_n, S + variance_n));
  const bool line_is_nearer = mahalanobis_squared(left_n, S) < met.square;
  if (is_back && !(is_on_line && line_is_nearer)) return end_line(met.fix);
  leave_out(met.fix);
  if (!is_on_line) return miss_line();
  line_missed_ = 0;
  use_corrected(met);
}

/// Agrees with the IMU again.
void InnovationMonitor::end_line(const GnssFix& fix) {
  notice(fmt::format("fixes agree with the IMU again; {} since {} were not taken as they are",
                     outcome_.fixes.size(), since()));
  use(fix);
}

/// The last fix less the line. Its errors stay where those of fixes average out.
void InnovationMonitor::use_corrected(const MetFix& met) {
  const Vector3d error_n = line_->at(met.fix.t_ns);
  const Eigen::Matrix3d variance_n = line_->variance_at(met.fix.t_ns).asDiagonal();
  FixDecision& decision = outcome_.fixes.back();
  decision.action = Action::use_corrected;
  decision.corrected = decision.fix;
  decision.corrected.antenna = geodesy::LocalFrame(decision.fix.antenna).to_geodetic(-error_n);
  const double times = std::max(1.0, kLineMemory / std::max(0.01, met.since_last));
  decision.corrected.position_covariance += times * variance_n;
  ahead_.navigator().update(measurement::gnss_position(decision.corrected));
}

void InnovationMonitor::miss_line() {
  if (++line_missed_ < kMissesThatEndLine) return;
  from_ns_ = last_fix_ns_;
  from_n_ = line_->at(last_fix_ns_);
  line_.reset();
  line_missed_ = 0;
  recent_.clear();
  held_.covariance.setZero();
}

// What comes out --------------------------------------------------------------------------------

void InnovationMonitor::give_up(const GnssFix& last) {
  leave_out(last);
  return line_ && !line_drifts_ ? move_state() : blame_state();
}

void InnovationMonitor::settle() {
  if (decided_) return;
  if (line_ && !line_drifts_ && stays()) move_state();
  decided_ = true;
}

void InnovationMonitor::move_state() {
  const double off = line_->offset_n.norm();
  outcome_.loosened = NodeMatrix::Zero();
  part(outcome_.loosened->diagonal(), state::block::position).setConstant(off * off);
  believe_offset(off);
}

/// The state was wrong from the first fix on: position, motion and biases. Unless it is likelier
/// that its sigmas are too small, and some fixes outliers.
void InnovationMonitor::blame_state() {
  believe_all();
  const NodeMatrix added = looseness();
  std::unique_ptr<Navigator> loosened = ahead_.again(1);
  loosened->loosen(added);
  outcome_.loosened = added;
  const Pass best = try_scales(drive_again(std::move(loosened)));
  for (std::size_t i = 0; i < best.is_true.size(); ++i) {
    if (!best.is_true[i]) outcome_.fixes[i].action = Action::leave_out;
  }
  notice_contradiction(outcome_.loosened ? "the state is taken for wrong there"
                                         : "those that contradict each other are left out");
}

/// The better one of `best` and of those by a state with larger sigmas, which need not be loosened.
InnovationMonitor::Pass InnovationMonitor::try_scales(Pass best) {
  for (double scale = 1; scale <= kLargestScale; scale *= 2) {
    Pass pass = drive_again(ahead_.again(scale));
    pass.log_probability -= std::log(scale);
    if (!pass.believes_most() || pass.log_probability < best.log_probability) continue;
    best = pass;
    outcome_.loosened.reset();
  }
  return best;
}

bool InnovationMonitor::Pass::believes_most() const {
  const auto count = std::count(is_true.begin(), is_true.end(), true);
  return 2 * static_cast<std::size_t>(count) >= is_true.size();
}

InnovationMonitor::Pass InnovationMonitor::drive_again(std::unique_ptr<Navigator> navigator) const {
  Pass pass;
  std::size_t driven = 0;
  const std::vector<ImuIncrement>& increments = ahead_.driven();
  for (const FixDecision& decision : outcome_.fixes) {
    while (driven < increments.size() && increments[driven].t_end_ns <= decision.fix.t_ns) {
      navigator->propagate(increments[driven++]);
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

/// As much doubt about position, velocity and attitude as the fixes show; the sigmas of biases grow
/// to the double.
NodeMatrix InnovationMonitor::looseness() const {
  constexpr double kSpeed = 3;      // [m/s]: an error of the velocity beyond is one of attitude
  constexpr double kLargest = 0.5;  // [rad]; chosen: what is still about linear
  const InnovationLine line = line_ ? *line_ : recent_.size() > 2 ? fit() : InnovationLine{};
  const double rate = line.rate_n.norm();
  const double turn = std::min(kLargest, rate / std::max(kSpeed, begin_.state.velocity_n.norm()));
  NodeMatrix added = NodeMatrix::Zero();
  auto variance = added.diagonal();
  part(variance, state::block::position).setConstant(begin_.innovation_n.squaredNorm());
  part(variance, state::block::velocity).setConstant(rate * rate + 0.01);
  part(variance, state::block::attitude).setConstant(turn * turn);
  part(variance, state::block::gyro_bias) =
      3 * begin_.state.sigma_of(state::block::gyro_bias).cwiseAbs2();
  part(variance, state::block::accel_bias) =
      3 * begin_.state.sigma_of(state::block::accel_bias).cwiseAbs2();
  return added;
}

}  // namespace foucault::diagnosis
