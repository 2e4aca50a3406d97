#pragma once

#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/measurement.h"

namespace foucault {

inline bool is_finite(const Geodetic& position) {
  return std::isfinite(position.latitude + position.longitude + position.height);
}

/// Whether a receiver can have been there: finite, on the Earth or up to 100 km above or below its
/// ellipsoid, where space begins, and not at latitude and longitude zero, which receivers write
/// while they have no fix.
inline bool is_position(const Geodetic& position) {
  constexpr double kHighest = 1e5;  // [m]
  const double latitude = std::abs(position.latitude), longitude = std::abs(position.longitude);
  return latitude <= kPi / 2 && longitude <= 2 * kPi && std::abs(position.height) <= kHighest &&
         latitude + longitude > 0;
}

}  // namespace foucault
