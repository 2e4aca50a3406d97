#pragma once

#include <cstdint>
#include <string>

#include "foucault/core/constants.h"

/// Units at the edge of the program: factors from SI and radians, and stamps as text.
namespace foucault::units {

constexpr double kDegrees = 1 / kDegree;                        ///< rad -> deg
constexpr double kDegreesPerHour = kDegrees * kSecondsPerHour;  ///< rad/s -> deg/h
constexpr double kMilligals = 1e5;                              ///< m/s^2 -> mGal

/// UNIX seconds with nine decimals, exact.
std::string format_stamp(int64_t t_ns);

}  // namespace foucault::units
