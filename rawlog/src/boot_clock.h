#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

/// A sensor's clock that counts since power-up, tied to UTC by the fixes of the same recording.
namespace foucault::rawlog {

inline constexpr int64_t kNanosecondsPerMicrosecond = 1000;

/// When a fix was received and, if the receiver knows it, its UTC.
struct FixTime {
  int64_t boot_us = 0;
  std::optional<int64_t> utc_us;
};

/// UTC of the clock since boot: an offset, and a drift where the log is long enough.
class BootClock {
 public:
  BootClock() = default;
  explicit BootClock(const std::vector<FixTime>& fixes);

  int64_t utc_ns(int64_t boot_us) const {
    const auto since_us = static_cast<double>(boot_us - begin_us_);
    return (boot_us + offset_us_ + std::llround(mean_us_ + drift_ * since_us)) *
           kNanosecondsPerMicrosecond;
  }

  /// The fix's own UTC unless it is far from its reception.
  int64_t utc_ns(const FixTime& time) const {
    constexpr int64_t kDelaysVary = 100'000'000;  // [ns]
    const int64_t received_ns = utc_ns(time.boot_us);
    if (!time.utc_us) return received_ns;
    const int64_t own_ns = *time.utc_us * kNanosecondsPerMicrosecond;
    return std::abs(own_ns - received_ns) < kDelaysVary ? own_ns : received_ns;
  }

 private:
  void fit(const std::vector<FixTime>& fixes);

  int64_t begin_us_ = 0;
  int64_t offset_us_ = 0;
  double mean_us_ = 0;
  double drift_ = 0;
};

}  // namespace foucault::rawlog
