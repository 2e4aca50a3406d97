#include "texts/profile_text.h"

#include <fmt/format.h>

#include <numeric>

namespace foucault::app {
namespace {

const char* stage_note(Stage stage) {
  switch (stage) {
    case Stage::start:
      return "the program and its libraries, before the run";
    case Stage::read:
      return "log to measurements, decompression included";
    case Stage::align:
      return "initial attitude";
    case Stage::mechanize:
      return "strapdown mechanization, every IMU sample";
    case Stage::preintegrate:
      return "preintegration with covariance and Jacobians, every IMU sample";
    case Stage::propagate:
      return "mechanization and preintegration, every IMU sample";
    case Stage::update:
      return "fixes into the filter";
    case Stage::solve:
      return "optimization";
    case Stage::marginalize:
      return "elimination along the chain";
    case Stage::covariance:
      return "propagation and marginal covariances";
    case Stage::smooth:
      return "backward pass";
    case Stage::statistics:
      return "metrics, errors against a reference";
    case Stage::write:
      return "solution files";
    case Stage::draw:
      return "the report and its figures";
    case Stage::other:
      return "";
  }
  return "";
}

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
                                stage_note(time.stage)));
  }
  if (!lines.empty()) {
    lines.push_back(fmt::format("{:<10} {:<12} {:7.3f} s", "profile", "total", total));
  }
  return lines;
}

}  // namespace foucault::app
