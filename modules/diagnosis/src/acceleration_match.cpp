#include "foucault/diagnosis/acceleration_match.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/position.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/diagnosis/missing.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Vector3d;

constexpr double kLongestOffset = 1, kStep = 0.02;  // [s]
constexpr double kGrid = 0.02;                      // [s] of the motion
/// [s]; chosen: gyroscopes of 600 deg/h tilt it by 3 deg, and turns are shorter.
constexpr double kUpMemory = 20;
constexpr double kSpacing = 0.95;  // [s] between fixes, 1 s but for jitter
constexpr double kLongest = 2.5;   // [s]; chosen
/// [m/s^2], of the force beside what fixes make it; chosen: roads tilt it by a degree or two.
constexpr double kForceError = 0.3;
constexpr double kWaySigmas = 7;        // of the way that gives the course, to 0.2 rad
constexpr double kLargestForce = 20;    // [m/s^2]; chosen: more is an outlier of the fixes
constexpr int64_t kEnoughSamples = 12;  // for five unknowns
/// The best of 100 offsets, a third of them on their own, at both hands, is by chance above
/// 4 / sqrt(n) once in 100000 times.
constexpr double kChance = 4;
/// Ratio of what is left. At an offset of a second turns to either side fit from the other side
/// too, a field's rows to 0.9.
constexpr double kClearly = 0.25;

}  // namespace

AccelerationMatch::AccelerationMatch(const Eigen::Quaterniond& q_v_b)
    : q_v_b_(q_v_b), sums_(static_cast<std::size_t>(2 * std::lround(kLongestOffset / kStep) + 1)) {}

double AccelerationMatch::seconds(int64_t t_ns) const { return seconds_between(*start_ns_, t_ns); }

void AccelerationMatch::restart(int64_t t_ns) {
  start_ns_ = t_ns;
  if (!first_ns_) first_ns_ = t_ns;
  now_ = Motion();
  motions_.assign(1, now_);
  first_motion_ = 0;
  before_.reset();
  last_.reset();
  waiting_.clear();
}

void AccelerationMatch::add(const ImuIncrement& increment) {
  const bool hole = last_ns_ && seconds_between(*last_ns_, increment.t_begin_ns) > kLongestMissing;
  if (!last_ns_ || hole) restart(increment.t_begin_ns);
  last_ns_ = increment.t_end_ns;
  const double dt = increment.dt();
  up_memory_ = std::min(up_memory_ + dt, kUpMemory);
  up_b_ = so3::exp(-increment.dtheta_b) * up_b_;
  up_b_ += dt / up_memory_ * (increment.dvel_b / dt - up_b_);
  move(increment);
  const double margin = kLongestOffset + 2 * kGrid;
  while (!waiting_.empty() && seconds_between(waiting_.front().b.t_ns, *last_ns_) > margin) {
    compare(waiting_.front());
    waiting_.pop_front();
  }
}

/// Level is the plane across up; forward in it is that of v.
void AccelerationMatch::move(const ImuIncrement& increment) {
  const double dt = increment.dt();
  const Vector3d down = -up_b_.normalized();
  const Vector3d given = q_v_b_.conjugate() * Vector3d::UnitX();
  const Vector3d forward = (given - given.dot(down) * down).normalized();
  const Vector3d right = down.cross(forward);
  const double turn = down.dot(increment.dtheta_b);
  const Complex force(forward.dot(increment.dvel_b) / dt, right.dot(increment.dvel_b) / dt);
  const Complex acceleration = std::polar(1.0, now_.turn + turn / 2) * force;
  const Motion begin = now_;
  const auto after = [&](double h) {
    return Motion{begin.turn + turn * h / dt, begin.velocity + h * acceleration,
                  begin.position + h * begin.velocity + h * h / 2 * acceleration};
  };
  const double begin_s = seconds(increment.t_begin_ns), end_s = seconds(increment.t_end_ns);
  while (true) {
    const double next_s =
        kGrid * static_cast<double>(first_motion_ + static_cast<int64_t>(motions_.size()));
    if (next_s > end_s) break;
    motions_.push_back(after(std::clamp(next_s - begin_s, 0.0, dt)));
  }
  now_ = after(dt);
  const std::size_t most = static_cast<std::size_t>((2 * kLongestOffset + 4 * kLongest) / kGrid);
  while (motions_.size() > most) {
    motions_.pop_front();
    ++first_motion_;
  }
}

void AccelerationMatch::add(const GnssFix& fix) {
  if (!fix.position_covariance.allFinite() || !is_position(fix.antenna)) return;
  if (last_ && seconds_between(last_->t_ns, fix.t_ns) < kSpacing) return;
  const auto follows = [](const std::optional<GnssFix>& one, const GnssFix& other) {
    return one && seconds_between(one->t_ns, other.t_ns) < kLongest;
  };
  if (follows(last_, fix) && follows(before_, *last_)) waiting_.push_back({*before_, *last_, fix});
  before_ = last_;
  last_ = fix;
}

std::optional<AccelerationMatch::Motion> AccelerationMatch::motion_at(double t_s) const {
  const double place = t_s / kGrid - static_cast<double>(first_motion_);
  if (place < 0 || place >= static_cast<double>(motions_.size()) - 1) return std::nullopt;
  const std::size_t i = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(i), h = share * kGrid;
  const Motion& one = motions_[i];
  const Motion& other = motions_[i + 1];
  const Complex change = other.velocity - one.velocity;
  return Motion{one.turn + share * (other.turn - one.turn), one.velocity + share * change,
                one.position + h * one.velocity + h * share / 2 * change};
}

/// Second difference of the antenna's positions by the IMU, in axes at the middle, turned to the
/// course of the antenna, which swings aside.
std::optional<AccelerationMatch::Complex> AccelerationMatch::force_at(const Triple& triple,
                                                                      double offset,
                                                                      const Complex& arm,
                                                                      double way) const {
  const double ta = seconds(triple.a.t_ns), tm = seconds(triple.m.t_ns),
               tb = seconds(triple.b.t_ns);
  const std::optional<Motion> a = motion_at(ta + offset), m = motion_at(tm + offset),
                              b = motion_at(tb + offset);
  if (!a || !m || !b) return std::nullopt;
  const auto antenna = [&](const Motion& motion) {
    return motion.position + std::polar(1.0, motion.turn) * arm;
  };
  const Complex difference =
      (antenna(*b) - antenna(*m)) / (tb - tm) - (antenna(*m) - antenna(*a)) / (tm - ta);
  const auto swing = [&](const Motion& motion) {
    return std::imag(std::polar(1.0, motion.turn - m->turn) * arm) / way;
  };
  const double aside = std::asin(std::clamp(swing(*b) - swing(*a), -1.0, 1.0));
  return std::polar(1.0, -m->turn - aside) * 2.0 / (tb - ta) * difference;
}

/// What is left of the acceleration where up follows the force, in axes that do not turn.
AccelerationMatch::Complex AccelerationMatch::without_slow(const Complex& acceleration,
                                                           const Triple& triple) {
  const double dt = seconds_between(triple.m.t_ns, triple.b.t_ns);
  const double memory = std::min(seconds_between(*first_ns_, triple.b.t_ns), kUpMemory);
  const Complex left = acceleration - slow_;
  slow_ += std::min(1.0, dt / memory) * left;
  return left;
}

/// All offsets or none, so that they rest on the same samples.
void AccelerationMatch::compare(const Triple& triple) {
  const geodesy::LocalFrame frame(triple.m.antenna);
  const Vector3d to_a = frame.to_local(triple.a.antenna), to_b = frame.to_local(triple.b.antenna);
  const double sigma = geodesy::horizontal_sigma(triple.m.position_covariance);
  const Complex way(to_b.x() - to_a.x(), to_b.y() - to_a.y());
  const double h1 = seconds_between(triple.a.t_ns, triple.m.t_ns);
  const double h2 = seconds_between(triple.m.t_ns, triple.b.t_ns);
  const Complex a_n =
      2 / (h1 + h2) * (Complex(to_b.x(), to_b.y()) / h2 + Complex(to_a.x(), to_a.y()) / h1);
  if (std::abs(a_n) > kLargestForce) return;
  const Complex left = without_slow(a_n, triple);
  if (std::abs(way) < kWaySigmas * sigma || !(std::abs(way) > 0)) return;
  const Complex acceleration = left * std::abs(way) / way;
  const Vector3d arm_v = q_v_b_ * triple.m.p_b_a;
  std::vector<Complex> forces;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const double offset = kStep * static_cast<double>(i) - kLongestOffset;
    const std::optional<Complex> force =
        force_at(triple, offset, {arm_v.x(), arm_v.y()}, std::abs(way));
    if (!force) return;
    forces.push_back(*force);
  }
  const double of_fixes = std::sqrt(6.0) * sigma / (h1 * h2);
  const double weight = 1 / (of_fixes * of_fixes + kForceError * kForceError);
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    Sums& s = sums_[i];
    s.f += weight * forces[i];
    s.af += weight * acceleration * forces[i];
    s.afc += weight * acceleration * std::conj(forces[i]);
    s.ff += weight * std::norm(forces[i]);
  }
  weight_ += weight;
  a_ += weight * acceleration;
  aa_ += weight * std::norm(acceleration);
  ++samples_;
}

/// Least squares; mirrored, the force is its conjugate.
AccelerationMatch::Fit AccelerationMatch::fit(const Sums& s, bool mirrored) const {
  const double aa = aa_ - std::norm(a_) / weight_, ff = s.ff - std::norm(s.f) / weight_;
  const Complex af = mirrored ? s.af - a_ * s.f / weight_ : s.afc - a_ * std::conj(s.f) / weight_;
  if (!(ff > 0)) return {aa, 0};
  return {aa - std::norm(af) / ff, af / ff};
}

std::optional<AccelerationFit> AccelerationMatch::best() const {
  if (samples_ < kEnoughSamples) return std::nullopt;
  const double aa = aa_ - std::norm(a_) / weight_;
  const auto least_of = [&](bool mirrored) {
    std::size_t least = 1;
    for (std::size_t i = 1; i + 1 < sums_.size(); ++i) {
      if (fit(sums_[i], mirrored).residual < fit(sums_[least], mirrored).residual) least = i;
    }
    return least;
  };
  const std::size_t straight = least_of(false), turned_over = least_of(true);
  AccelerationFit result;
  result.samples = samples_;
  const double of_straight = fit(sums_[straight], false).residual;
  const double of_mirrored = fit(sums_[turned_over], true).residual;
  result.mirrored = of_mirrored < of_straight;
  const std::size_t index = result.mirrored ? turned_over : straight;
  const Fit at = fit(sums_[index], result.mirrored);
  const double n = static_cast<double>(samples_);
  result.correlation = std::sqrt(std::max(0.0, 1 - at.residual / aa));
  if (result.correlation < kChance / std::sqrt(n)) return std::nullopt;
  const double of_other = std::max(of_mirrored, of_straight);
  result.is_side_known =
      of_other - at.residual > 2 * kChance * kChance * at.residual / (2 * n - 5) &&
      at.residual < kClearly * of_other;
  const double variance = at.residual / (2 * n - 5);
  const double left = fit(sums_[index - 1], result.mirrored).residual;
  const double right = fit(sums_[index + 1], result.mirrored).residual;
  const double curvature = left - 2 * at.residual + right;
  result.offset_s = {kStep * static_cast<double>(index) - kLongestOffset, kLongestOffset};
  if (curvature > 0) {
    result.offset_s.value += kStep * std::clamp((left - right) / (2 * curvature), -0.5, 0.5);
    result.offset_s.sigma = std::min(kLongestOffset, kStep * std::sqrt(2 * variance / curvature));
  }
  const double ff = sums_[index].ff - std::norm(sums_[index].f) / weight_;
  result.angle = {-std::arg(at.per_force), std::sqrt(variance / ff) / std::abs(at.per_force)};
  return result;
}

}  // namespace foucault::diagnosis
