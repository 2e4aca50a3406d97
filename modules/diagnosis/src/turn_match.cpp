#include "foucault/diagnosis/turn_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/position.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/diagnosis/missing.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {
namespace {

constexpr double kGrid = 0.02;    // [s] of the turns: 50 Hz, no vehicle turns faster
constexpr double kUpMemory = 20;  // [s]; chosen: longer than a bend or an acceleration
/// A way of 15 sigmas has a course to 0.1 rad, a tenth of a bend. That by way and time is chosen.
constexpr double kWaySigmas = 15;
constexpr double kShortestWay = 2;        // [m]
constexpr double kShortestCourse = 0.45;  // [s], of fixes at 2 Hz with jitter
constexpr double kLongestCourse = 4;      // [s]
constexpr double kLongestChange = 6;      // [s] between courses
/// That headings by gyroscopes and courses walk apart [rad/s], by bias, tilt and slip: from 0.01 to
/// 0.05 recordings of cars tell the same offset with the least sigma.
constexpr double kWalk = 0.02;
constexpr double kFastestTurn = 1;    // [rad/s]; chosen: faster are outliers of the fixes
constexpr double kLargestChange = 2;  // [rad]; chosen: more is a vehicle that changes direction
/// Of a course beside what fixes make it [rad]: slip, roads, speeds that change on the way. What
/// is left of changes in recordings of cars with centimetres is 0.02 to 0.03.
constexpr double kCourseError = 0.02;
/// Of the distance between the IMU and the axle that does not steer [m]; chosen: it is in the boot,
/// under a seat or on the roof.
constexpr double kArmSigma = 1.5;
/// Recordings of cars with good clocks have 0.998, an aerobatic flight, whose courses are those of
/// no bend, 0.89.
constexpr double kAgree = 0.9;
/// Ratio of residuals. By chance 20 courses leave a quarter once in 1000 times.
constexpr double kClearly = 0.25;
constexpr double kGentle = 2;          // [m/s^2], speed times turn rate: tan(12 deg) of gravity
constexpr double kEnoughTurn = 0.5;    // [rad]; chosen: half a bend; how well it tells is in sigmas
constexpr int64_t kEnoughSamples = 8;  // for three unknowns
constexpr int64_t kEnoughGentle = 20;
constexpr std::size_t kMostParts = 16;  // chosen: even, and a line through eight is a drift
constexpr std::size_t kFewestParts = 4;
constexpr int64_t kPartSize = 20;  // samples, at first

/// Data sheets of the cheapest gyroscopes promise 3 % (MPU-6050); what slip, roads and the bias add
/// is in the sigma or stays below as much again. Twenty are no gyroscope's.
bool scale_is_wrong(const MeasuredFactor& factor) {
  constexpr double kLargestError = 0.2, kSure = 5;  // sigmas
  return std::abs(factor.value - 1) > kLargestError + kSure * factor.sigma;
}

double residual_of(const Eigen::Matrix3d& moments, const Eigen::Vector2d& fit) {
  const Eigen::Vector3d row(-fit.x(), -fit.y(), 1);
  return std::max(0.0, row.dot(moments * row));
}

}  // namespace

void TurnMatcher::Part::add(const Part& other) {
  for (std::size_t i = 0; i < all.size(); ++i) all[i] += other.all[i];
  weight += other.weight;
  weighted_time += other.weighted_time;
}

TurnMatcher::TurnMatcher(double longest_s, double step_s, const Eigen::Quaterniond& q_v_b)
    : longest_s_(longest_s),
      step_s_(step_s),
      q_v_b_(q_v_b),
      offsets_(static_cast<std::size_t>(2 * std::lround(longest_s / step_s) + 1)),
      part_size_(kPartSize),
      gentle_(offsets_, Moments::Zero()) {}

double TurnMatcher::seconds(int64_t t_ns) const { return seconds_between(*start_ns_, t_ns); }

void TurnMatcher::restart(int64_t t_ns) {
  start_ns_ = t_ns;
  if (!first_ns_) first_ns_ = t_ns;
  turns_.assign(1, 0.0);
  areas_.assign(1, 0.0);
  first_turn_ = 0;
  turn_ = 0;
  anchor_.reset();
  waiting_.clear();
  level_.last.reset();
}

void TurnMatcher::add(const ImuIncrement& increment) {
  const double dt = increment.dt();
  up_memory_ = std::min(up_memory_ + dt, kUpMemory);
  up_b_ += dt / up_memory_ * (increment.dvel_b / dt - up_b_);
  const bool hole = last_ns_ && seconds_between(*last_ns_, increment.t_begin_ns) > kLongestMissing;
  if (!last_ns_ || hole) restart(increment.t_begin_ns);
  last_ns_ = increment.t_end_ns;
  const double begin = turn_;
  turn_ -= up_b_.normalized().dot(increment.dtheta_b);
  extend_turns(begin, dt, seconds(increment.t_end_ns));
  compare_ripe();
}

/// To the end of an increment, over which the turn grows from `begin` to turn_.
void TurnMatcher::extend_turns(double begin, double dt, double end_s) {
  while (true) {
    const double next_s =
        kGrid * static_cast<double>(first_turn_ + static_cast<int64_t>(turns_.size()));
    if (next_s > end_s) break;
    const double share = std::clamp(1 - (end_s - next_s) / dt, 0.0, 1.0);
    const double turn = begin + share * (turn_ - begin);
    areas_.push_back(areas_.back() + kGrid / 2 * (turns_.back() + turn));
    turns_.push_back(turn);
  }
  const std::size_t most = static_cast<std::size_t>((2 * longest_s_ + 4 * kLongestChange) / kGrid);
  while (turns_.size() > most) {
    turns_.pop_front();
    areas_.pop_front();
    ++first_turn_;
  }
}

void TurnMatcher::add(const GnssFix& fix) {
  if (!fix.position_covariance.allFinite() || !is_position(fix.antenna)) return;
  if (!anchor_ || seconds_between(anchor_->t_ns, fix.t_ns) > kLongestCourse ||
      fix.t_ns <= anchor_->t_ns) {
    anchor_ = fix;
    return;
  }
  const Eigen::Vector3d way = geodesy::LocalFrame(anchor_->antenna).to_local(fix.antenna);
  const double length = way.head<2>().norm();
  const double sigma = geodesy::horizontal_sigma(fix.position_covariance);
  const double dt = seconds_between(anchor_->t_ns, fix.t_ns);
  if (length < std::max(kShortestWay, kWaySigmas * sigma) || dt < kShortestCourse) return;
  const double before = geodesy::horizontal_sigma(anchor_->position_covariance);
  const double variance =
      (sigma * sigma + before * before) / (length * length) + kCourseError * kCourseError;
  const Eigen::Vector2d arm = (q_v_b_ * fix.p_b_a).head<2>();
  waiting_.push_back({anchor_->t_ns, fix.t_ns, geodesy::azimuth(way), length, variance, 0, arm});
  anchor_ = fix;
}

bool TurnMatcher::has_turns(double t0_s, double t1_s) const {
  const double begin = kGrid * static_cast<double>(first_turn_);
  const double end = begin + kGrid * static_cast<double>(turns_.size() - 1);
  return t0_s >= begin && t1_s < end;
}

double TurnMatcher::turned_at(double t_s) const {
  const double place = t_s / kGrid - static_cast<double>(first_turn_);
  const std::size_t i = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(i);
  return (1 - share) * turns_[i] + share * turns_[i + 1];
}

double TurnMatcher::turn_area_at(double t_s) const {
  const double place = t_s / kGrid - static_cast<double>(first_turn_);
  const std::size_t i = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(i);
  return areas_[i] + kGrid * share * (turns_[i] + share / 2 * (turns_[i + 1] - turns_[i]));
}

/// The way of the antenna is that of the IMU, along the mean heading, and the swing
/// R(end) l - R(begin) l, of which the part across turns the course.
TurnMatcher::Row TurnMatcher::row_of(const Course& course, double offset) const {
  constexpr double kMost = 0.9;  // of the way: more is no way
  const double t0 = seconds(course.begin_ns) + offset, t1 = seconds(course.end_ns) + offset;
  const double mean = (turn_area_at(t1) - turn_area_at(t0)) / (t1 - t0);
  const double begin = turned_at(t0) - mean, end = turned_at(t1) - mean;
  const double later = course.speed_change / 12 * (end - begin);  // the faster part counts more
  const double forward = (std::sin(end) - std::sin(begin)) / course.length;
  const double right = (std::cos(end) - std::cos(begin)) / course.length;
  const double swing = std::clamp(course.arm.x() * forward + course.arm.y() * right, -kMost, kMost);
  const double per_arm = forward / std::sqrt(1 - swing * swing);
  return {mean + later, per_arm, course.course - std::asin(swing)};
}

/// Those whose latest offset the IMU has reached.
void TurnMatcher::compare_ripe() {
  const double margin = longest_s_ + 2 * kGrid;
  while (waiting_.size() > 1 && seconds_between(waiting_.front().end_ns, *last_ns_) > margin) {
    set_speed_change();
    compare(waiting_.front());
    waiting_.pop_front();
  }
}

/// Of the first that waits, by its neighbours.
void TurnMatcher::set_speed_change() {
  constexpr double kMost = 2;  // from rest, or to it
  Course& course = waiting_.front();
  const Course& next = waiting_[1];
  if (!level_.last || level_.last->end_ns != course.begin_ns || next.begin_ns != course.end_ns) {
    return;
  }
  const double dt = seconds_between(level_.last->middle_ns(), next.middle_ns());
  const double change = (next.speed() - level_.last->speed()) / dt * course.seconds();
  course.speed_change = std::clamp(change / course.speed(), -kMost, kMost);
}

/// All offsets or none, so that they rest on the same samples.
void TurnMatcher::compare(const Course& course) {
  const double edge = longest_s_ + kGrid;
  if (!has_turns(seconds(course.begin_ns) - edge, seconds(course.end_ns) + edge)) {
    return level_.last.reset();
  }
  if (!level_.last || level_.last->end_ns != course.begin_ns) return start_level(course);
  const double turn = std::abs(so3::wrap(course.course - level_.last->course));
  const double dt = seconds_between(level_.last->middle_ns(), course.middle_ns());
  if (turn > std::min(kLargestChange, kFastestTurn * dt)) return start_level(course);
  add_innovations(course, turn, dt);
}

void TurnMatcher::start_level(const Course& course) {
  level_.rows.resize(offsets_);
  level_.courses.resize(offsets_);
  for (std::size_t i = 0; i < offsets_; ++i) {
    level_.rows[i] = row_of(course, offset_of(i));
    level_.courses[i] = level_.rows[i][kCourse];
  }
  level_.variance = course.variance;
  level_.last = course;
}

/// One Kalman update of a walk; all offsets and columns have its gain.
void TurnMatcher::add_innovations(const Course& course, double turn, double dt) {
  level_.variance += kWalk * kWalk * dt * dt;
  const double weight = 1 / (level_.variance + course.variance);
  const double gain = level_.variance * weight;
  const double speed = std::max(level_.last->speed(), course.speed());
  const bool gentle = speed * turn < kGentle * dt;
  Part& part = part_for_next();
  for (std::size_t i = 0; i < offsets_; ++i) {
    Row row = row_of(course, offset_of(i));
    level_.courses[i] += so3::wrap(row[kCourse] - level_.courses[i]);
    row[kCourse] = level_.courses[i];
    const Row innovation = row - level_.rows[i];
    level_.rows[i] += gain * innovation;
    const Moments moments = weight * innovation * innovation.transpose();
    part.all[i] += moments;
    if (gentle) gentle_[i] += moments;
  }
  level_.variance *= 1 - gain;
  level_.last = course;
  part.weight += weight * turn * turn;
  part.weighted_time += weight * turn * turn * seconds_between(*first_ns_, course.middle_ns());
  if (gentle) ++gentle_samples_;
  turned_ += turn;
  ++samples_;
}

/// Parts of the same size; when all are full, two become one.
TurnMatcher::Part& TurnMatcher::part_for_next() {
  if (samples_ == part_size_ * static_cast<int64_t>(kMostParts)) {
    for (std::size_t i = 0; i < kMostParts / 2; ++i) {
      parts_[2 * i].add(parts_[2 * i + 1]);
      if (i > 0) parts_[i] = std::move(parts_[2 * i]);
    }
    parts_.resize(kMostParts / 2);
    part_size_ *= 2;
  }
  if (samples_ == part_size_ * static_cast<int64_t>(parts_.size())) {
    parts_.push_back({std::vector<Moments>(offsets_, Moments::Zero()), 0, 0});
  }
  return parts_.back();
}

TurnMatcher::Part TurnMatcher::whole() const {
  Part sum{std::vector<Moments>(offsets_, Moments::Zero()), 0, 0};
  for (const Part& part : parts_) sum.add(part);
  return sum;
}

/// Least squares with the prior of the arm. `variance`: of what is left, at unit weight.
TurnMatcher::Fit TurnMatcher::fit(const Moments& m, double variance) const {
  Eigen::Matrix2d information = m.topLeftCorner<2, 2>();
  information(kArm, kArm) += variance / (kArmSigma * kArmSigma);
  const double determinant = information.determinant();
  Fit fit;
  fit.residual = m(kCourse, kCourse);
  if (!(determinant > 0)) return fit;
  const Eigen::Matrix2d covariance = information.inverse();
  const Eigen::Vector2d b = m.topRightCorner<2, 1>();
  fit.value = covariance * b;
  fit.residual = std::max(0.0, m(kCourse, kCourse) - b.dot(fit.value));
  const double turns =
      std::sqrt(m(kTurn, kTurn) * residual_of(m, Eigen::Vector2d(0, fit.value[kArm])));
  if (turns > 0) fit.correlation = (b[kTurn] - m(kTurn, kArm) * fit.value[kArm]) / turns;
  fit.arm_variance = covariance(kArm, kArm);
  return fit;
}

/// Of the offsets at which the two turn along, or against, each other; but for the first and last.
std::size_t TurnMatcher::best_index(const std::vector<Fit>& fits, bool along) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i + 1 < fits.size(); ++i) {
    if (fits[i].along() != along) continue;
    if (best == 0 || fits[i].residual < fits[best].residual) best = i;
  }
  return best;
}

/// Turns to both sides look alike from the other side after a while, so turns along the course are
/// left only for what is clearly better.
std::size_t TurnMatcher::best_index(const std::vector<Fit>& fits) const {
  const std::size_t along = best_index(fits, true), against = best_index(fits, false);
  if (along == 0 || against == 0) return std::max<std::size_t>(1, along + against);
  return fits[against].residual < kClearly * fits[along].residual ? against : along;
}

/// The parabola about a minimum of the residuals.
Measured TurnMatcher::offset_near(std::size_t index, const std::vector<double>& residuals,
                                  double variance) const {
  Measured offset{offset_of(index), longest_s_};
  const double left = residuals[index - 1], right = residuals[index + 1];
  const double curvature = left - 2 * residuals[index] + right;
  if (!(curvature > 0)) return offset;
  offset.value += step_s_ * std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5);
  offset.sigma = std::min(longest_s_, step_s_ * std::sqrt(2 * variance / curvature));
  return offset;
}

/// The gyroscopes' turn per the course's. Gusts turn an aircraft without its course, bad fixes a
/// course without the vehicle: the truth lies between the two regressions (Frisch's bounds), which
/// count as one sigma on either side beside what the residuals leave.
std::optional<MeasuredFactor> TurnMatcher::gentle_factor(const Moments& m, const Fit& fit) const {
  const double turns = m(kTurn, kTurn);
  const double courses = residual_of(m, Eigen::Vector2d(0, fit.value[kArm]));
  const double both = m(kTurn, kCourse) - m(kTurn, kArm) * fit.value[kArm];
  if (gentle_samples_ < kEnoughGentle || !(both > 0)) return std::nullopt;
  const double least = both / courses, most = turns / both;
  const double residual = residual_of(m, Eigen::Vector2d(1 / most, fit.value[kArm]));
  const double variance = residual / static_cast<double>(gentle_samples_ - 1) / turns;
  const double sigma = std::hypot(most * most * std::sqrt(variance), 0.5 * (most - least));
  return MeasuredFactor{std::sqrt(least * most), sigma, gentle_samples_};
}

/// A line through the offsets of the parts.
std::optional<Measured> TurnMatcher::drift(const Fit& fit, double variance) const {
  if (parts_.size() < kFewestParts) return std::nullopt;
  double n = 0, t = 0, tt = 0, o = 0, to = 0;
  for (const Part& part : parts_) {
    std::vector<double> residuals;
    for (const Moments& m : part.all) residuals.push_back(residual_of(m, fit.value));
    const auto least = std::min_element(residuals.begin() + 1, residuals.end() - 1);
    const Measured offset =
        offset_near(static_cast<std::size_t>(least - residuals.begin()), residuals, variance);
    const double weight = 1 / (offset.sigma * offset.sigma);
    const double time = part.weight > 0 ? part.weighted_time / part.weight : 0;
    n += weight;
    t += weight * time;
    tt += weight * time * time;
    o += weight * offset.value;
    to += weight * time * offset.value;
  }
  const double spread = tt - t * t / n;
  if (!(spread > 0)) return std::nullopt;
  return Measured{(to - t * o / n) / spread, std::sqrt(1 / spread)};
}

std::vector<TurnMatcher::Fit> TurnMatcher::fits(const Part& sums, double variance) const {
  std::vector<Fit> all;
  for (const Moments& m : sums.all) all.push_back(fit(m, variance));
  return all;
}

double TurnMatcher::variance_of(const Fit& fit) const {
  return fit.residual / static_cast<double>(samples_ - 3);
}

std::optional<TurnMatch> TurnMatcher::best() const {
  if (samples_ < kEnoughSamples || turned_ < kEnoughTurn) return std::nullopt;
  const Part sums = whole();
  const std::vector<Fit> first = fits(sums, 1);  // tells what the arm's prior is worth
  const std::vector<Fit> all = fits(sums, variance_of(first[best_index(first)]));
  const std::size_t index = best_index(all);
  const Fit& least = all[index];
  const double variance = variance_of(least);
  std::vector<double> residuals;
  for (const Fit& one : all) residuals.push_back(one.residual);
  const Measured offset = offset_near(index, residuals, variance);
  TurnMatch match;
  match.samples = samples_;
  match.turned = turned_;
  match.offset_s = offset.value;
  match.offset_sigma_s = offset.sigma;
  match.arm_m = {least.value[kArm], std::sqrt(least.arm_variance * variance)};
  match.slope = least.value[kTurn] != 0 ? 1 / least.value[kTurn] : 0;
  match.correlation = least.correlation;
  match.misfit = std::sqrt(variance);
  match.gyro_factor = gentle_factor(gentle_[index], least);
  match.drift = drift(least, variance);
  return match;
}

/// Part of a bend, or the ways of a copter, agree with anything at some offset.
bool TurnMatch::is_enough() const {
  constexpr int64_t kSamples = 40;
  constexpr double kTurn = 3.1;  // [rad]; chosen: half a turn in all
  return samples >= kSamples && turned >= kTurn;
}

namespace {

std::optional<std::string> wrong_unit(const TurnMatch& match) {
  const double in_degrees = match.slope * kDegree;
  if (std::abs(in_degrees - 1) < 0.2) {
    return std::string("angular rates are in deg/s, not rad/s; name the unit in the import");
  }
  if (std::abs(match.slope / kDegree - 1) < 0.2) {
    return std::string(
        "angular rates are pi/180 of those of the course, converted to radians twice or increments "
        "over a sample; correct the unit in the import");
  }
  return std::nullopt;
}

std::optional<std::string> wrong_scale(const TurnMatch& match) {
  if (!match.gyro_factor || !scale_is_wrong(*match.gyro_factor)) return std::nullopt;
  return fmt::format(
      "the gyroscopes turn {:.3f} (sigma {:.3f}) times as much as the course of GNSS, and no "
      "gyroscope's scale factor is so far off; correct unit or scale in the import",
      match.gyro_factor->value, match.gyro_factor->sigma);
}

}  // namespace

std::optional<std::string> gross_mismatch(const TurnMatch& match, int64_t t_ns) {
  constexpr double kGrossOffset = 1;  // [s]
  if (match.correlation < kAgree) return std::nullopt;
  if (const std::optional<std::string> wrong = wrong_unit(match)) return wrong;
  if (!match.is_enough()) return std::nullopt;
  if (const std::optional<std::string> wrong = wrong_scale(match)) return wrong;
  constexpr double kTurn = 6.3;  // [rad]; of so many offsets one agrees by chance with less
  if (std::abs(match.offset_s) < kGrossOffset) return std::nullopt;
  const double leap = gps_utc_offset_s(t_ns);
  const bool is_leap = std::abs(std::abs(match.offset_s) - leap) < 0.5;
  if (!is_leap && match.turned < kTurn) return std::nullopt;
  return fmt::format(
      "stamps of the IMU are {:.2f} s {} those of GNSS{}; correct time.system or time.offset_s in "
      "the import",
      std::abs(match.offset_s), match.offset_s > 0 ? "after" : "before",
      is_leap ? fmt::format(", as GPS time ({:.0f} s ahead) is of UTC", leap) : "");
}

}  // namespace foucault::diagnosis
