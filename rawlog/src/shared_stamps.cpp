#include "shared_stamps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "foucault/core/hole.h"
#include "foucault/core/median.h"
#include "foucault/core/time.h"

namespace foucault::rawlog {

namespace {

struct StampGroup {
  int64_t t_ns = 0;
  int64_t rows = 0;
};

std::vector<StampGroup> groups_of(const std::vector<int64_t>& stamps_ns) {
  std::vector<StampGroup> groups;
  for (const int64_t t_ns : stamps_ns) {
    if (groups.empty() || groups.back().t_ns != t_ns) groups.push_back({t_ns, 0});
    ++groups.back().rows;
  }
  return groups;
}

}  // namespace

std::optional<SharedStamps> SharedStamps::of(const std::vector<int64_t>& stamps_ns,
                                             bool increments) {
  constexpr double kShare = 0.4;
  constexpr size_t kFewest = 5;
  constexpr int64_t kFarApart = 300'000'000;  // [ns]
  const std::vector<StampGroup> groups = groups_of(stamps_ns);
  const auto repeated = static_cast<double>(stamps_ns.size() - groups.size());
  if (groups.size() < kFewest || repeated < kShare * static_cast<double>(stamps_ns.size())) {
    return std::nullopt;
  }
  std::vector<double> gaps, intervals;
  for (size_t i = 1; i + 1 < groups.size(); ++i) {
    const auto gap = static_cast<double>(groups[i + 1].t_ns - groups[i].t_ns);
    gaps.push_back(gap);
    intervals.push_back(gap / static_cast<double>(groups[i].rows));
  }
  SharedStamps found;
  found.gap_ns = static_cast<int64_t>(median(gaps));
  found.interval_ns = static_cast<int64_t>(median(intervals));
  if (found.interval_ns <= 0 || (found.gap_ns < kFarApart && !increments)) return std::nullopt;
  const int64_t first_ns = groups.front().t_ns;
  found.of_first = found.gap_ns >= kFarApart &&
                   std::all_of(groups.begin(), groups.end(), [&](const StampGroup& group) {
                     return (group.t_ns - first_ns) % found.gap_ns == 0;
                   });
  return found;
}

std::vector<int64_t> SharedStamps::spread(int64_t t_ns, size_t rows,
                                          std::optional<int64_t> other_ns) const {
  const auto n = static_cast<int64_t>(rows);
  int64_t dt_ns = interval_ns;
  int64_t last_ns = of_first ? t_ns + (n - 1) * dt_ns : t_ns;
  if (other_ns) {
    const int64_t between_ns = std::abs(*other_ns - t_ns);
    dt_ns = std::min(dt_ns, between_ns / n);
    if (of_first && !is_hole(between_ns, gap_ns)) last_ns = *other_ns - dt_ns;
  }
  std::vector<int64_t> stamps_ns;
  for (int64_t k = 0; k < n; ++k) stamps_ns.push_back(last_ns - (n - 1 - k) * dt_ns);
  return stamps_ns;
}

std::string SharedStamps::notice() const {
  const double gap = static_cast<double>(gap_ns) / kNanosecondsPerSecond;
  return fmt::format(
      "rows share stamps, one each {:.4g} s: they were spread evenly, {:.4g} ms apart, the {} at "
      "the stamp; if that is of the {}, give imu.time.offset_s: {:.4g} (added to what stands "
      "there)",
      gap, static_cast<double>(interval_ns) / 1e6, of_first ? "first" : "last",
      of_first ? "last" : "first", of_first ? -gap : gap);
}

}  // namespace foucault::rawlog
