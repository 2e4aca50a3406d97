#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Stamps that several rows of a table share, too far apart for imu::BurstStamps to see them, or of
/// increments, which need their intervals.
namespace foucault::rawlog {

struct SharedStamps {
  int64_t interval_ns = 0;  ///< of the rows when they were taken
  int64_t gap_ns = 0;       ///< between two stamps, usual
  /// The stamp is that of the first of its rows, as of a clock that ticks slowly; else of the last,
  /// as of a host that got them together.
  bool of_first = false;

  /// Stamps of rows, not decreasing: none unless four tenths of them repeat the one before, at five
  /// stamps and more, and these are 0.3 s and more apart, or the rows are increments. They are
  /// taken for those of the first if all lie exactly on a grid of 0.3 s and more.
  static std::optional<SharedStamps> of(const std::vector<int64_t>& stamps_ns, bool increments);

  /// Stamps of `rows` rows at `t_ns`. `other_ns`: the stamp of those after them if of_first, else
  /// of those before; none if there are none.
  std::vector<int64_t> spread(int64_t t_ns, size_t rows, std::optional<int64_t> other_ns) const;

  std::string notice() const;
};

}  // namespace foucault::rawlog
