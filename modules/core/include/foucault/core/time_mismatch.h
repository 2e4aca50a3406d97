#pragma once

#include <string>

namespace foucault {

/// In words, how far GNSS stamps are from those of the IMU (positive: later) and which confusion of
/// clocks makes such a difference: "1024.0 weeks after the IMU; ...remedy".
std::string describe_mismatch(double gnss_minus_imu_s);

}  // namespace foucault
