#pragma once

#include <cstdint>
#include <vector>

#include "foucault/imu/imu_noise.h"
#include "foucault/state/interfaces.h"

namespace foucault::benchmarks {

/// A simulated drive in a city with an ADIS16465 at 200 Hz, in memory.
struct Trip {
  imu::ImuNoise noise;
  state::Mounting mounting;
  std::vector<Measurement> measurements;
  int64_t samples = 0;
  int64_t fixes = 0;
};

Trip simulated_trip(double duration_s, double gnss_rate_hz);

}  // namespace foucault::benchmarks
