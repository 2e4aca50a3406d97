#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace foucault::rawlog {

/// When a fix was received on a clock since boot and, if the receiver knows it, its UTC.
struct FixTime {
  int64_t boot_us = 0;
  std::optional<int64_t> utc_us;
};

/// UTC of the clock since boot: an offset, and a drift where the log is long enough.
class BootClock {
 public:
  BootClock() = default;
  /// All of `fixes` have their UTC; those whose offset is another than most have are left out.
  explicit BootClock(const std::vector<FixTime>& fixes);

  int64_t utc_ns(int64_t boot_us) const;
  /// The fix's own UTC unless it is far from its reception.
  int64_t utc_ns(const FixTime& time) const;

 private:
  void fit(const std::vector<FixTime>& fixes);

  int64_t begin_us_ = 0;
  int64_t offset_us_ = 0;
  double mean_us_ = 0;
  double drift_ = 0;
};

}  // namespace foucault::rawlog
