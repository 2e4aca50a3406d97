#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/geodesy/course.h"

namespace foucault::alignment {

/// The attitude that the gyroscopes give at a fix, in a level frame l of arbitrary heading.
struct LevelAttitude {
  Eigen::Quaterniond q_l_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d omega_b = Eigen::Vector3d::Zero();     ///< angular rate [rad/s]
  Eigen::Vector3d forward_b = Eigen::Vector3d::UnitX();  ///< the vehicle's forward axis
};

/// The vehicle's point without sideslip (a car's rear axle) lies within this of the IMU.
constexpr double kSideslipArm = 1.5;  // [m]

/// Course criteria.
struct CourseLimits {
  double min_speed = 3;           ///< [m/s]
  double max_sigma = 0.05;        ///< of one course [rad]
  double max_turn_rate = 0.1;     ///< [rad/s]
  double mounting_sigma = 0.005;  ///< course against forward axis [rad]
};

/// Heading of l's north-like axis, i.e. heading = offset + azimuth in l.
struct HeadingOffset {
  double offset = 0;    ///< [rad]
  double variance = 0;  ///< [rad^2], of the courses; drift of the gyroscopes not included
  int courses = 0;
  int64_t begin_ns = 0;
  int64_t end_ns = 0;
};

/// Compares courses over ground with the azimuth of the vehicle's forward axis, over consecutive
/// fixes of the best quality while the vehicle drives straight and fast. Courses come from the way
/// between fixes a second apart, or, where positions are coarse, from measured velocities.
class CourseFinder {
 public:
  explicit CourseFinder(const CourseLimits& limits) : limits_(limits) {}

  /// Returns the offset once at least three courses over at least three seconds agree.
  std::optional<HeadingOffset> add(const GnssFix& fix, const LevelAttitude& attitude);
  /// Ends the run of courses: the attitude was lost, or the vehicle rests or reverses.
  void interrupt();

  double fastest() const { return fastest_; }    ///< [m/s], for messages
  int courses_seen() const { return courses_; }  ///< for messages

 private:
  struct Record {
    GnssFix fix;
    LevelAttitude attitude;
  };
  struct Course {
    int64_t begin_ns = 0;
    int64_t end_ns = 0;
    double offset = 0;     ///< [rad]
    double sigma = 0;      ///< [rad]
    double speed = 0;      ///< [m/s]
    double turn_rate = 0;  ///< [rad/s]
  };

  bool continues(const Record& record) const;
  std::optional<Course> course_to(const Record& record) const;
  std::optional<Course> course_by_positions(const Record& record) const;
  std::optional<Course> course_by_velocity(const Record& record) const;
  bool acceptable(const Course& course) const;
  std::optional<HeadingOffset> agreement() const;

  CourseLimits limits_;
  FixQuality best_quality_ = FixQuality::unknown;
  std::deque<Record> records_;
  std::deque<Course> run_;
  double fastest_ = 0;
  int courses_ = 0;
};

}  // namespace foucault::alignment
