#include "figure_list.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace foucault::content {

using namespace page;

namespace {

/// A figure by the name of its files; names that begin alike belong together.
struct Expected {
  const char* name;
  const char* what;
  const char* why_not;
};

constexpr const char* kNoReference = "the recording has no reference";
constexpr const char* kNoFixes = "no fix came out of the data";

const std::vector<Expected> kExpected{
    {"ground_track", "Ground track", "no epoch and no fix came out of the data"},
    {"position_error", "Errors of position, velocity, attitude", kNoReference},
    {"position_separation", "Smoothed against forward",
     "the method runs forward only; batch and rts smooth"},
    {"nees", "Normalized estimation errors (NEES)", kNoReference},
    {"gnss_innovations", "Innovations", kNoFixes},
    {"nis", "Normalized innovations (NIS)", kNoFixes},
    {"raw_imu", "IMU as recorded", "the recording has no samples of an IMU"},
    {"imu_spectrum", "Spectral density of the IMU",
     "there are not 1024 samples of the IMU in a row at even intervals"},
    {"receiver", "What the receiver says of its fixes", kNoFixes},
    {"calibration", "Lever arm, scales, time offset, mounting",
     "none of them was estimated (calibrate.*)"},
    {"aid_innovations", "Measurements beside positions", "none was used (aids.*)"},
};

bool shows(const ReportPage& page, const std::string& name) {
  return std::any_of(page.sections.begin(), page.sections.end(), [&](const Section& section) {
    return std::any_of(section.figures.begin(), section.figures.end(),
                       [&](const plot::Figure& f) { return f.name.rfind(name, 0) == 0; });
  });
}

bool any_of_column(const plot::DecimatedTable& table, size_t column) {
  const std::vector<double> values = table.rows().columns.at(column);
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

std::string untold_details(const RunData& data) {
  std::string untold;
  constexpr const char* kNames[] = {"satellites", "HDOP", "age of corrections"};
  for (size_t i = 0; i < std::size(kNames); ++i) {
    if (!data.fix_details.empty() && any_of_column(data.fix_details, i)) continue;
    untold += (untold.empty() ? "" : ", ") + std::string(kNames[i]);
  }
  return untold;
}

}  // namespace

Table missing_figures(const ReportPage& page, const RunData& data) {
  Table table;
  table.title = "What is not shown, and why";
  table.of_words = true;
  for (const Expected& expected : kExpected) {
    if (!shows(page, expected.name)) table.rows.push_back({expected.what, expected.why_not});
  }
  if (!shows(page, "solver")) {
    table.rows.push_back({"Time and iterations of the solver, an epoch",
                          data.solve_totals.count > 0
                              ? "it solves for the whole recording at once; see Processing"
                              : "the method does not iterate"});
  }
  const std::string untold = untold_details(data);
  if (!untold.empty()) {
    table.rows.push_back({"Receiver: " + untold, "the recording does not carry it"});
  }
  table.rows.push_back({"Drift in outages, growth, distribution, ablation",
                        "no outage is simulated in a run; `foucault evaluate` does it"});
  table.rows.push_back(
      {"Allan deviation", "it is of rest; `foucault allan` draws it where the log rests"});
  return table;
}

}  // namespace foucault::content
