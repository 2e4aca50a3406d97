#include "rollout.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/simulation/random.h"

namespace foucault::simulation {
namespace {

constexpr double kTwoPi = 2 * kPi;

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

double toward(double value, double target, double step) {
  return value + std::clamp(target - value, -step, step);
}

void move_along_earth(Geodetic& position, double north, double east) {
  const double north_radius = geodesy::wgs84::meridian_radius(position.latitude) + position.height;
  const double east_radius = geodesy::wgs84::transverse_radius(position.latitude) + position.height;
  position.longitude += east / (east_radius * std::cos(position.latitude));
  position.latitude += north / north_radius;
}

double start_heading(const ScenarioOptions& options) {
  if (options.heading_deg) return *options.heading_deg * kDegree;
  return Draws(options.seed, RandomStream::heading).uniform(-kPi, kPi);
}

}  // namespace foucault::simulation
