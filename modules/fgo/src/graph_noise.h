#pragma once

#include "foucault/imu/imu_noise.h"

namespace foucault::fgo {

/// A graph weighs by inverse covariances: every error must have one.
/// Throws UsageError naming the key of one that is zero.
void require_noise(const imu::ImuNoise& noise);

}  // namespace foucault::fgo
