#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/allan_watch.h"
#include "foucault/diagnosis/first_values.h"

namespace foucault::diagnosis {

/// White noise by the Allan deviation over 1, 2 and 4 s at rest (medians), the least of them: what
/// vibration adds falls off faster with time, what biases add grows. The largest axis.
struct RestFacts {
  int64_t seconds = 0;
  double gyro_noise_density = 0;   ///< [rad/s/sqrt(Hz)]
  double accel_noise_density = 0;  ///< [m/s^2/sqrt(Hz)]
  double gyro_mean = 0;            ///< largest axis of the mean rate [rad/s]
  /// Differences of neighbouring fixes, over what their sigmas make them; 1 if they are white.
  double fix_scatter = 0;
  int64_t fix_pairs = 0;
};

/// Collects them, second by second: at rest the means of three seconds in a row agree with the
/// next, and no fix moves.
class RestWatch {
 public:
  void add(const ImuIncrement& increment);
  void add(const GnssFix& fix);
  RestFacts facts() const;

 private:
  struct Second {
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
    double length = 0;
  };

  void end_second();
  bool is_still() const;
  void take();

  Second second_;
  std::deque<Second> seconds_;  ///< the last four
  int64_t still_ = 0;           ///< seconds at rest
  Eigen::Vector3d gyro_sum_ = Eigen::Vector3d::Zero();
  std::array<AllanWatch, 3> allan_{AllanWatch(1), AllanWatch(2), AllanWatch(4)};
  std::optional<GnssFix> last_fix_;
  std::vector<double> pending_scatter_;  ///< of this second
  double last_scatter_ = std::numeric_limits<double>::infinity();
  FirstValues scatter_;
};

}  // namespace foucault::diagnosis
