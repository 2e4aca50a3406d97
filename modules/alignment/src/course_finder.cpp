#include "course_finder.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::alignment {

namespace {

constexpr double kChord = 0.95;           // [s], shortest way for a course by positions
constexpr double kLongestChord = 2.5;     // [s]
constexpr double kVelocitySpacing = 0.5;  // [s], between courses by velocity
constexpr std::size_t kCourses = 3;       // that must agree
constexpr std::size_t kLongestRun = 10;
constexpr double kShortestRun = 2.8;          // [s]: three ways of a second
constexpr double kAgreement = 4;              // chi-square per degree of freedom
constexpr double kCrabSigma = 0.3 * kDegree;  // [rad], of a single course

Eigen::Vector3d forward_l(const LevelAttitude& attitude) {
  return attitude.q_l_b * attitude.forward_b;
}

/// Turn from a to b about the vertical [rad].
double turn(const LevelAttitude& a, const LevelAttitude& b) {
  return so3::wrap(geodesy::azimuth(forward_l(b)) - geodesy::azimuth(forward_l(a)));
}

}  // namespace

void CourseFinder::interrupt() {
  records_.clear();
  run_.clear();
}

std::optional<HeadingOffset> CourseFinder::add(const GnssFix& fix, const LevelAttitude& attitude) {
  best_quality_ = std::max(best_quality_, fix.quality);
  const Record record{fix, attitude};
  if (!continues(record)) interrupt();
  const std::optional<Course> course = course_to(record);
  records_.push_back(record);
  while (seconds_between(records_.front().fix.t_ns, fix.t_ns) > kLongestChord) {
    records_.pop_front();
  }
  if (!course) return std::nullopt;
  ++courses_;
  fastest_ = std::max(fastest_, course->speed);
  if (!acceptable(*course)) {
    run_.clear();
    return std::nullopt;
  }
  run_.push_back(*course);
  if (run_.size() > kLongestRun) run_.pop_front();
  return agreement();
}

/// Whether the run of good fixes goes on with this one.
bool CourseFinder::continues(const Record& record) const {
  if (record.fix.quality < best_quality_) return false;
  if (records_.empty()) return true;
  const Record& last = records_.back();
  const double dt = seconds_between(last.fix.t_ns, record.fix.t_ns);
  if (dt <= 0 || dt > kLongestChord || last.fix.quality != record.fix.quality) return false;
  // Twice the limit between neighbours, where vibration weighs more than over a whole course.
  return std::abs(turn(last.attitude, record.attitude)) <= 2 * limits_.max_turn_rate * dt;
}

bool CourseFinder::acceptable(const Course& course) const {
  return course.speed >= limits_.min_speed && course.sigma <= limits_.max_sigma &&
         std::abs(course.turn_rate) <= limits_.max_turn_rate;
}

std::optional<CourseFinder::Course> CourseFinder::course_to(const Record& record) const {
  const bool coarse =
      geodesy::horizontal_sigma(record.fix.position_covariance) > geodesy::kPreciseSigma;
  return coarse && record.fix.velocity_n ? course_by_velocity(record) : course_by_positions(record);
}

/// Course of the way since the latest fix that is a second old and not part of the last course.
/// The antenna's way is that of the IMU along the forward axis plus that of the turning lever arm.
std::optional<CourseFinder::Course> CourseFinder::course_by_positions(const Record& record) const {
  const auto begin = std::find_if(records_.rbegin(), records_.rend(), [&](const Record& earlier) {
    return seconds_between(earlier.fix.t_ns, record.fix.t_ns) >= kChord;
  });
  if (begin == records_.rend()) return std::nullopt;
  if (!run_.empty() && begin->fix.t_ns < run_.back().end_ns) return std::nullopt;

  const double dt = seconds_between(begin->fix.t_ns, record.fix.t_ns);
  const Eigen::Vector3d way_n =
      geodesy::LocalFrame(begin->fix.antenna).to_local(record.fix.antenna);
  const Eigen::Vector3d mean_forward_l =
      (forward_l(begin->attitude) + forward_l(record.attitude)).normalized();
  const Eigen::Vector3d lever_way_l =
      record.attitude.q_l_b * record.fix.p_b_a - begin->attitude.q_l_b * begin->fix.p_b_a;
  const double length = way_n.head<2>().norm();
  Course course;
  course.begin_ns = begin->fix.t_ns;
  course.end_ns = record.fix.t_ns;
  course.offset =
      so3::wrap(geodesy::azimuth(way_n) - geodesy::azimuth(length * mean_forward_l + lever_way_l));
  course.sigma =
      geodesy::course_sigma(begin->fix.position_covariance + record.fix.position_covariance, way_n);
  course.speed = length / dt;
  course.turn_rate = turn(begin->attitude, record.attitude) / dt;
  return course;
}

std::optional<CourseFinder::Course> CourseFinder::course_by_velocity(const Record& record) const {
  if (records_.empty()) return std::nullopt;
  const Record& last = records_.back();
  const double dt = seconds_between(last.fix.t_ns, record.fix.t_ns);
  if (!run_.empty() && seconds_between(run_.back().end_ns, record.fix.t_ns) < kVelocitySpacing) {
    return std::nullopt;
  }
  const Eigen::Vector3d& velocity_n = *record.fix.velocity_n;
  const double speed = velocity_n.head<2>().norm();
  const Eigen::Vector3d velocity_l =
      speed * forward_l(record.attitude) +
      record.attitude.q_l_b * record.attitude.omega_b.cross(record.fix.p_b_a);
  Course course;
  course.begin_ns = last.fix.t_ns;
  course.end_ns = record.fix.t_ns;
  course.offset = so3::wrap(geodesy::azimuth(velocity_n) - geodesy::azimuth(velocity_l));
  course.sigma = geodesy::course_sigma(record.fix.velocity_covariance, velocity_n);
  course.speed = speed;
  course.turn_rate = turn(last.attitude, record.attitude) / dt;
  return course;
}

/// Weighted mean of the run if its courses agree within their sigmas.
std::optional<HeadingOffset> CourseFinder::agreement() const {
  if (run_.size() < kCourses) return std::nullopt;
  if (seconds_between(run_.front().begin_ns, run_.back().end_ns) < kShortestRun) {
    return std::nullopt;
  }
  double weights = 0, sum = 0, squares = 0, sideslip = 0;
  const double reference = run_.front().offset;
  for (const Course& course : run_) {
    const double slip = course.turn_rate * kSideslipArm / course.speed;
    const double weight = 1 / (course.sigma * course.sigma + kCrabSigma * kCrabSigma + slip * slip);
    const double difference = so3::wrap(course.offset - reference);
    weights += weight;
    sum += weight * difference;
    squares += weight * difference * difference;
    sideslip += slip;
  }
  const double freedom = static_cast<double>(run_.size() - 1);
  const double chi_square = std::max(0.0, squares - sum * sum / weights) / freedom;
  if (chi_square > kAgreement) return std::nullopt;
  sideslip /= static_cast<double>(run_.size());

  HeadingOffset result;
  result.offset = so3::wrap(reference + sum / weights);
  result.variance = std::max(1.0, chi_square) / weights +
                    limits_.mounting_sigma * limits_.mounting_sigma + sideslip * sideslip;
  result.courses = static_cast<int>(run_.size());
  result.begin_ns = run_.front().begin_ns;
  result.end_ns = run_.back().end_ns;
  return result;
}

}  // namespace foucault::alignment
