#pragma once

#include <optional>

#include "foucault/core/constants.h"
#include "foucault/core/fix_quality.h"

/// How accurate fixes of NMEA are taken to be, which says it in GST only.
namespace foucault::rawlog {

/// Standard deviation per axis of a position [m]: horizontal (north and east, each) and vertical.
struct NmeaSigma {
  double horizontal = 0;
  double vertical = 0;
};

/// An assumption: a table by fix quality at HDOP 1 (fixed 0.015, float 0.25, ppp 0.1, differential
/// 0.7, single and unknown 1.7), times HDOP (at least 0.5; 1 where the receiver gives none);
/// vertical is twice the horizontal.
NmeaSigma nmea_sigma(FixQuality quality, std::optional<double> hdop);

inline constexpr double kKnot = 1852.0 / kSecondsPerHour;  ///< [m/s]

/// Of a speed and a course along the ground, which leave the vertical open [m/s].
inline constexpr double kGroundSpeedSigma = 0.2;
inline constexpr double kOpenVerticalSigma = 10;

/// Of a heading of two antennas: an arm of a metre, and a centimetre.
inline constexpr double kHeadingSigma = 0.5 * kDegree;

}  // namespace foucault::rawlog
