#include "foucault/diagnosis/force_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "foucault/core/constants.h"

namespace foucault::diagnosis {
namespace {

/// Of a rest that is told by its length: accelerometers have up to 11 % (below), and some noise.
constexpr double kRestTolerance = 0.15;
/// Chosen: airplanes and drones bear 12 g at most, for seconds. In mg or cm/s^2 rest is 100 g or
/// more.
constexpr double kStrongest = 20 * kStandardGravity;
/// The mean over a time T is gravity less the change of velocity over T. A parabolic flight is
/// without weight for 25 s, and bears 1 g and more before and after: 0.58 g over a minute, in which
/// less than a third would be this change.
constexpr double kLargestChange = 390;  // [m/s]
constexpr double kWeakFor = 60;         // [s]
/// Scale factors of consumer IMUs are within 3 %, their offsets within 0.8 m/s^2 (data sheets of
/// the cheapest, MPU-6050: 3 %, 80 mg), 11 % of gravity together; twice that is no IMU's.
constexpr double kLargestError = 0.2;
constexpr double kFactorSigmas = 5;  // one in two million
constexpr double kOneFactor = 0.05;

/// The unit that makes m/s^2 this many times as large, if it is one of the usual ones. Those of mg
/// and cm/s^2 are 2 % apart: the nearest. Increments over a sample are short by its interval.
std::optional<WrongForce> wrong_unit(double factor, double interval_s) {
  struct Unit {
    const char* name;
    double per_m_s2;
  };
  constexpr Unit kUnits[] = {
      {"g", 1 / kStandardGravity}, {"mg", 1000 / kStandardGravity}, {"cm/s^2", 100}};
  const auto off = [&](const Unit& unit) { return std::abs(factor / unit.per_m_s2 - 1); };
  const Unit* nearest =
      std::min_element(std::begin(kUnits), std::end(kUnits),
                       [&](const Unit& a, const Unit& b) { return off(a) < off(b); });
  if (off(*nearest) < kRestTolerance) {
    return WrongForce{fmt::format("specific force is in {}, not m/s^2", nearest->name),
                      "name the unit in the import"};
  }
  if (!(interval_s > 0) || std::abs(factor / interval_s - 1) >= kRestTolerance) return std::nullopt;
  return WrongForce{
      fmt::format("specific force is in m/s, increments over the {:.4g} s of a sample", interval_s),
      "name the units of increments in the import (csv: accel_unit: m_s, gyro_unit: rad)"};
}

/// Units have one factor; without gravity each window has its own, and a sigma of 10 % or more.
std::optional<WrongForce> wrong_factor(const MeasuredFactor& factor, double interval_s) {
  if (std::abs(factor.value - 1) <= kLargestError + kFactorSigmas * factor.sigma)
    return std::nullopt;
  const std::optional<WrongForce> unit = wrong_unit(factor.value, interval_s);
  if (unit && factor.sigma < kOneFactor * factor.value) return unit;
  return WrongForce{
      fmt::format("specific force is {:.3f} (sigma {:.3f}) times what gravity and the motion of "
                  "the fixes make it, {} windows; no accelerometer's scale factor is so far off",
                  factor.value, factor.sigma, factor.samples),
      "correct unit or scale in the import (csv: accel_unit, accel_scale)"};
}

double weakest(double seconds) {
  return std::min((1 - kLargestError) * kStandardGravity,
                  kStandardGravity - kLargestChange / seconds);
}

/// Rest has one direction; motion without gravity, which may be as long, has not.
std::optional<WrongForce> wrong_mean(const ForceFacts& force) {
  constexpr double kOneDirection = 0.9;  // of the length
  const bool rests = force.mean.norm() > kOneDirection * force.length;
  const bool too_weak = force.seconds >= kWeakFor && force.length < weakest(force.seconds);
  const std::optional<WrongForce> unit =
      wrong_unit(force.length / kStandardGravity, too_weak ? force.interval_s : 0);
  if (rests && unit) return unit;
  if (!too_weak && force.length < kStrongest) return std::nullopt;
  return WrongForce{fmt::format("specific force is {:.3g} m/s^2 where gravity is 9.8 (wrong units, "
                                "or gravity taken out)",
                                force.length),
                    "name unit or scale in the import (csv: accel_unit, accel_scale), or record "
                    "accelerations with gravity"};
}

}  // namespace

void MeanForce::add(const ImuIncrement& increment) {
  sum_b_ += increment.dvel_b;
  length_sum_ += increment.dvel_b.norm();
  time_ += increment.dt();
  ++samples_;
}

ForceFacts MeanForce::facts() const {
  ForceFacts facts;
  if (!(time_ > 0)) return facts;
  facts.mean = sum_b_ / time_;
  facts.length = length_sum_ / time_;
  facts.seconds = time_;
  facts.interval_s = time_ / static_cast<double>(samples_);
  return facts;
}

std::optional<WrongForce> wrong_force(const ForceFacts& force) {
  if (force.factor) return wrong_factor(*force.factor, force.interval_s);
  return wrong_mean(force);
}

}  // namespace foucault::diagnosis
