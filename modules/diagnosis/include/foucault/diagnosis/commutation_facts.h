#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "foucault/core/measurement.h"

namespace foucault::diagnosis {

/// What the rate of the IMU costs in attitude, because rotations between samples do not commute.
struct CommutationFacts {
  double seconds = 0;  ///< that these rest on
  double drift = 0;    ///< mean error, as one of a gyroscope's bias [rad/s]
  double random = 0;   ///< about it, as white noise, each axis [rad/s/sqrt(Hz)]
};

/// Measures them: attitude is carried on twice for a second each, by all increments and by pairs of
/// them as an IMU of half the rate gives. Both have coning to third order, so that an error of what
/// is left falls with the fourth power of the rate (Savage 1998), and a fifteenth of the difference
/// is that of the full rate. It is more where the motion comes near half the rate. White noise of
/// the gyroscopes is the same in both.
class CommutationWatch {
 public:
  void add(const ImuIncrement& increment);
  CommutationFacts facts() const;

 private:
  /// Rotation by increments of one length.
  struct Turn {
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    std::optional<ImuIncrement> before;
    void add(const ImuIncrement& increment);
  };

  void restart();
  void end_second();

  Turn full_, half_;
  std::optional<ImuIncrement> first_;  ///< of a pair
  std::optional<int64_t> last_ns_;
  int64_t begin_ns_ = 0;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  double squares_ = 0, seconds_ = 0, count_ = 0;
};

}  // namespace foucault::diagnosis
