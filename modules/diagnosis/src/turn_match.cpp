#include "foucault/diagnosis/turn_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/position.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {
namespace {

constexpr double kGrid = 0.02;        // [s] of the turns: 50 Hz, no vehicle turns faster
constexpr double kLargestHole = 0.1;  // [s], in which a turn may be missed: 6 deg at kFastestTurn
constexpr double kUpMemory = 20;      // [s]; chosen: longer than a bend or an acceleration
/// A way of 15 sigmas has a course to 0.1 rad, a tenth of a bend. That by way and time is chosen.
constexpr double kWaySigmas = 15;
constexpr double kShortestWay = 2;        // [m]
constexpr double kShortestCourse = 0.45;  // [s], of fixes at 2 Hz with jitter
constexpr double kLongestCourse = 4;      // [s]
constexpr double kSlowest = 3;            // [m/s]: slower vehicles swerve and stop
constexpr double kLongestChange = 6;      // [s] between courses
constexpr double kFastestTurn = 1;        // [rad/s]; chosen: faster are outliers of the fixes
/// Recordings of cars with good clocks have 0.998, an aerobatic flight, whose courses are those of
/// no bend, 0.89.
constexpr double kAgree = 0.9;
constexpr double kGentle = 2;           // [m/s^2], speed times turn rate: tan(12 deg) of gravity
constexpr double kEnoughTurn = 1.5708;  // [rad]; chosen: a bend, in courses that tell it to 0.02
constexpr int64_t kEnoughSamples = 20;

/// Data sheets of the cheapest gyroscopes promise 3 % (MPU-6050); what slip, roads and the bias add
/// is in the sigma or stays below as much again. Twenty are no gyroscope's.
bool scale_is_wrong(const MeasuredFactor& factor) {
  constexpr double kLargestError = 0.2, kSure = 5;  // sigmas
  return std::abs(factor.value - 1) > kLargestError + kSure * factor.sigma;
}

}  // namespace

TurnMatcher::TurnMatcher(double longest_s, double step_s)
    : longest_s_(longest_s),
      step_s_(step_s),
      sums_(static_cast<std::size_t>(2 * std::lround(longest_s / step_s) + 1)) {}

double TurnMatcher::seconds(int64_t t_ns) const { return seconds_between(*start_ns_, t_ns); }

void TurnMatcher::restart(int64_t t_ns) {
  start_ns_ = t_ns;
  turns_.assign(1, 0.0);
  first_turn_ = 0;
  turn_ = 0;
  anchor_.reset();
  last_course_.reset();
  waiting_.clear();
}

void TurnMatcher::add(const ImuIncrement& increment) {
  const double dt = increment.dt();
  up_memory_ = std::min(up_memory_ + dt, kUpMemory);
  up_b_ += dt / up_memory_ * (increment.dvel_b / dt - up_b_);
  const bool hole = last_ns_ && seconds_between(*last_ns_, increment.t_begin_ns) > kLargestHole;
  if (!last_ns_ || hole) restart(increment.t_begin_ns);
  last_ns_ = increment.t_end_ns;
  const double begin = turn_;
  turn_ -= up_b_.normalized().dot(increment.dtheta_b);
  const double end_s = seconds(increment.t_end_ns);
  while (true) {
    const double next_s =
        kGrid * static_cast<double>(first_turn_ + static_cast<int64_t>(turns_.size()));
    if (next_s > end_s) break;
    const double share = std::clamp(1 - (end_s - next_s) / dt, 0.0, 1.0);
    turns_.push_back(begin + share * (turn_ - begin));
  }
  const std::size_t most = static_cast<std::size_t>((2 * longest_s_ + 4 * kLongestChange) / kGrid);
  while (turns_.size() > most) {
    turns_.pop_front();
    ++first_turn_;
  }
  compare_ripe();
}

void TurnMatcher::add(const GnssFix& fix) {
  if (!fix.position_covariance.allFinite() || !is_position(fix.antenna)) return;
  if (!anchor_ || seconds_between(anchor_->t_ns, fix.t_ns) > kLongestCourse ||
      fix.t_ns <= anchor_->t_ns) {
    anchor_ = fix;
    last_course_.reset();
    return;
  }
  const Eigen::Vector3d way = geodesy::LocalFrame(anchor_->antenna).to_local(fix.antenna);
  const double length = way.head<2>().norm();
  const double sigma = geodesy::horizontal_sigma(fix.position_covariance);
  const double dt = seconds_between(anchor_->t_ns, fix.t_ns);
  if (length < std::max(kShortestWay, kWaySigmas * sigma) || dt < kShortestCourse) return;
  const Course course{anchor_->t_ns + (fix.t_ns - anchor_->t_ns) / 2, geodesy::azimuth(way),
                      length / dt};
  anchor_ = fix;
  if (course.speed < kSlowest) {
    last_course_.reset();
    return;
  }
  if (last_course_ && seconds_between(last_course_->t_ns, course.t_ns) < kLongestChange) {
    waiting_.push_back({*last_course_, course});
  }
  last_course_ = course;
}

std::optional<double> TurnMatcher::turned_at(double t_s) const {
  const double place = t_s / kGrid - static_cast<double>(first_turn_);
  if (place < 0 || place >= static_cast<double>(turns_.size()) - 1) return std::nullopt;
  const std::size_t i = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(i);
  return (1 - share) * turns_[i] + share * turns_[i + 1];
}

/// Those whose latest offset the IMU has reached.
void TurnMatcher::compare_ripe() {
  const double margin = longest_s_ + 2 * kGrid;
  while (!waiting_.empty() && seconds_between(waiting_.front().after.t_ns, *last_ns_) > margin) {
    compare(waiting_.front());
    waiting_.pop_front();
  }
}

/// All offsets or none, so that they rest on the same samples.
void TurnMatcher::compare(const Change& change) {
  const double t0 = seconds(change.before.t_ns), t1 = seconds(change.after.t_ns);
  const double edge = longest_s_ + kGrid;
  if (!turned_at(t0 - edge) || !turned_at(t1 + edge)) return;
  const double y = so3::wrap(change.after.course - change.before.course);
  if (std::abs(y) > kFastestTurn * (t1 - t0)) return;
  const double speed = std::max(change.before.speed, change.after.speed);
  const bool gentle = speed * std::abs(y) < kGentle * (t1 - t0);
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const double offset = step_s_ * static_cast<double>(i) - longest_s_;
    const double x = *turned_at(t1 + offset) - *turned_at(t0 + offset);
    Sums& s = sums_[i];
    s.xx += x * x;
    s.xy += x * y;
    if (!gentle) continue;
    s.gentle_xx += x * x;
    s.gentle_xy += x * y;
  }
  yy_ += y * y;
  if (gentle) {
    gentle_yy_ += y * y;
    ++gentle_samples_;
  }
  turned_ += std::abs(y);
  ++samples_;
}

/// y = a x by least squares.
TurnMatcher::Fit TurnMatcher::fit(const Sums& s) const {
  if (!(s.xx > 0)) return {0, yy_};
  const double a = s.xy / s.xx;
  return {a, yy_ - a * s.xy};
}

/// The gyroscopes' turn per the course's is 1/a, with the sigma that the residuals of y = a x
/// leave.
std::optional<MeasuredFactor> TurnMatcher::gentle_factor(const Sums& s) const {
  if (gentle_samples_ < kEnoughSamples || !(s.gentle_xy > 0)) return std::nullopt;
  const double a = s.gentle_xy / s.gentle_xx;
  const double residual = std::max(0.0, gentle_yy_ - a * s.gentle_xy);
  const double variance = residual / static_cast<double>(gentle_samples_ - 1) / s.gentle_xx;
  return MeasuredFactor{1 / a, std::sqrt(variance) / (a * a), gentle_samples_};
}

std::optional<TurnMatch> TurnMatcher::best() const {
  if (samples_ < kEnoughSamples || turned_ < kEnoughTurn) return std::nullopt;
  std::vector<Fit> fits;
  for (const Sums& sums : sums_) fits.push_back(fit(sums));
  const auto least = std::min_element(fits.begin() + 1, fits.end() - 1,
                                      [](auto& a, auto& b) { return a.residual < b.residual; });
  const double left = (least - 1)->residual, middle = least->residual,
               right = (least + 1)->residual;
  const double curvature = left - 2 * middle + right;
  TurnMatch match;
  match.samples = samples_;
  match.turned = turned_;
  match.slope = least->turn != 0 ? 1 / least->turn : 0;
  match.correlation = std::copysign(std::sqrt(std::max(0.0, 1 - middle / yy_)), least->turn);
  match.offset_s = step_s_ * static_cast<double>(least - fits.begin()) - longest_s_;
  match.gyro_factor = gentle_factor(sums_[static_cast<std::size_t>(least - fits.begin())]);
  match.residual_share = middle / fits[fits.size() / 2].residual;
  if (curvature > 0) {
    match.offset_s += step_s_ * std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5);
    const double noise = middle / static_cast<double>(samples_ - 2);
    match.offset_sigma_s = step_s_ * std::sqrt(2 * noise / curvature);
  }
  return match;
}

std::optional<std::string> wrong_rates(const TurnMatch& match) {
  if (match.correlation < kAgree) return std::nullopt;
  const double in_degrees = match.slope * kDegree;
  if (std::abs(in_degrees - 1) < 0.2) {
    return std::string("angular rates are in deg/s, not rad/s; name the unit in the import");
  }
  if (std::abs(match.slope / kDegree - 1) < 0.2) {
    return std::string(
        "angular rates are pi/180 of those of the course, converted to radians "
        "twice; correct the unit in the import");
  }
  if (match.gyro_factor && scale_is_wrong(*match.gyro_factor)) {
    return fmt::format(
        "the gyroscopes turn {:.3f} (sigma {:.3f}) times as much as the course of GNSS, and no "
        "gyroscope's scale factor is so far off; correct unit or scale in the import",
        match.gyro_factor->value, match.gyro_factor->sigma);
  }
  return std::nullopt;
}

std::optional<std::string> gross_mismatch(const TurnMatch& match, int64_t t_ns) {
  constexpr double kGrossOffset = 1;  // [s]
  if (std::abs(match.correlation) < kAgree) return std::nullopt;
  if (match.correlation < 0) {
    return std::string(
        "the gyroscopes turn against the course of GNSS; their axes are wrong, correct the axes of "
        "the import (imu.axes of the mapping, or the sensorPose)");
  }
  if (const std::optional<std::string> wrong = wrong_rates(match)) return wrong;
  constexpr double kClearly = 0.25;
  if (std::abs(match.offset_s) < kGrossOffset || match.residual_share > kClearly) {
    return std::nullopt;
  }
  const double leap = gps_utc_offset_s(t_ns);
  const bool is_leap = std::abs(std::abs(match.offset_s) - leap) < 0.5;
  return fmt::format(
      "stamps of the IMU are {:.2f} s {} those of GNSS{}; correct time.system or time.offset_s in "
      "the import",
      std::abs(match.offset_s), match.offset_s > 0 ? "after" : "before",
      is_leap ? fmt::format(", as GPS time ({:.0f} s ahead) is of UTC", leap) : "");
}

}  // namespace foucault::diagnosis
