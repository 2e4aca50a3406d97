#include "foucault/geodesy/reach.h"

#include <cmath>

#include "foucault/core/time.h"

namespace foucault::geodesy {
namespace {

constexpr double kFastest = 1000;       // [m/s]
constexpr double kFarAway = 10000;      // [m]
constexpr double kEarthRadius = 6.4e6;  // [m], smallest

}  // namespace

double least_distance(const Geodetic& a, const Geodetic& b) {
  const double north = std::sin((b.latitude - a.latitude) / 2);
  const double east = std::sin((b.longitude - a.longitude) / 2);
  const double h = north * north + std::cos(a.latitude) * std::cos(b.latitude) * east * east;
  const double chord = 2 * kEarthRadius * std::sqrt(h);
  return std::hypot(chord, b.height - a.height);
}

bool within_reach(const GnssFix& a, const GnssFix& b) {
  const double dt = std::abs(seconds_between(a.t_ns, b.t_ns));
  return least_distance(a.antenna, b.antenna) <= kFarAway + kFastest * dt;
}

}  // namespace foucault::geodesy
