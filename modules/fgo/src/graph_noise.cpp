#include "graph_noise.h"

#include <fmt/format.h>

#include "foucault/core/error.h"

namespace foucault::fgo {
namespace {

void require(bool there, const char* zero, const char* of) {
  if (there) return;
  throw UsageError(fmt::format(
      "{}: a factor graph needs {}; give the sensor's, or use method ekf or rts", zero, of));
}

}  // namespace

void require_noise(const imu::ImuNoise& noise) {
  require(noise.gyro_noise_density > 0, "imu.arw_deg_sqrt_h is 0",
          "the white noise of the gyroscopes");
  require(noise.accel_noise_density > 0, "imu.vrw_m_s_sqrt_h is 0",
          "the white noise of the accelerometers");
  require(imu::gyro_markov_bias(noise).sigma > 0,
          "imu.gyro_bias_deg_h and imu.gyro_turn_on_deg_h are both 0",
          "the sigma of the gyroscopes' bias");
  require(imu::accel_markov_bias(noise).sigma > 0,
          "imu.accel_bias_mgal and imu.accel_turn_on_mgal are both 0",
          "the sigma of the accelerometers' bias");
}

}  // namespace foucault::fgo
