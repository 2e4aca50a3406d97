#pragma once

#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/interfaces.h"
#include "initial_state.h"

namespace foucault::alignment {

/// A start with all angles given: the first fix within the IMU data, with its velocity or the one
/// that the next fix gives.
class GivenStart {
 public:
  void add(const ImuIncrement& increment);
  std::optional<state::Epoch> add(const GnssFix& fix, const state::Mounting& mounting,
                                  const GivenAngles& given, const imu::ImuNoise& noise);
  void restart() { *this = GivenStart(); }

  /// That it may start from.
  const std::optional<GnssFix>& fix() const { return first_; }

 private:
  std::optional<GnssFix> first_;
  std::optional<int64_t> imu_begin_ns_;
  Eigen::Vector3d rate_sum_ = Eigen::Vector3d::Zero();
  double rate_time_ = 0;
};

}  // namespace foucault::alignment
