#include "texts/profile_text.h"

#include <fmt/format.h>

#include <cstddef>
#include <numeric>

namespace foucault::app {
namespace {

/// In the order of Stage.
constexpr const char* kNotes[kStages] = {
    "the program and its libraries, before the run",
    "the log gone through before: what is wrong with it, clocks, noise",
    "log to measurements, decompression included",
    "initial attitude",
    "strapdown mechanization, every IMU sample",
    "preintegration with covariance and Jacobians, every IMU sample",
    "mechanization and preintegration, every IMU sample",
    "fixes into the filter",
    "optimization",
    "elimination along the chain",
    "propagation and marginal covariances",
    "backward pass",
    "metrics, errors against a reference",
    "solution files",
    "the report and its figures",
    "",
};

}  // namespace

double total_seconds(const std::vector<StageTime>& profile) {
  return std::accumulate(profile.begin(), profile.end(), 0.0,
                         [](double sum, const StageTime& time) { return sum + time.seconds; });
}

std::vector<std::string> profile_lines(const std::vector<StageTime>& profile) {
  std::vector<std::string> lines;
  const double total = total_seconds(profile);
  for (const StageTime& time : profile) {
    lines.push_back(fmt::format("{:<10} {:<12} {:7.3f} s {:5.1f} %  {}", "profile",
                                stage_name(time.stage), time.seconds, 100 * time.seconds / total,
                                kNotes[static_cast<std::size_t>(time.stage)]));
  }
  if (!lines.empty()) {
    lines.push_back(fmt::format("{:<10} {:<12} {:7.3f} s", "profile", "total", total));
  }
  return lines;
}

}  // namespace foucault::app
