#include "boot_clock.h"

#include "foucault/core/median.h"

namespace foucault::rawlog {

BootClock::BootClock(const std::vector<FixTime>& fixes) {
  constexpr int64_t kWrong = 500'000;  // [us]
  if (fixes.empty()) return;
  std::vector<double> offsets;
  for (const FixTime& fix : fixes)
    offsets.push_back(static_cast<double>(*fix.utc_us - fix.boot_us));
  offset_us_ = std::llround(median(offsets));
  std::vector<FixTime> good;
  for (const FixTime& fix : fixes) {
    if (std::abs(*fix.utc_us - fix.boot_us - offset_us_) <= kWrong) good.push_back(fix);
  }
  if (!good.empty()) fit(good);
}

/// A line through offsets, least squares.
void BootClock::fit(const std::vector<FixTime>& fixes) {
  constexpr double kLongEnough = 120e6;  // [us]
  constexpr double kMostDrift = 200e-6;
  begin_us_ = fixes.front().boot_us;
  const auto n = static_cast<double>(fixes.size());
  double t = 0;
  double d = 0;
  for (const FixTime& fix : fixes) {
    t += static_cast<double>(fix.boot_us - begin_us_) / n;
    d += static_cast<double>(*fix.utc_us - fix.boot_us - offset_us_) / n;
  }
  double tt = 0;
  double td = 0;
  for (const FixTime& fix : fixes) {
    const double dt = static_cast<double>(fix.boot_us - begin_us_) - t;
    tt += dt * dt;
    td += dt * (static_cast<double>(*fix.utc_us - fix.boot_us - offset_us_) - d);
  }
  const bool long_enough = fixes.back().boot_us - begin_us_ > kLongEnough;
  if (long_enough && std::abs(td) < kMostDrift * tt) drift_ = td / tt;
  mean_us_ = d - drift_ * t;
}

}  // namespace foucault::rawlog
