#include "statistics_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "foucault/plot/text.h"
#include "run_panels.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

struct StatisticsLook {
  const char* title;
  Triad RunData::*triad;
  const char* unit;
  Names axes;
};

const std::vector<StatisticsLook> kErrorLooks{
    {"Position error", &RunData::position_error, "m", kNed},
    {"Velocity error", &RunData::velocity_error, "m/s", kNed},
    {"Attitude error", &RunData::attitude_error, "°", {"Roll", "Pitch", "Heading"}}};

const std::vector<StatisticsLook> kSeparationLooks{
    {"Position, smoothed less forward", &RunData::position_separation, "m", kNed},
    {"Velocity, smoothed less forward", &RunData::velocity_separation, "m/s", kNed},
    {"Attitude, smoothed less forward",
     &RunData::attitude_separation,
     "°",
     {"Roll", "Pitch", "Heading"}}};

const std::vector<StatisticsLook> kInnovationLooks{
    {"Innovations of used fixes", &RunData::innovation, "m", kNed},
    {"Residuals after use", &RunData::postfit, "m", kNed}};

Table statistics_table(const RunData& data, const StatisticsLook& look) {
  const Triad& triad = data.*look.triad;
  const AxisStatistics& s = triad.statistics;
  const std::array<Eigen::Vector3d, 5> columns{s.mean(), s.rms(), s.quantile(0.5), s.quantile(0.95),
                                               s.largest()};
  Table table;
  table.title = std::string(look.title) + " (" + look.unit + ")";
  table.header = {"", "Mean", "RMS", "Median", "95 %", "Maximum"};
  for (size_t axis = 0; axis < 3; ++axis) {
    std::vector<std::string> row{look.axes[axis]};
    for (const Eigen::Vector3d& column : columns) {
      row.push_back(significant_text(column[static_cast<Eigen::Index>(axis)]));
    }
    table.rows.push_back(std::move(row));
  }
  table.note = "Median, 95 % and maximum are of magnitudes; " + std::to_string(s.count()) +
               " samples" + since(triad.statistics_from) + ".";
  return table;
}

std::vector<Table> tables_of(const RunData& data, const std::vector<StatisticsLook>& looks) {
  std::vector<Table> tables;
  for (const StatisticsLook& look : looks) {
    if ((data.*look.triad).statistics.count() > 0) tables.push_back(statistics_table(data, look));
  }
  return tables;
}

}  // namespace

std::vector<Table> error_statistics(const RunData& data) { return tables_of(data, kErrorLooks); }

std::vector<Table> separation_statistics(const RunData& data) {
  return tables_of(data, kSeparationLooks);
}

std::vector<std::string> error_words(const RunData& data) {
  const AxisStatistics& s = data.attitude_error.statistics;
  const StatisticsLook& look = kErrorLooks.back();
  std::vector<std::string> parts;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double mean = s.mean()[axis];
    const double spread = std::sqrt(std::max(0.0, std::pow(s.rms()[axis], 2) - mean * mean));
    const bool is_constant = std::abs(mean) > 5 * spread && s.inside_3_sigma()[axis] < 0.5;
    if (!is_constant) continue;
    parts.push_back(look.axes[static_cast<size_t>(axis)] + (" by " + significant_text(mean)) +
                    "° ± " + significant_text(spread, 2) + "°");
  }
  if (parts.empty()) return {};
  return {"Angles that differ from the reference by a constant: " + joined(parts, "; ") +
          ". That is an angle between the axes of the reference and those of the vehicle as they "
          "were told (see the mounting under Calibration, where it is estimated), not an error "
          "that the sigmas speak of."};
}

std::vector<std::string> separation_words(const RunData& data) {
  constexpr double kExpected = 0.95;  // of what lies within 3 sigma, errors that last
  std::vector<std::string> parts;
  constexpr std::array<const char*, 3> kNouns{"position", "velocity", "attitude"};
  for (size_t i = 0; i < kNouns.size(); ++i) {
    const StatisticsLook& look = kSeparationLooks[i];
    const AxisStatistics& s = (data.*look.triad).statistics;
    if (s.count() == 0) continue;
    const Eigen::Vector3d inside = s.inside_3_sigma();
    for (size_t axis = 0; axis < 3; ++axis) {
      const double share = inside[static_cast<Eigen::Index>(axis)];
      if (share >= kExpected) continue;
      parts.push_back(
          fmt::format("{}, {} ({} %)", kNouns[i], look.axes[axis], number_text(100 * share, 0)));
    }
  }
  if (parts.empty()) return {};
  return {
      "Smoothing changed more than the sigmas of the forward run allow, which hold 99.7 % if "
      "they are right: " +
      joined(parts, "; ") +
      ". The forward run thought itself better than it was there; what it took for known came "
      "out otherwise (see Calibration)."};
}

std::vector<Table> innovation_statistics(const RunData& data) {
  return tables_of(data, kInnovationLooks);
}

}  // namespace foucault::content
