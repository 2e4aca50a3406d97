#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/measurement.h"

/// Do the gyroscopes turn when GNSS turns, as much, and the same way? Clocks, units and axes of a
/// recording show in this, without any state.
namespace foucault::diagnosis {

/// What a sensor measures per what it should.
struct MeasuredFactor {
  double value = 1;
  double sigma = 0;
  int64_t samples = 0;
};

/// A number and its sigma.
struct Measured {
  double value = 0;
  double sigma = 0;
};

struct TurnMatch {
  /// Stamps of the IMU minus those of GNSS for the same turn [s]: positive, they are late. Joint
  /// with the arm: where the speed in turns is always the same, neither is known.
  double offset_s = 0;
  double offset_sigma_s = 0;
  Measured arm_m;          ///< that the antenna is ahead of where the given lever arm has it [m]
  double slope = 0;        ///< turn by the gyroscopes per turn of the course; 1 if all is well
  double correlation = 0;  ///< of the two, at that offset
  double misfit = 0;       ///< what is left of the courses' changes, in sigmas (rms)
  double turned = 0;       ///< sum of the course's changes [rad]
  /// As slope, over gentle turns only, where vehicles that bank do so by less than 12 deg: in a
  /// bank the turn about the vehicle's vertical is the cosine of it less. None without such.
  std::optional<MeasuredFactor> gyro_factor;
  /// Growth of the offset [s/s]; none in short recordings.
  std::optional<Measured> drift;
  int64_t samples = 0;  ///< courses compared

  /// For more than whether the unit is right.
  bool is_enough() const;
};

/// Compares changes of the course, from positions, with the turn about the vertical that the
/// gyroscopes measure, over all offsets on a grid. The vertical is the mean direction of the
/// specific force. A course is that of the way between two fixes far enough apart for their sigmas;
/// the mean heading on the way, by the gyroscopes, goes with it.
///
/// The swing of the lever arm is taken out of the courses: an antenna d ahead of the axle that does
/// not steer moves sideways in a turn, and its course is early by d/v, 0.1 s for a metre at 10 m/s.
/// What remains of d, as the lever arm counts from the IMU and not from the axle, is fitted with
/// the offset.
///
/// Memory: the turns of twice the longest offset and sums an offset, for a few parts of the whole.
class TurnMatcher {
 public:
  /// Offsets from -longest_s to longest_s in steps of step_s [s].
  TurnMatcher(double longest_s, double step_s,
              const Eigen::Quaterniond& q_v_b = Eigen::Quaterniond::Identity());

  void add(const ImuIncrement& increment);
  void add(const GnssFix& fix);

  /// None before the course has turned by half a radian in all, in eight samples or more. Turns
  /// against the course are believed where they fit clearly better than turns along it.
  std::optional<TurnMatch> best() const;

  int64_t samples() const { return samples_; }

 private:
  /// Of the way from one fix to another.
  struct Course {
    int64_t begin_ns = 0, end_ns = 0;
    double course = 0;                              ///< [rad]
    double length = 0;                              ///< [m]
    double variance = 0;                            ///< of the course [rad^2]
    double speed_change = 0;                        ///< on the way, per mean speed
    Eigen::Vector2d arm = Eigen::Vector2d::Zero();  ///< known lever arm forward, right [m]
    int64_t middle_ns() const { return begin_ns + (end_ns - begin_ns) / 2; }
    double seconds() const { return 1e-9 * static_cast<double>(end_ns - begin_ns); }
    double speed() const { return length / seconds(); }
  };
  enum Column { kTurn, kArm, kCourse, kColumns };
  /// Of a course at an offset: the mean heading by the gyroscopes, what a metre of unknown arm adds
  /// to the course, and the course less the known swing.
  using Row = Eigen::Matrix<double, kColumns, 1>;
  /// Weighted sum of a row times itself.
  using Moments = Eigen::Matrix<double, kColumns, kColumns>;
  /// course = a turn + d arm at an offset.
  struct Fit {
    Eigen::Vector2d value = Eigen::Vector2d::Zero();
    double residual = 0;  ///< weighted sum of squares, with what the prior adds
    double correlation = 0;
    double arm_variance = 0;  ///< at unit weight
    bool along() const { return value[kTurn] > 0; }
  };
  /// A part of the recording: moments an offset.
  struct Part {
    std::vector<Moments> all;
    double weight = 0, weighted_time = 0;  ///< of its courses that turn
    void add(const Part& other);
  };
  /// What courses less turns are expected to be, followed by a filter whose innovations are white
  /// where courses have noise and gyroscopes a bias.
  struct Level {
    std::vector<Row> rows;        ///< an offset
    std::vector<double> courses;  ///< the last, without jumps
    double variance = 0;          ///< [rad^2]
    std::optional<Course> last;
  };

  void restart(int64_t t_ns);
  void extend_turns(double begin, double dt, double end_s);
  double turned_at(double t_s) const;
  double turn_area_at(double t_s) const;
  bool has_turns(double t0_s, double t1_s) const;
  Row row_of(const Course& course, double offset) const;
  void compare_ripe();
  void set_speed_change();
  void compare(const Course& course);
  void start_level(const Course& course);
  void add_innovations(const Course& course, double turn, double dt);
  Part& part_for_next();
  Part whole() const;
  Fit fit(const Moments& m, double variance) const;
  std::vector<Fit> fits(const Part& sums, double variance) const;
  double variance_of(const Fit& fit) const;
  std::size_t best_index(const std::vector<Fit>& fits, bool along) const;
  std::size_t best_index(const std::vector<Fit>& fits) const;
  Measured offset_near(std::size_t index, const std::vector<double>& residuals,
                       double variance) const;
  std::optional<MeasuredFactor> gentle_factor(const Moments& m, const Fit& fit) const;
  std::optional<Measured> drift(const Fit& fit, double variance) const;
  double offset_of(std::size_t index) const {
    return step_s_ * static_cast<double>(index) - longest_s_;
  }
  double seconds(int64_t t_ns) const;

  double longest_s_, step_s_;
  Eigen::Quaterniond q_v_b_;
  std::size_t offsets_;
  std::vector<Part> parts_;
  int64_t part_size_;  ///< samples a part
  std::vector<Moments> gentle_;
  double turned_ = 0;
  int64_t samples_ = 0, gentle_samples_ = 0;

  Eigen::Vector3d up_b_ = Eigen::Vector3d::Zero();  ///< mean specific force
  double up_memory_ = 0;
  std::optional<int64_t> start_ns_, last_ns_, first_ns_;
  std::deque<double> turns_;  ///< the turn since the start, on a grid of time
  std::deque<double> areas_;  ///< its integral over time
  int64_t first_turn_ = 0;    ///< index of turns_.front() on it
  double turn_ = 0;

  std::optional<GnssFix> anchor_;
  std::deque<Course> waiting_;
  Level level_;
};

/// What is wrong with clocks, units or scale if turns match as they do, and what to do about it,
/// one line; none if nothing is grossly wrong. `t_ns`: a stamp of the recording, for its leap
/// seconds.
std::optional<std::string> gross_mismatch(const TurnMatch& match, int64_t t_ns);

}  // namespace foucault::diagnosis
