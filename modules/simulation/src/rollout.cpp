#include "rollout.h"

#include <cmath>

#include "foucault/geodesy/wgs84.h"

namespace foucault::simulation {
namespace {

constexpr double kTwoPi = 2 * 3.14159265358979323846;

}  // namespace

double SineSum::at(double x) const {
  double sum = 0;
  for (const Term& term : terms_) {
    sum += term.amplitude * std::sin(kTwoPi * x / term.wavelength + term.phase);
  }
  return sum;
}

double SineSum::slope(double x) const {
  double sum = 0;
  for (const Term& term : terms_) {
    const double wavenumber = kTwoPi / term.wavelength;
    sum += term.amplitude * wavenumber * std::cos(wavenumber * x + term.phase);
  }
  return sum;
}

void move_along_earth(Geodetic& position, double north, double east) {
  const double north_radius = wgs84::meridian_radius(position.latitude) + position.height;
  const double east_radius = wgs84::transverse_radius(position.latitude) + position.height;
  position.longitude += east / (east_radius * std::cos(position.latitude));
  position.latitude += north / north_radius;
}

}  // namespace foucault::simulation
