#include "pages/allan_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/evaluation/statistics.h"
#include "foucault/imu/imu_noise.h"
#include "version.h"

namespace foucault::app {
namespace {

constexpr const char* kNotTold = "not told";
constexpr const char* kGyroscope = "gyroscope";

std::string number(const AllanValue& value) {
  return value.value ? fmt::format("{:.3g}", *value.value) : kNotTold;
}

page::Table coefficients_table(const AllanResult& result) {
  page::Table table{"Coefficients",
                    "One sigma: the value of all axes may be so many times larger or smaller.",
                    false,
                    {"number", "unit", "all axes", "one sigma", "x", "y", "z"},
                    {}};
  for (const AllanSensor& sensor : result.sensors) {
    for (std::size_t i = 0; i < sensor.fitted[0].values.size(); ++i) {
      const AllanValue& all = sensor.fitted[0].values[i];
      std::vector<std::string> row{fmt::format("{}: {}", sensor.name, all.name), all.unit,
                                   number(all),
                                   all.value ? fmt::format("×/÷ {:.2f}", all.factor) : ""};
      for (std::size_t axis = 1; axis < 4; ++axis)
        row.push_back(number(sensor.fitted[axis].values[i]));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

plot::Series line(const char* label, const char* column, plot::Ink ink, double width,
                  plot::Dash dash = plot::Dash::none) {
  plot::Series series;
  series.label = label;
  series.column = column;
  series.ink = ink;
  series.size = width;
  series.dash = dash;
  return series;
}

/// Averaging times of the curve, those of few differences too.
std::vector<double> times_of(const calibration::AllanCurve& curve) {
  std::vector<double> times;
  for (const calibration::AllanPoint& point : curve.points) times.push_back(point.tau_s);
  return times;
}

plot::Series axis_series(const AllanResult& result, const AllanSensor& sensor, std::size_t axis,
                         plot::Ink ink) {
  const AllanSensor::Fitted& fitted = sensor.fitted[axis];
  plot::Series series = line(fitted.name.c_str(), fitted.name.c_str(), ink, 0.8);
  series.x = times_of(result.curve);
  for (const calibration::AllanPoint& point : result.curve.points)
    series.y.push_back(sensor.shown * std::sqrt(calibration::variance_of(point, fitted.axes)));
  return series;
}

/// All axes together with the interval that holds the truth in 95 of 100 cases.
std::vector<plot::Series> pooled_series(const AllanResult& result, const AllanSensor& sensor) {
  const AllanSensor::Fitted& all = sensor.fitted[0];
  plot::Series points = line("all axes", "all", plot::Ink::black, 3.5);
  points.mark = plot::Mark::points;
  plot::Series band = line("95 %", "band", plot::Ink::gray, 1);
  band.mark = plot::Mark::band;
  band.opacity = 0.3;
  points.x = band.x = times_of(result.curve);
  for (const calibration::AllanPoint& point : result.curve.points) {
    const double deviation = sensor.shown * std::sqrt(calibration::variance_of(point, all.axes));
    const double freedom =
        std::max(1.0, calibration::degrees_of_freedom(result.curve, point.samples, 3, all.fit));
    points.y.push_back(deviation);
    band.lower.push_back(deviation *
                         std::sqrt(freedom / evaluation::chi_square_quantile(0.975, freedom)));
    band.upper.push_back(deviation *
                         std::sqrt(freedom / evaluation::chi_square_quantile(0.025, freedom)));
  }
  return {std::move(band), std::move(points)};
}

plot::Series fit_series(const AllanResult& result, const AllanSensor& sensor) {
  const calibration::AllanFit& fit = sensor.fitted[0].fit;
  plot::Series series = line("fit", "fit", plot::Ink::vermillion, 1.6);
  series.x = times_of(result.curve);
  for (const double tau : series.x)
    series.y.push_back(tau >= fit.from_s && tau <= fit.to_s ? sensor.shown * fit.deviation(tau)
                                                            : plot::kNoValue);
  return series;
}

/// What the preset says at the averaging times of the curve.
std::vector<double> preset_deviations(const AllanResult& result, bool gyro,
                                      const imu::ImuNoise& noise) {
  std::vector<double> deviations;
  for (const double tau : times_of(result.curve))
    deviations.push_back(calibration::model_deviation(
        gyro ? noise.gyro_noise_density : noise.accel_noise_density,
        gyro ? noise.gyro_bias_sigma : noise.accel_bias_sigma, noise.bias_tau, tau));
  return deviations;
}

/// Somewhere within a decade of what was measured.
bool comes_near(const plot::Series& preset, const plot::Series& measured) {
  constexpr double kNear = 10;
  for (std::size_t i = 0; i < preset.y.size(); ++i) {
    const double ratio = preset.y[i] / measured.y[i];
    if (std::max(ratio, 1 / ratio) < kNear) return true;
  }
  return false;
}

/// The text that one at this height would lie over.
plot::Annotation* in_the_way(plot::Panel& panel, plot::Side side, double y) {
  constexpr double kLine = 1.25;  // height of a text
  for (plot::Annotation& other : panel.annotations) {
    if (other.side == side && std::max(y / other.y, other.y / y) < kLine) return &other;
  }
  return nullptr;
}

/// To the left of it or, if another is there, to the right; those that lie over each other there
/// have one text.
void name_at_its_end(const plot::Series& series, const std::string& name, plot::Panel& panel) {
  if (!in_the_way(panel, plot::Side::left, series.y.front())) {
    panel.annotations.push_back(
        {series.x.front(), series.y.front(), name, plot::Side::left, plot::Ink::gray});
  } else if (plot::Annotation* other = in_the_way(panel, plot::Side::right, series.y.back())) {
    other->text += ", " + name;
  } else {
    panel.annotations.push_back(
        {series.x.back(), series.y.back(), name, plot::Side::right, plot::Ink::gray});
  }
}

void add_presets(const AllanResult& result, const AllanSensor& sensor, const plot::Series& measured,
                 plot::Panel& panel) {
  for (const std::string& name : imu::imu_preset_names()) {
    plot::Series series = line("", name.c_str(), plot::Ink::gray, 0.7, plot::Dash::dashes);
    series.x = measured.x;
    series.y = preset_deviations(result, sensor.key == kGyroscope, imu::imu_preset(name));
    for (double& y : series.y) y *= sensor.shown;
    if (!comes_near(series, measured)) continue;
    name_at_its_end(series, name, panel);
    panel.series.push_back(std::move(series));
  }
}

/// As every figure has it; tables of coefficients have the units of the configuration.
std::string with_degree_sign(std::string unit) {
  if (unit.rfind("deg", 0) == 0) unit.replace(0, 3, "°");
  return unit;
}

plot::Figure allan_figure(const AllanResult& result, std::size_t index) {
  const AllanSensor& sensor = result.sensors[index];
  plot::Figure figure{fmt::format("allan_{}", sensor.key),
                      fmt::format("Allan deviation: {}", sensor.name), result.log};
  figure.caption =
      "Each axis, and all together with the band that holds the truth in 95 of 100 cases; red: the "
      "fit, over the averaging times it is of. Dashed: what the presets say that come near. A "
      "slope "
      "of -1/2 is white noise, N at one second; flat is bias instability; +1/2 is rate random "
      "walk.";
  figure.height_mm = 150;
  plot::Panel panel;
  panel.x = {"Averaging time", "s", plot::AxisKind::log};
  panel.y = {"Allan deviation", with_degree_sign(sensor.unit), plot::AxisKind::log};
  constexpr double kRoom = 8;  // for names at either end
  panel.x.min = result.curve.points.front().tau_s / kRoom;
  panel.x.max = result.curve.points.back().tau_s * kRoom;
  std::vector<plot::Series> pooled = pooled_series(result, sensor);
  add_presets(result, sensor, pooled.back(), panel);
  const std::array<plot::Ink, 3> inks{plot::Ink::blue, plot::Ink::orange, plot::Ink::green};
  const std::array<plot::Dash, 3> dashes{plot::Dash::none, plot::Dash::long_dashes,
                                         plot::Dash::dash_dot};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    panel.series.push_back(axis_series(result, sensor, axis + 1, inks[axis]));
    panel.series.back().dash = dashes[axis];
  }
  for (plot::Series& series : pooled) panel.series.push_back(std::move(series));
  panel.series.push_back(fit_series(result, sensor));
  figure.panels.push_back(std::move(panel));
  return figure;
}

plot::Series spectrum_series(const calibration::Spectrum& spectrum, const AllanSensor& sensor,
                             const char* label, plot::Ink ink) {
  plot::Series series = line(label, label, ink, 1);
  for (std::size_t bin = 1; bin < spectrum.density.size(); ++bin) {
    series.x.push_back(spectrum.frequency_hz(bin));
    series.y.push_back(sensor.density_shown *
                       std::sqrt(spectrum.density[bin](sensor.fitted[0].axes).mean()));
  }
  return series;
}

/// Names that would lie over each other are left to the table.
void name_lines(const std::vector<calibration::SpectralLine>& lines, const plot::Series& series,
                plot::Ink ink, plot::Panel& panel) {
  constexpr double kName = 1.0 / 12;  // width of a text, in that of the panel
  for (const calibration::SpectralLine& line : lines) {
    const auto is_beside = [&](const plot::Annotation& other) {
      return std::abs(other.x - line.frequency_hz) < kName * series.x.back();
    };
    if (std::any_of(panel.annotations.begin(), panel.annotations.end(), is_beside)) continue;
    const auto bin = std::min_element(series.x.begin(), series.x.end(), [&](double a, double b) {
      return std::abs(a - line.frequency_hz) < std::abs(b - line.frequency_hz);
    });
    panel.annotations.push_back(
        {line.frequency_hz, series.y[static_cast<std::size_t>(bin - series.x.begin())],
         fmt::format("{:.4g} Hz", line.frequency_hz), plot::Side::above, ink});
  }
}

plot::Figure spectrum_figure(const AllanResult& result) {
  plot::Figure figure{"spectrum", "Spectral density at rest and in motion", result.log};
  figure.caption =
      "Root of the two-sided power spectral density, mean of the axes: white noise of density N "
      "lies at N. Lines that stand out of what is beside them are named: engine, propeller, "
      "springs, or their aliases; the table has all of them.";
  figure.height_mm = 190;
  figure.share_x = true;
  for (const AllanSensor& sensor : result.sensors) {
    plot::Panel panel;
    panel.title = sensor.name;
    panel.x = {"Frequency", "Hz"};
    panel.y = {"Density", with_degree_sign(sensor.density_unit), plot::AxisKind::log};
    for (const auto& [spectrum, lines, label, ink] :
         {std::tuple{&result.in_motion, &sensor.lines_in_motion, "in motion", plot::Ink::orange},
          std::tuple{&result.at_rest, &sensor.lines_at_rest, "at rest", plot::Ink::blue}}) {
      if (spectrum->segments == 0) continue;
      plot::Series series = spectrum_series(*spectrum, sensor, label, ink);
      name_lines(*lines, series, ink, panel);
      panel.series.push_back(std::move(series));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

page::Table lines_table(const AllanResult& result) {
  page::Table table{"Lines",
                    "RMS of all axes together, without what is beside the line.",
                    false,
                    {"sensor", "when", "frequency [Hz]", "RMS", "times what is beside it"},
                    {}};
  for (const AllanSensor& sensor : result.sensors) {
    const bool gyro = sensor.key == kGyroscope;
    for (const auto& [when, lines] : {std::pair{"at rest", &sensor.lines_at_rest},
                                      std::pair{"in motion", &sensor.lines_in_motion}})
      for (const calibration::SpectralLine& line : *lines)
        table.rows.push_back(
            {sensor.name, when, fmt::format("{:.4g}", line.frequency_hz),
             fmt::format("{:.3g} {}", line.rms * sensor.density_shown, gyro ? "°/s" : "m/s²"),
             fmt::format("{:.3g}", line.ratio)});
  }
  return table;
}

page::Section spectrum_section(const AllanResult& result) {
  page::Section section{"Vibration"};
  if (result.at_rest.segments + result.in_motion.segments == 0) {
    section.paragraphs.push_back("The recording is too short for a spectrum.");
    return section;
  }
  section.figures.push_back(spectrum_figure(result));
  const page::Table lines = lines_table(result);
  if (lines.rows.empty()) {
    section.paragraphs.push_back("No line stands out.");
  } else {
    section.tables.push_back(lines);
  }
  return section;
}

std::string markov_text(const AllanResult& result) {
  return fmt::format(
      "The program's biases are Gauss-Markov processes of a correlation time of {:.0f} s "
      "(imu.bias_tau_s). \"K as Markov bias\" is the sigma of such a process, for "
      "imu.gyro_bias_deg_h and imu.accel_bias_mgal; where only B is told, 1.07 B with the "
      "averaging "
      "time at which the curve is flat, over 1.89, as correlation time has its top there. What is "
      "\"not told\" does not show within {:.0f} s, the longest rest.",
      result.bias_tau_s, result.curve.longest_s());
}

}  // namespace

std::vector<plot::Figure> allan_figures(const AllanResult& result) {
  return {allan_figure(result, 0), allan_figure(result, 1)};
}

page::ReportPage allan_page(const AllanResult& result) {
  page::ReportPage page;
  page.title = "Noise at rest";
  page.subtitle = result.log;
  page.key_numbers = {
      {"at rest", fmt::format("{:.0f}", result.curve.length_s()), "s",
       fmt::format("in {} rests, the longest {:.0f} s", result.rests, result.curve.longest_s())}};
  for (const AllanSensor& sensor : result.sensors) {
    const AllanValue& white = sensor.fitted[0].values.front();
    page.key_numbers.push_back({sensor.name, number(white), white.unit, "white noise"});
  }
  page.sections = {{"Allan deviation",
                    {markov_text(result)},
                    {coefficients_table(result)},
                    {allan_figure(result, 0), allan_figure(result, 1)}},
                   spectrum_section(result)};
  page.listings = {{"Command", result.command_line}};
  page.footer = fmt::format("foucault {}", kVersion);
  return page;
}

}  // namespace foucault::app
