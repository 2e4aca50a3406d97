#include "foucault/diagnosis/velocity_facts.h"

#include <cmath>
#include <complex>
#include <utility>

#include "foucault/core/time.h"
#include "foucault/geodesy/place.h"

namespace foucault::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr double kLongestPair = 2;  // [s]; a turn is an arc and no chord then
constexpr double kShortestPair = 0.01;
constexpr double kInMotion = 1;  // [m/s]

Complex horizontal(const Eigen::Vector3d& v_n) { return {v_n.x(), v_n.y()}; }

}  // namespace

void VelocityWatch::add(const GnssFix& fix) {
  const std::optional<GnssFix> before = std::exchange(last_, fix);
  if (!before || !before->velocity_n || !fix.velocity_n) return;
  const double dt = seconds_between(before->t_ns, fix.t_ns);
  if (!(dt > kShortestPair && dt < kLongestPair)) return;
  const Complex way = horizontal(geodesy::displacement_n(before->antenna, fix.antenna,
                                                         geodesy::Place(before->antenna))) /
                      dt;
  const Complex velocity = 0.5 * horizontal(*before->velocity_n + *fix.velocity_n);
  if (std::abs(velocity) < kInMotion) return;
  ++pairs_;
  ways_ += std::norm(way);
  velocities_ += std::norm(velocity);
  const Complex straight = way * std::conj(velocity), mirrored = way * velocity;
  straight_n_ += straight.real();
  straight_e_ += straight.imag();
  mirrored_n_ += mirrored.real();
  mirrored_e_ += mirrored.imag();
}

VelocityFacts VelocityWatch::facts() const {
  VelocityFacts facts;
  facts.pairs = pairs_;
  if (pairs_ < 2) return facts;
  const Complex straight(straight_n_, straight_e_), mirrored(mirrored_n_, mirrored_e_);
  facts.mirrored = std::abs(mirrored) > std::abs(straight);
  const Complex k = (facts.mirrored ? mirrored : straight) / velocities_;
  facts.scale = std::abs(k);
  facts.angle = std::arg(k);
  const double left = std::max(0.0, ways_ - std::norm(k) * velocities_);
  facts.sigma = std::sqrt(left / static_cast<double>(2 * pairs_ - 2) / velocities_);
  return facts;
}

}  // namespace foucault::diagnosis
