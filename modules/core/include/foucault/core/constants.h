#pragma once

/// Numbers of mathematics and of convention, each written once.
namespace foucault {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegree = kPi / 180;         ///< [rad]
inline constexpr double kStandardGravity = 9.80665;  ///< the unit g [m/s^2]; no place's gravity
inline constexpr int kSecondsPerHour = 3600;
inline constexpr int kSecondsPerDay = 86'400;
inline constexpr int kSecondsPerWeek = 604'800;

}  // namespace foucault
