#include "foucault/diagnosis/plausibility.h"

#include <fmt/format.h>

#include <cmath>

#include "foucault/core/error.h"

namespace foucault::diagnosis {
namespace {

constexpr double kForceMean = 10;  // [s]
constexpr double kStandardGravity = 9.80665;
constexpr int64_t kSamplesNeeded = 40;
constexpr int64_t kSamplesBetweenLooks = 20;
constexpr int64_t kWindowsBetweenLooks = 10;
constexpr double kTurnNeeded = 6.3;  // [rad]

}  // namespace

std::optional<std::string> wrong_force(double mean) {
  struct Unit {
    const char* name;
    double per_m_s2;
  };
  for (const Unit& unit : {Unit{"g", 1 / kStandardGravity}, Unit{"mg", 1000 / kStandardGravity},
                           Unit{"cm/s^2", 100}}) {
    if (std::abs(mean / (kStandardGravity * unit.per_m_s2) - 1) < 0.15) {
      return fmt::format("specific force is in {}, not m/s^2", unit.name);
    }
  }
  if (mean > kStandardGravity / 3 && mean < 3 * kStandardGravity) return std::nullopt;
  return fmt::format(
      "specific force is {:.3g} m/s^2 where gravity is 9.8 (wrong units, or gravity "
      "taken out)",
      mean);
}

void Plausibility::look_at_force(const ImuIncrement& increment) {
  if (force_time_ > kForceMean) return;
  force_sum_b_ += increment.dvel_b;
  force_time_ += increment.dt();
  if (force_time_ <= kForceMean) return;
  if (const std::optional<std::string> wrong = wrong_force(force_sum_b_.norm() / force_time_)) {
    throw DataError(fmt::format("{}; name the unit in the import", *wrong));
  }
}

void Plausibility::look_at_force_factor() {
  if (force_match_.windows() < windows_looked_at_ + kWindowsBetweenLooks) return;
  windows_looked_at_ = force_match_.windows();
  const std::optional<MeasuredFactor> factor = force_match_.factor();
  if (!factor) return;
  if (const std::optional<std::string> wrong = wrong_force_factor(*factor)) {
    throw DataError(fmt::format("{}; correct unit or scale in the import", *wrong));
  }
}

void Plausibility::look_at_turns(int64_t t_ns) {
  if (matcher_.samples() < samples_looked_at_ + kSamplesBetweenLooks) return;
  samples_looked_at_ = matcher_.samples();
  const std::optional<TurnMatch> match = matcher_.best();
  if (!match) return;
  const bool clocks_show = match->samples >= kSamplesNeeded && match->turned >= kTurnNeeded;
  const std::optional<std::string> wrong =
      clocks_show ? gross_mismatch(*match, t_ns) : wrong_rates(*match);
  if (wrong) throw DataError(*wrong);
}

void Plausibility::add(const ImuIncrement& increment) {
  look_at_force(increment);
  matcher_.add(increment);
  force_match_.add(increment);
  look_at_force_factor();
  look_at_turns(increment.t_end_ns);
}

}  // namespace foucault::diagnosis
