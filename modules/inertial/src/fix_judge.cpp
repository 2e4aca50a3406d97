#include "fix_judge.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "foucault/core/state.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;
/// After a hole the attitude may be off by tens of degrees, beyond what is linear: sigmas are then
/// too small for a while, and every fix is needed.
constexpr int64_t kGateOpenNs = 10 * kNanosecondsPerSecond;
constexpr int64_t kStateDoubtedNs = 60 * kNanosecondsPerSecond;
constexpr std::size_t kLevelMemory = 31;  // fixes
constexpr std::size_t kLevelNeeds = 5;
constexpr double kBelievedMemory = 60;  // fixes
constexpr double kLargestShare = 10;    // of one fix, times the level
constexpr double kMedianChiSquare3 = 2.366;

constexpr double kJumpStays = 30;       // [s]
constexpr double kLongestDoubt = 90;    // [s]
constexpr double kLookAfter = 5;        // [s]
constexpr std::size_t kLookNeeds = 6;   // fixes
constexpr double kWindow = 10;          // [s] that a look goes back
constexpr double kThinning = 0.25;      // [s] between fixes in it
constexpr double kSigmasTooSmall = 30;  // factor that sigmas may be too small by
constexpr int kMissesThatEndLine = 3;
/// For so long [s] the errors of a line stay the same, and do not average out.
constexpr double kLineMemory = 10;
constexpr double kGravity = 9.8;

/// Survival function of the chi-square distribution with 3 degrees of freedom.
double chi_square_3_tail(double x) {
  return std::erfc(std::sqrt(x / 2)) + std::sqrt(2 * x / kPi) * std::exp(-x / 2);
}

double normalized_square(const Vector3d& value, const Eigen::Matrix3d& covariance) {
  return value.dot(Eigen::LLT<Eigen::Matrix3d>(covariance).solve(value));
}

Vector3d velocity_variance(const Epoch& epoch) {
  return epoch.covariance.diagonal().segment<3>(error_state::kVelocity);
}

/// What the state does not know of its acceleration: tilt and accelerometer bias [m/s^2].
double acceleration_sigma(const Epoch& epoch) {
  const Vector15d variance = epoch.covariance.diagonal();
  return std::sqrt(kGravity * kGravity * variance.segment<3>(error_state::kAttitude).maxCoeff() +
                   variance.segment<3>(error_state::kAccelBias).maxCoeff());
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

void FixJudge::start(int64_t t_ns) {
  doubt_.reset();
  squares_.clear();
  believed_level_ = 1;
  rejected_in_a_row_ = 0;
  last_quality_ = FixQuality::fixed_rtk;
  state_doubted_until_ns_ = t_ns + kStateDoubtedNs;
}

void FixJudge::doubt_state(int64_t t_ns) {
  state_doubted_until_ns_ = t_ns + kStateDoubtedNs;
  open_gate(t_ns + kGateOpenNs);
}

void FixJudge::open_gate(int64_t until_ns) {
  gate_open_until_ns_ = std::max(gate_open_until_ns_, until_ns);
}

double FixJudge::level() const {
  double level = std::max(1.0, believed_level_);
  if (squares_.size() < kLevelNeeds) return level;
  std::vector<double> sorted(squares_.begin(), squares_.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return std::max(level, *middle / kMedianChiSquare3);
}

void FixJudge::remember(double square) {
  squares_.push_back(square);
  if (squares_.size() > kLevelMemory) squares_.pop_front();
}

void FixJudge::remember(const Doubt& doubt) {
  for (const Rejected& rejected : doubt.recent) remember(rejected.square);
}

bool FixJudge::passes(double square) const {
  return chi_square_3_tail(square / level()) >= options_.gate_false_alarm;
}

FixJudge::Decision FixJudge::judge(const GnssFix& fix, const Innovation& innovation,
                                   const Navigator& navigator) {
  // Worse fixes before may have pulled the state away, with sigmas that promised too much.
  if (fix.quality > last_quality_) open_gate(fix.t_ns + kGateOpenNs);
  const double square = normalized_square(innovation.value_n, innovation.covariance);
  const bool passed = passes(square);
  if (!doubt_) remember(square);
  if (passed || fix.t_ns <= gate_open_until_ns_) {
    const double share = std::min(square / 3, kLargestShare * level());
    believed_level_ += (share - believed_level_) / kBelievedMemory;
    return believe(fix);
  }
  return reject(fix, innovation, navigator);
}

FixJudge::Decision FixJudge::believe(const GnssFix& fix) {
  Decision decision;
  decision.fix = fix;
  if (doubt_ && doubt_->noticed) {
    decision.notice = fmt::format(
        "fixes agree with the IMU again; {} since {} were not taken as "
        "they are",
        doubt_->left_out, when(doubt_->begin_ns));
  }
  doubt_.reset();
  rejected_in_a_row_ = 0;
  last_quality_ = fix.quality;
  return decision;
}

FixJudge::Decision FixJudge::reject(const GnssFix& fix, const Innovation& innovation,
                                    const Navigator& navigator) {
  ++rejected_in_a_row_;
  if (fix.t_ns <= state_doubted_until_ns_ && rejected_in_a_row_ > options_.reinstate_after) {
    open_gate(fix.t_ns + kGateOpenNs);
    return believe(fix);
  }
  if (!doubt_) {
    Doubt doubt;
    doubt.begin_ns = doubt.from_ns = fix.t_ns;
    doubt.begin = navigator.epoch();
    doubt.begin_variance_n = innovation.covariance.diagonal();
    doubt_ = doubt;
  }
  ++doubt_->left_out;
  if (seconds_between(doubt_->begin_ns, fix.t_ns) > kLongestDoubt) return restart(fix);
  if (doubt_->line) {
    const Decision decision = follow_line(fix, innovation);
    last_rejected_ns_ = fix.t_ns;
    return decision;
  }
  last_rejected_ns_ = fix.t_ns;

  std::deque<Rejected>& recent = doubt_->recent;
  if (recent.empty() || seconds_between(recent.back().t_ns, fix.t_ns) >= kThinning) {
    recent.push_back({fix.t_ns, innovation.value_n, fix.position_covariance.diagonal(),
                      normalized_square(innovation.value_n, innovation.covariance)});
  }
  while (seconds_between(recent.front().t_ns, fix.t_ns) > kWindow) recent.pop_front();
  return look_at(fix, navigator);
}

/// What the fixes of the doubt are, once there are enough.
FixJudge::Decision FixJudge::look_at(const GnssFix& fix, const Navigator& navigator) {
  const std::deque<Rejected>& recent = doubt_->recent;
  const std::size_t needed =
      std::max(kLookNeeds, static_cast<std::size_t>(options_.reinstate_after) + 1);
  if (recent.size() < needed ||
      seconds_between(recent.front().t_ns, recent.back().t_ns) < kLookAfter) {
    return leave_out(fix);
  }
  if (scatters_about_zero()) {
    remember(*doubt_);
    return believe(fix);
  }
  const InnovationLine line = fit();
  if (lies_on(line)) {
    doubt_->drifts = drifts(line, navigator);
    if (!doubt_->drifts || goes_on(line)) return doubt_fixes(fix, line);
    return restart(fix);
  }
  return is_smooth() ? restart(fix) : leave_out(fix);
}

FixJudge::Decision FixJudge::doubt_fixes(const GnssFix& fix, const InnovationLine& line) {
  doubt_->line = line;
  doubt_->noticed = true;
  Decision decision = leave_out(fix);
  decision.notice =
      doubt_->drifts
          ? fmt::format(
                "fixes since {} drift away by {:.2f} m/s, which the IMU excludes; used without the "
                "drift",
                when(doubt_->begin_ns), line.rate_n.norm())
          : fmt::format(
                "fixes since {} are off by {:.2f} m; used without that until it stays for {:.0f} s",
                when(doubt_->begin_ns), line.offset_n.norm(), kJumpStays);
  return decision;
}

FixJudge::Decision FixJudge::follow_line(const GnssFix& fix, const Innovation& innovation) {
  const InnovationLine line = *doubt_->line;
  if (!doubt_->drifts && seconds_between(doubt_->begin_ns, fix.t_ns) > kJumpStays) {
    Decision decision = believe(fix);
    decision.action = Action::move_state;
    decision.notice = fmt::format(
        "fixes off by {:.2f} m have stayed so for {:.0f} s and are "
        "believed; the position is moved there",
        innovation.value_n.norm(), kJumpStays);
    return decision;
  }
  const Vector3d error_n = line.at(fix.t_ns);
  const Vector3d variance_n = line.variance_at(fix.t_ns);
  const Eigen::Matrix3d S = innovation.covariance + Eigen::Matrix3d(variance_n.asDiagonal());
  if (!passes(normalized_square(innovation.value_n - error_n, S))) {
    if (++doubt_->line_missed >= kMissesThatEndLine) {
      doubt_->from_ns = fix.t_ns;
      doubt_->from_n = line.at(fix.t_ns);
      doubt_->line.reset();
      doubt_->line_missed = 0;
      doubt_->recent.clear();
      doubt_->begin.covariance.setZero();
    }
    return leave_out(fix);
  }
  doubt_->line_missed = 0;
  Decision decision;
  decision.action = Action::use_corrected;
  decision.fix = fix;
  decision.fix.antenna = LocalFrame(fix.antenna).to_geodetic(-error_n);
  // The line's errors stay where those of fixes average out.
  const double interval = std::max(0.01, seconds_between(last_rejected_ns_, fix.t_ns));
  const double times = std::max(1.0, kLineMemory / interval);
  decision.fix.position_covariance += Eigen::Matrix3d((times * variance_n).asDiagonal());
  return decision;
}

FixJudge::Decision FixJudge::leave_out(const GnssFix& fix) {
  Decision decision;
  decision.action = Action::leave_out;
  decision.fix = fix;
  return decision;
}

FixJudge::Decision FixJudge::restart(const GnssFix& fix) {
  Decision decision;
  decision.action = Action::restart_state;
  decision.fix = fix;
  if (doubt_->recent.size() > 2) decision.line = fit();
  if (doubt_->line) decision.line = *doubt_->line;
  decision.notice = fmt::format(
      "fixes since {} contradict the IMU, the last by {:.2f} m; the state is taken for "
      "wrong and started again at the fix",
      when(doubt_->begin_ns), decision.line.at(fix.t_ns).norm());
  believe(fix);
  doubt_state(fix.t_ns);
  return decision;
}

/// Least squares. The line's errors are those of the fixes and of the state's velocity.
InnovationLine FixJudge::fit() const {
  const std::deque<Rejected>& recent = doubt_->recent;
  const double n = static_cast<double>(recent.size());
  InnovationLine line;
  line.t_ns = recent.back().t_ns;
  double mean_t = 0;
  Vector3d mean = Vector3d::Zero(), variance = Vector3d::Zero();
  for (const Rejected& r : recent) {
    mean_t += seconds_between(line.t_ns, r.t_ns) / n;
    mean += r.innovation_n / n;
    variance += level() * r.variance_n / n;
  }
  double tt = 0;
  Vector3d tv = Vector3d::Zero();
  for (const Rejected& r : recent) {
    const double t = seconds_between(line.t_ns, r.t_ns) - mean_t;
    tt += t * t;
    tv += t * (r.innovation_n - mean);
  }
  line.rate_n = tv / tt;
  line.offset_n = mean - mean_t * line.rate_n;
  line.offset_variance_n = variance * (1 / n + mean_t * mean_t / tt);
  line.rate_variance_n = variance / tt + velocity_variance(doubt_->begin);
  return line;
}

bool FixJudge::scatters_about_zero() const {
  const std::deque<Rejected>& recent = doubt_->recent;
  const double n = static_cast<double>(recent.size());
  Vector3d mean = Vector3d::Zero(), squares = Vector3d::Zero(), variance = Vector3d::Zero();
  for (const Rejected& r : recent) {
    mean += r.innovation_n / n;
    squares += r.innovation_n.cwiseAbs2() / n;
    variance += level() * r.variance_n / n;
  }
  const Vector3d scatter = squares - mean.cwiseAbs2();
  constexpr double kSigmas = 4;
  return (mean.cwiseAbs2() - kSigmas * kSigmas / n * scatter).maxCoeff() <= 0 &&
         (scatter - kSigmasTooSmall * kSigmasTooSmall * variance).maxCoeff() <= 0;
}

/// Within the noise of the fixes and what the IMU may bend a line by.
bool FixJudge::lies_on(const InnovationLine& line) const {
  const std::deque<Rejected>& recent = doubt_->recent;
  const double n = static_cast<double>(recent.size());
  Vector3d squares = Vector3d::Zero(), variance = Vector3d::Zero();
  for (const Rejected& r : recent) {
    squares += (r.innovation_n - line.at(r.t_ns)).cwiseAbs2() / n;
    variance += level() * r.variance_n / n;
  }
  const double span = seconds_between(recent.front().t_ns, recent.back().t_ns);
  const double bend = acceleration_sigma(doubt_->begin) * span * span / 16;
  const Vector3d limit = 2 * variance.cwiseSqrt() + 3 * bend * Vector3d::Ones();
  return (squares.cwiseSqrt() - limit).maxCoeff() <= 0;
}

/// By more than the line and the state's velocity are uncertain.
bool FixJudge::drifts(const InnovationLine& line, const Navigator& navigator) const {
  const Vector3d sigma = (line.rate_variance_n + velocity_variance(navigator.epoch())).cwiseSqrt();
  return (line.rate_n.cwiseAbs() - 4 * sigma).maxCoeff() > 0;
}

/// From nothing, up to where the gate took notice, or from the line before it; and the way of some
/// fixes.
bool FixJudge::goes_on(const InnovationLine& line) const {
  constexpr double kGateSigmas = 8;
  const std::deque<Rejected>& recent = doubt_->recent;
  const double way = kMissesThatEndLine * seconds_between(recent[0].t_ns, recent[1].t_ns);
  const Vector3d most = kGateSigmas * std::sqrt(level()) * doubt_->begin_variance_n.cwiseSqrt() +
                        way * line.rate_n.cwiseAbs();
  return ((line.at(doubt_->from_ns) - doubt_->from_n).cwiseAbs() - most).maxCoeff() <= 0;
}

/// By the ratio of von Neumann: 2 for noise, 0 for what is smooth.
bool FixJudge::is_smooth() const {
  const std::deque<Rejected>& recent = doubt_->recent;
  Vector3d mean = Vector3d::Zero();
  for (const Rejected& r : recent) mean += r.innovation_n / static_cast<double>(recent.size());
  double variance = 0, steps = 0;
  for (std::size_t i = 0; i < recent.size(); ++i) {
    variance += (recent[i].innovation_n - mean).squaredNorm();
    if (i > 0) steps += (recent[i].innovation_n - recent[i - 1].innovation_n).squaredNorm();
  }
  return steps < variance;
}

Epoch moved_to_fix(const Epoch& epoch, const GnssFix& fix, const Innovation& innovation) {
  using error_state::kPosition;
  Epoch moved = epoch;
  moved.position = LocalFrame(epoch.position).to_geodetic(innovation.value_n);
  moved.covariance.middleRows<3>(kPosition).setZero();
  moved.covariance.middleCols<3>(kPosition).setZero();
  moved.covariance.block<3, 3>(kPosition, kPosition) = fix.position_covariance;
  return moved;
}

Epoch restarted_at_fix(const Epoch& epoch, const GnssFix& fix, const Innovation& innovation,
                       const InnovationLine& line) {
  using namespace error_state;
  constexpr double kSpeed = 3;       // [m/s]: an error of the velocity beyond is one of attitude
  constexpr double kLargest = 0.5;   // [rad]
  constexpr double kBiasesGrow = 2;  // sigma
  Epoch restarted = moved_to_fix(epoch, fix, innovation);
  restarted.velocity_n += line.rate_n;
  const double rate = line.rate_n.norm();
  const double turn = std::min(kLargest, rate / std::max(kSpeed, epoch.velocity_n.norm()));
  Matrix15d& P = restarted.covariance;
  const Vector15d before = P.diagonal();
  P.block<6, 3>(kVelocity, kGyroBias).setZero();
  P.block<6, 3>(kVelocity, kAccelBias).setZero();
  P.block<3, 6>(kGyroBias, kVelocity).setZero();
  P.block<3, 6>(kAccelBias, kVelocity).setZero();
  P.block<3, 3>(kVelocity, kAttitude).setZero();
  P.block<3, 3>(kAttitude, kVelocity).setZero();
  P.diagonal().segment<3>(kVelocity).array() += rate * rate + 0.01;
  P.diagonal().segment<3>(kAttitude).array() += turn * turn;
  P.diagonal().tail<6>() += (kBiasesGrow * kBiasesGrow - 1) * before.tail<6>();
  return restarted;
}

}  // namespace foucault
