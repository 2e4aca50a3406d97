#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

/// What motion says about axes, units and clocks of an IMU: statistics without files. Each result
/// says how likely chance gives the like.
namespace foucault::rawlog {

/// Values as the table has them, on the sensor's axes.
struct ImuSeries {
  std::vector<double> t;  ///< [s]
  std::vector<Eigen::Vector3d> gyro, accel;
};

/// Fixes that differ from the one before.
struct FixSeries {
  std::vector<double> t;                  ///< [s]
  std::vector<Eigen::Vector3d> p;         ///< north, east, down [m]
  std::vector<Eigen::Vector3d> velocity;  ///< north, east, down [m/s]; empty without
};

/// Takes stamps that are ahead of `t` off the end, if they are this many at most; else `t` is
/// behind.
bool drop_ahead(std::vector<double>& stamps, double t, size_t most);

/// Median of the steps; 0 of fewer than two stamps.
double median_step(const std::vector<double>& t);

/// Horizontal scatter about the line between neighbours, one axis; less where they are smoothed.
double scatter_of(const std::vector<Eigen::Vector3d>& values);

/// Mean specific force: what its windows of a second have in common. Vibration goes in each
/// window's mean, accelerations in that of all.
struct Gravity {
  double norm = 0;                                ///< median of the windows, in the table's unit
  double spread = 0;                              ///< median deviation from it, relative
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< against gravity, if the sign is that of a
                                                  ///< specific force
};
std::optional<Gravity> gravity_of(const ImuSeries& imu);

/// A regression, and how it may be by chance.
struct Regression {
  double slope = 0;
  double sigma = 0;       ///< of the slope
  double coherence = 0;   ///< squared, 0 to 1
  double log_chance = 0;  ///< natural logarithm of the probability, all trials counted

  bool is_sure() const;
};

/// How gravity turns in the sensor while it rotates: df/dt = -omega x f. The slope is radians a
/// unit of the gyroscopes; accelerations are noise here.
Regression tilt_match(const ImuSeries& imu);

/// Accelerations of the track against specific force across `up`.
struct ForceMatch {
  Regression regression;
  double forward = 0;  ///< direction of forward [rad], see level_axes()
};

/// The motion that fixes show against what the IMU felt.
struct MotionMatch {
  double lag = 0;  ///< the IMU has at stamp t + lag what fixes have at t [s]
  size_t samples = 0;
  Regression turn;  ///< course rate by the gyroscopes' rate about `up`, both positive about up
  ForceMatch force;
  double lead =
      0;  ///< by which it is likelier than the best with forward a quarter off (logarithm)
  ForceMatch mirrored;  ///< with the mirror image, which a reversed accelerometer feels
};
std::optional<MotionMatch> match_motion(const ImuSeries& imu, const FixSeries& fixes,
                                        const Eigen::Vector3d& up);

/// Level axes of a sensor: the first is its axis `first` made level, the second is right of it.
struct LevelAxes {
  Eigen::Vector3d first, second;
};
LevelAxes level_axes(const Eigen::Vector3d& up, int first);

/// The axis of which the sensor's is the largest part: up = sign * axis.
struct NearestAxis {
  int axis = 2;
  double sign = 1;
  double angle = 0;  ///< between them [rad]
};
NearestAxis nearest_axis(const Eigen::Vector3d& direction);

}  // namespace foucault::rawlog
