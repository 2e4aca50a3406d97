#include "foucault/imu/recent_rates.h"

#include <algorithm>

namespace foucault::imu {

void RecentRates::add(const ImuIncrement& increment) {
  const double dt = increment.dt();
  seen_s = std::min(seen_s + dt, memory_s);
  const double weight = std::min(1.0, dt / seen_s);
  gyro_b += weight * (increment.dtheta_b / dt - gyro_b);
  accel_b += weight * (increment.dvel_b / dt - accel_b);
}

}  // namespace foucault::imu
