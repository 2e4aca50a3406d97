#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/allan_watch.h"
#include "foucault/diagnosis/first_values.h"
#include "foucault/diagnosis/steady_way.h"

namespace foucault::diagnosis {

/// White noise by the Allan deviation over 1, 2 and 4 s at rest (medians), the least of them: what
/// vibration adds falls off faster with time, what biases add grows. The largest axis.
struct RestFacts {
  int64_t seconds = 0;
  double gyro_noise_density = 0;   ///< [rad/s/sqrt(Hz)]
  double accel_noise_density = 0;  ///< [m/s^2/sqrt(Hz)]
  double gyro_mean = 0;            ///< largest axis of the rate, median over seconds [rad/s]
  /// Differences of neighbouring fixes, less what they move, over what their sigmas make them; 1 if
  /// they are white.
  double fix_scatter = 0;
  int64_t fix_pairs = 0;
};

/// From when to when nothing moved, without what led to it or away from it.
struct Rest {
  int64_t begin_ns = 0, end_ns = 0;
};

/// Collects them, second by second. At rest the means of three seconds in a row agree with the
/// next, and no fix moves. That a fix does not move is told over all such seconds together, up to
/// half a minute: one second of a steady drive looks like one of rest if it is short against the
/// sigmas, and only many show the way. Where fixes would not show a walk, nothing is told.
class RestWatch {
 public:
  void add(const ImuIncrement& increment);
  void add(const GnssFix& fix);
  RestFacts facts() const;
  /// Whole rests of which facts() are; the second that shows motion and the one before it are left
  /// out.
  std::vector<Rest> rests() const;

 private:
  struct Second {
    int64_t begin_ns = 0, end_ns = 0;
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
    double length = 0;
  };
  /// From a fix to the next.
  struct Step {
    Eigen::Vector2d way = Eigen::Vector2d::Zero();  ///< [m]
    double time = 0, sigma = 0;                     ///< [s], of a fix [m]
  };
  /// Seconds in a row of which the IMU says that they are of rest, with their fixes.
  struct Stretch {
    std::vector<Second> seconds;
    std::vector<Step> steps;
    SteadyWay way;
  };

  void end_second();
  bool is_steady() const;
  void lengthen();
  void end_stretch();
  void take_stretch();
  void take(const Second& second);
  RestFacts taken() const;

  Second second_;
  std::deque<Second> seconds_;  ///< the last four
  std::vector<GnssFix> fixes_;  ///< of this second, and the one before them
  Stretch stretch_;
  bool goes_on_ = false;  ///< the stretch follows on rest
  int64_t still_ = 0;     ///< seconds at rest
  std::vector<Rest> rests_;
  std::array<FirstValues, 3> gyro_;
  std::array<AllanWatch, 3> allan_{AllanWatch(1), AllanWatch(2), AllanWatch(4)};
  FirstValues scatter_;
};

}  // namespace foucault::diagnosis
