#include "sensor_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "foucault/plot/text.h"
#include "run_panels.h"

namespace foucault::content {

using namespace plot;

namespace {

constexpr Names kSensorAxes{"x", "y", "z"};

/// The three signals of one sensor.
struct Sensor {
  const char* label;
  const char* unit;
  const char* density_unit;
  size_t first;  ///< column
};

constexpr std::array<Sensor, 2> kSensors{
    {{"Rate of turn", "°/s", "°/s/√Hz", 0}, {"Specific force", "m/s²", "m/s²/√Hz", 3}}};

/// One of three curves that a panel has together.
Series triad_line(const std::string& label, size_t axis, std::vector<double> x,
                  std::vector<double> y, const std::string& column) {
  Series series = line(label, kTriadInks[axis], std::move(x), std::move(y));
  series.column = column;
  series.dash = kTriadDashes[axis];
  return series;
}

/// Root of the mean square over bands of the same ratio, which few stretches leave readable.
ImuSpectrum::Density in_bands(const ImuSpectrum::Density& density) {
  constexpr double kPerDecade = 40;
  const auto band = [](double frequency) { return std::floor(kPerDecade * std::log10(frequency)); };
  ImuSpectrum::Density result;
  result.signal.resize(density.signal.size());
  const size_t count = density.frequency.size();
  for (size_t begin = 0, end = 0; begin < count; begin = end) {
    while (end < count && band(density.frequency[end]) == band(density.frequency[begin])) ++end;
    const auto lines = static_cast<double>(end - begin);
    result.frequency.push_back(std::sqrt(density.frequency[begin] * density.frequency[end - 1]));
    for (size_t i = 0; i < density.signal.size(); ++i) {
      double sum = 0;
      for (size_t k = begin; k < end; ++k) sum += std::pow(density.signal[i][k], 2);
      result.signal[i].push_back(std::sqrt(sum / lines));
    }
  }
  return result;
}

bool any_finite(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

std::optional<Figure> raw_imu_figure(const RunData& data, const std::string& subtitle) {
  if (data.imu_rates.empty()) return std::nullopt;
  const DecimatedTable::Rows rows = data.imu_rates.rows();
  Figure figure = stacked_figure(
      "raw_imu", "IMU as recorded", subtitle,
      "Rates of turn and specific forces on the axes of the IMU, nothing taken out. Of "
      "neighbouring "
      "samples the least and the largest are drawn, so no peak is lost. Flat tops mean a sensor at "
      "the end of its range; straight lines, samples that were made up.");
  figure.height_mm = 300;
  for (const Sensor& sensor : kSensors) {
    for (size_t axis = 0; axis < 3; ++axis) {
      const std::string name = fmt::format("{} {}", sensor.label, kSensorAxes[axis]);
      Panel panel = time_panel(data, {name, sensor.unit});
      panel.series = {line(name, Ink::blue, rows.x, rows.columns[sensor.first + axis])};
      panel.series[0].size = 0.9;
      panel.series[0].in_legend = false;
      figure.panels.push_back(std::move(panel));
    }
  }
  return figure;
}

std::optional<Figure> imu_spectrum_figure(const RunData& data, const std::string& subtitle) {
  constexpr int64_t kMany = 8;  // stretches: their mean is within 35 %
  ImuSpectrum::Density density = data.imu_spectrum.density();
  if (density.frequency.empty()) return std::nullopt;
  const auto stretches = static_cast<int64_t>(data.imu_spectrum.stretches());
  if (stretches < kMany) density = in_bands(density);
  Figure figure{"imu_spectrum", "Spectral density of the IMU", subtitle,
                fmt::format("Root of the power spectral density over the whole recording (Welch: "
                            "{} stretches of {} samples, Hann window). Motion of the vehicle is at "
                            "the left; peaks are vibrations; the level at the right is the noise "
                            "of the sensor and of what shakes it.{}",
                            stretches, ImuSpectrum::kLength,
                            stretches < kMany ? " Means over bands of 6 %, for so few stretches "
                                                "scatter."
                                              : "")};
  figure.height_mm = 105;
  figure.columns = 2;
  for (const Sensor& sensor : kSensors) {
    Panel panel;
    panel.x = {"Frequency", "Hz", AxisKind::log};
    panel.y = {sensor.label, sensor.density_unit, AxisKind::log};
    for (size_t axis = 0; axis < 3; ++axis) {
      panel.series.push_back(triad_line(fmt::format("{} axis", kSensorAxes[axis]), axis,
                                        density.frequency, density.signal[sensor.first + axis],
                                        fmt::format("{} {}", sensor.label, kSensorAxes[axis])));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

namespace {

/// Where all intervals are alike, one column must look like one.
void show_neighbours(double shortest, double longest, Axis& axis) {
  constexpr double kLeast = 2;  // longest over shortest
  if (longest >= kLeast * shortest) return;
  const double room = std::sqrt(kLeast * shortest / longest);
  axis.min = shortest / room;
  axis.max = longest * room;
}

}  // namespace

std::optional<Figure> imu_intervals_figure(const RunData& data, const std::string& subtitle) {
  const IntervalHistogram::Bins bins = data.imu_intervals.bins();
  if (bins.count.empty()) return std::nullopt;
  Panel panel;
  panel.x = {"IMU interval", "ms", AxisKind::log};
  panel.y = {"Samples", "", AxisKind::log};
  panel.y.min = 0.7;
  show_neighbours(1000 * bins.corner.front(), 1000 * bins.corner.back(), panel.x);
  Series series{"samples", "samples", Mark::band, Ink::blue};
  series.in_legend = false;
  for (size_t i = 0; i < bins.count.size(); ++i) {
    if (bins.count[i] == 0) continue;
    add_level(1000 * bins.corner[i], 1000 * bins.corner[i + 1], 0.7,
              static_cast<double>(bins.count[i]), series);
  }
  panel.series = {series};
  Figure figure{
      "imu_intervals", "Intervals between IMU samples", subtitle,
      "How many intervals have which length, both axes logarithmic. A healthy IMU has one "
      "column, or a few beside each other; a second one at twice the length is of lost "
      "samples, one at zero of stamps given by a host."};
  figure.height_mm = 80;
  figure.panels = {std::move(panel)};
  return figure;
}

namespace {

Panel sigmas_panel(const RunData& data) {
  const DecimatedTable::Rows rows = data.fix_sigmas.rows();
  Panel panel = time_panel(data, {"Sigma of the receiver", "m", AxisKind::log});
  panel.legend = LegendPlace::panel;
  for (size_t axis = 0; axis < 3; ++axis) {
    panel.series.push_back(triad_line(kNed[axis], axis, rows.x, rows.columns[axis],
                                      fmt::format("Sigma {}", kNed[axis])));
  }
  return panel;
}

struct Detail {
  const char* label;
  const char* unit;
};
constexpr std::array<Detail, 3> kDetails{
    {{"Satellites", ""}, {"HDOP", ""}, {"Age of corrections", "s"}}};

}  // namespace

std::optional<Figure> receiver_figure(const RunData& data, const std::string& subtitle) {
  if (data.fix_sigmas.empty()) return std::nullopt;
  Figure figure = stacked_figure(
      "receiver", "What the receiver says of its fixes", subtitle,
      "Standard deviations that came with the fixes and, where they are recorded, satellites, "
      "dilution of precision and age of corrections. Sigmas that never change are not the "
      "receiver's own.");
  figure.panels = {sigmas_panel(data)};
  const DecimatedTable::Rows rows = data.fix_details.rows();
  for (size_t i = 0; i < kDetails.size(); ++i) {
    if (data.fix_details.empty() || !any_finite(rows.columns[i])) continue;
    Panel panel = time_panel(data, {kDetails[i].label, kDetails[i].unit});
    panel.y.from_zero = true;
    panel.series = {line(kDetails[i].label, Ink::blue, rows.x, rows.columns[i])};
    panel.series[0].mark = Mark::steps;
    panel.series[0].in_legend = false;
    figure.panels.push_back(std::move(panel));
  }
  figure.height_mm = 46 + 48 * static_cast<double>(figure.panels.size());
  return figure;
}

std::optional<Figure> speed_figure(const RunData& data, const std::string& subtitle) {
  if (data.speed_and_height.empty()) return std::nullopt;
  const DecimatedTable::Rows rows = data.speed_and_height.rows();
  Figure figure = stacked_figure("speed_height", "Speed and height", subtitle,
                                 "Magnitude of the velocity, and height above the ellipsoid. "
                                 "solution.kml shows the same way on a globe.");
  figure.height_mm = 125;
  for (const auto& [label, unit, column] :
       {std::tuple{"Speed", "m/s", 0}, std::tuple{"Height", "m", 1}}) {
    Panel panel = time_panel(data, {label, unit});
    panel.y.least_span = 0.1;
    panel.series = {line(label, Ink::blue, rows.x, rows.columns[static_cast<size_t>(column)])};
    panel.series[0].in_legend = false;
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace foucault::content
