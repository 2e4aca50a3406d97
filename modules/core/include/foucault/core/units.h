#pragma once

#include <cstdint>
#include <string>

/// Units at the edge of the program: factors from SI and radians, and stamps as text.
namespace foucault::units {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegrees = 180.0 / kPi;               ///< rad -> deg
constexpr double kDegreesPerHour = kDegrees * 3600.0;  ///< rad/s -> deg/h
constexpr double kMilligals = 1e5;                     ///< m/s^2 -> mGal

/// UNIX seconds with nine decimals, exact.
std::string format_stamp(int64_t t_ns);

/// `2024-05-01T12:34:56Z`, the fraction cut off.
std::string format_utc(int64_t t_ns);

}  // namespace foucault::units
