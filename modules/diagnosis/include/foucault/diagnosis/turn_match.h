#pragma once

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

struct TurnMatch {
  /// Stamps of the IMU minus those of GNSS for the same turn [s]: positive, they are late.
  double offset_s = 0;
  double offset_sigma_s = 0;
  double slope = 0;        ///< turn by the gyroscopes per turn of the course; 1 if all is well
  double correlation = 0;  ///< of the two, at that offset
  /// Sum of squares that this offset leaves, of that which no offset leaves; 1: they are as good.
  double residual_share = 1;
  double turned = 0;  ///< sum of the course's changes [rad]
  /// As slope, over gentle turns only, where vehicles that bank do so by less than 12 deg: in a
  /// bank the turn about the vehicle's vertical is the cosine of it less. None without such.
  std::optional<MeasuredFactor> gyro_factor;
  int64_t samples = 0;  ///< courses compared
};

/// Compares changes of the course, from positions, with the turn about the vertical that the
/// gyroscopes measure, over all offsets on a grid. The vertical is the mean direction of the
/// specific force. A course is that between two fixes far enough apart for their sigmas, at the
/// middle of the two; where the vehicle is slow there is none.
///
/// A point d ahead of the axle that does not steer moves sideways in a turn, and its course is
/// early by d/v, which is taken for an offset: 0.1 s for a metre at 10 m/s.
///
/// Memory: the turns of twice the longest offset and one sum an offset.
class TurnMatcher {
 public:
  /// Offsets from -longest_s to longest_s in steps of step_s [s].
  explicit TurnMatcher(double longest_s, double step_s);

  void add(const ImuIncrement& increment);
  void add(const GnssFix& fix);

  /// None before the course has turned by a right angle in all, in twenty samples or more.
  std::optional<TurnMatch> best() const;

  int64_t samples() const { return samples_; }

 private:
  struct Course {
    int64_t t_ns = 0;
    double course = 0;
    double speed = 0;  ///< [m/s]
  };
  struct Change {
    Course before, after;
  };
  /// Of the change of course y and the turn x.
  struct Sums {
    double xx = 0, xy = 0;
    double gentle_xx = 0, gentle_xy = 0;  ///< the same over gentle turns
  };
  struct Fit {
    double turn = 0;      ///< dy / dx
    double residual = 0;  ///< sum of squares
  };

  void restart(int64_t t_ns);
  std::optional<double> turned_at(double t_s) const;
  void compare_ripe();
  void compare(const Change& change);
  Fit fit(const Sums& sums) const;
  std::optional<MeasuredFactor> gentle_factor(const Sums& sums) const;
  double seconds(int64_t t_ns) const;

  double longest_s_, step_s_;
  std::vector<Sums> sums_;
  double yy_ = 0, gentle_yy_ = 0, turned_ = 0;
  int64_t samples_ = 0, gentle_samples_ = 0;

  Eigen::Vector3d up_b_ = Eigen::Vector3d::Zero();  ///< mean specific force
  double up_memory_ = 0;
  std::optional<int64_t> start_ns_, last_ns_;
  std::deque<double> turns_;  ///< the turn since the start, on a grid of time
  int64_t first_turn_ = 0;    ///< index of turns_.front() on it
  double turn_ = 0;

  std::optional<GnssFix> anchor_;
  std::optional<Course> last_course_;
  std::deque<Change> waiting_;
};

/// What is wrong with clocks, units, scale or axes if turns match as they do, and what to do about
/// it, one line; none if nothing is grossly wrong. `t_ns`: a stamp of the recording, for its leap
/// seconds.
std::optional<std::string> gross_mismatch(const TurnMatch& match, int64_t t_ns);

/// The part of it that is certain as soon as there is a TurnMatch: unit or scale of angular rates.
std::optional<std::string> wrong_rates(const TurnMatch& match);

}  // namespace foucault::diagnosis
