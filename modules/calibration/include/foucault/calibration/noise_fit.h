#pragma once

#include "foucault/calibration/recorded_way.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/layout.h"

/// What a recording says of the noise of its IMU.
namespace foucault::calibration {

/// Logarithm of the probability density of the fixes, each given those before it: the innovations
/// of a Kalman filter from the start on, without the constant.
double log_likelihood(const RecordedWay& way, const imu::ImuNoise& noise,
                      const state::Layout& layout);

struct NoiseFit {
  imu::ImuNoise noise;
  double gain = 0;  ///< of the logarithm of likelihood and prior
  int tried = 0;
};

/// The noise that was told, with densities and bias variations raised where the likelihood of the
/// recording rises by more than chance would have it once in ten thousand (chi-square of one
/// degree of freedom: 7.6 for twice that many factors that are tried). Data sheets are of one
/// temperature and of no vibration: real noise is larger, never smaller, and what is told is not
/// lowered. What is told is right within a factor of four, one sigma of the logarithm. White noise
/// first, then what it leaves to the variations: from fix to fix the two look alike, and a bias
/// that is said to wander is lost in an outage. Steps by four along the axis that helps most, then
/// by two.
NoiseFit raised_noise(const RecordedWay& way, const imu::ImuNoise& told,
                      const state::Layout& layout);

}  // namespace foucault::calibration
