#include "jobs/learn_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/export/json_object.h"
#include "foucault/export/text_file.h"
#include "foucault/page/report_page.h"
#include "jobs/survey.h"
#include "output_directory.h"
#include "pages/learn_page.h"
#include "version.h"

namespace foucault::app {
namespace {

namespace axis = calibration::noise_axis;
using calibration::Learned;
using calibration::LearnedAxis;
using calibration::NoiseModel;

/// How the settings call an axis, and its unit there.
struct Known {
  const calibration::NoiseAxis& axis;
  const char* name;
  const char* key;
  const char* unit;
  double (*shown)(double value);
};

double as_it_is(double value) { return value; }

const std::vector<Known>& known_axes() {
  const auto of_white_gyro = [](double v) { return v / kDegree * 60; };
  const auto of_white_accel = [](double v) { return v * 60; };
  const auto of_gyro = [](double v) { return v / kDegree * kSecondsPerHour; };
  const auto of_accel = [](double v) { return v * 1e5; };
  static const std::vector<Known> all{
      {axis::gyro_white, "Gyro white", "imu.arw_deg_sqrt_h", "deg/sqrt(h)", of_white_gyro},
      {axis::accel_white, "Accel. white", "imu.vrw_m_s_sqrt_h", "m/s/sqrt(h)", of_white_accel},
      {axis::gyro_bias, "Gyro bias", "imu.gyro_bias_deg_h", "deg/h", of_gyro},
      {axis::accel_bias, "Accel. bias", "imu.accel_bias_mgal", "mGal", of_accel},
      {axis::fix_white, "Fixes", "gnss.sigma_scale", "", as_it_is},
      {axis::velocity, "Velocities", "sigmas of GNSS velocities, factor", "", as_it_is},
      {axis::slip, "Slip", "aids.nonholonomic_sigma_m_s", "m/s", as_it_is},
      {axis::bounce, "Up and down", "aids.nonholonomic_down_sigma_m_s", "m/s", as_it_is},
      {axis::wheel, "Wheels", "aids.wheel_speed_sigma_m_s", "m/s", as_it_is},
  };
  return all;
}

/// Sigmas of slip and wheels are learned as factors of what the filter took.
double unit_of(const calibration::NoiseAxis& what, const calibration::RecordedWay& way) {
  using calibration::NoiseOf;
  if (what.name == axis::slip.name) return told_sigma(way, NoiseOf::slip)[0];
  if (what.name == axis::bounce.name) return told_sigma(way, NoiseOf::slip)[1];
  if (what.name == axis::wheel.name) return told_sigma(way, NoiseOf::wheel)[0];
  return 1;
}

std::vector<LearnedValue> values_of(const Learned& learned, const calibration::RecordedWay& way) {
  std::vector<LearnedValue> values;
  for (const Known& known : known_axes()) {
    for (const LearnedAxis& one : learned.axes) {
      if (one.axis.name != known.axis.name) continue;
      const double unit = unit_of(one.axis, way);
      values.push_back({known.name, known.key, known.unit, known.shown(unit * one.told),
                        known.shown(unit * one.value), std::exp(one.log_sigma), one.observable,
                        one.profile_factors, one.profile});
    }
  }
  return values;
}

/// With what a survey of it completes.
Settings completed_for(const std::string& log, Settings settings, Console& console) {
  settings.calibrate.noise = "off";
  return Surveyor(console).complete(log, settings_for(log, settings));
}

calibration::RecordedWay way_of(const std::string& log, const Settings& completed,
                                Console& console) {
  calibration::RecordedWay way = recorded_way(log, completed, console);
  if (way.empty())
    throw DataError(
        fmt::format("'{}': no minute of it could be processed; see `foucault check`", log));
  return way;
}

exports::Json horizons_json(const std::vector<calibration::NormalizedError>& errors) {
  exports::Json json = exports::Json::array();
  for (const calibration::NormalizedError& e : errors)
    json.push_back(exports::Object()
                       .with("horizon_s", e.horizon_s)
                       .with("predictions", e.count)
                       .with("normalized_square", e.mean));
  return json;
}

std::string learn_json(const LearnResult& result) {
  exports::Json json = exports::Object()
                           .with("version", kVersion)
                           .with("command", result.command_line)
                           .with("logs", result.logs)
                           .with("length_s", result.length_s)
                           .with("passes", result.passes);
  for (const LearnedValue& v : result.values) {
    json["noise"][v.key] = exports::Object()
                               .with("unit", v.unit)
                               .with("told", v.told)
                               .with("value", v.value)
                               .with("sigma_factor", v.factor)
                               .with("observable", v.observable);
  }
  json["lasting_fix_errors"] = result.lasting
                                   ? exports::Json(exports::Object()
                                                       .with("sigmas", result.lasting->sigmas)
                                                       .with("tau_s", result.lasting->tau_s))
                                   : exports::Json(nullptr);
  json["horizons"] = exports::Object()
                         .with("before", horizons_json(result.before))
                         .with("after", horizons_json(result.after));
  return json.dump(2) + "\n";
}

/// For the page: what is learned while driving beside what the IMU does at rest.
std::optional<AllanResult> longest_rest(const LearnJob& job, Console& console) {
  constexpr double kLongEnough = 600;  // [s]
  std::optional<AllanResult> longest;
  for (const std::string& log : job.logs) {
    std::optional<AllanResult> of_log =
        allan_of_rest({log, job.settings, job.out, true, job.command_line}, kLongEnough, console);
    if (!of_log) continue;
    if (!longest || of_log->curve.length_s() > longest->curve.length_s()) longest = of_log;
  }
  return longest;
}

}  // namespace

LearnResult learn(const LearnJob& job, Console& console) {
  OutputDirectory out(job.out);
  LearnResult result;
  std::vector<calibration::RecordedWay> ways;
  Settings told = settings_for(job.logs.front(), job.settings);
  for (const std::string& log : job.logs) {
    const Settings completed = completed_for(log, job.settings, console);
    if (told.imu.preset == "auto") {
      told.imu = completed.imu;
      told.gnss.sigma_scale = completed.gnss.sigma_scale;
    }
    ways.push_back(way_of(log, completed, console));
    result.logs.push_back(std::filesystem::path(log).filename().string());
    result.length_s += length_s(ways.back());
  }
  NoiseModel model;
  model.imu = told.imu.noise();
  calibration::LearnOptions options;
  options.axes = calibration::axes_of(ways).all();
  options.profile = options.lasting = true;
  console.progress("learning", 0);
  const Learned learned = calibration::learn(ways, model, options);
  console.clear_progress();

  result.lasting = learned.lasting;
  result.values = values_of(learned, ways.front());
  result.before = learned.before;
  result.after = learned.after;
  result.passes = learned.passes;
  result.out = job.out;
  result.command_line = job.command_line;
  Settings with = told;
  noise_of(learned.noise, ways.front()).apply_to(with);
  with.calibrate.noise = "off";
  result.config = dump_config(with);
  exports::write_text_file(out.staging() / "learned.yaml", result.config);
  exports::write_text_file(out.staging() / "metrics.json", learn_json(result));
  if (job.report) result.rest = longest_rest(job, console);
  if (job.report) page::write_report(learn_page(result), (out.staging() / "report").string());
  if (!job.report) out.withdraw("report");
  out.commit();
  return result;
}

std::vector<std::string> summary_lines(const LearnResult& result) {
  std::vector<std::string> lines;
  for (const LearnedValue& v : result.values) {
    lines.push_back(
        v.observable
            ? fmt::format("{:<34} {:>9.3g} {:<12} told {:.3g}; one sigma: times or by {:.2f}",
                          v.key, v.value, v.unit, v.told, v.factor)
            : fmt::format("{:<34} {:>9} {:<12} told {:.3g}; not observable in this recording",
                          v.key, "", v.unit, v.told));
  }
  if (result.lasting) {
    lines.push_back(fmt::format(
        "errors of fixes that last: {:.2g} of their sigmas, for {:.0f} s (no method models them)",
        result.lasting->sigmas, result.lasting->tau_s));
  }
  for (std::size_t i = 0; i < result.after.size(); ++i) {
    const std::string horizon = result.after[i].horizon_s > 0
                                    ? fmt::format("{:.0f} s ahead", result.after[i].horizon_s)
                                    : std::string("next fix");
    lines.push_back(
        fmt::format("errors squared by their variance, {:<11} {:>7.2f} as told, {:.2f} "
                    "as learned (1 is right), {} predictions",
                    horizon, result.before[i].mean, result.after[i].mean, result.after[i].count));
  }
  lines.push_back(
      fmt::format("written    {}/learned.yaml, for `foucault run LOG --config`", result.out));
  return lines;
}

}  // namespace foucault::app
