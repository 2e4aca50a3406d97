#include "jobs/allan_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/diagnosis/rest_facts.h"
#include "foucault/export/json_object.h"
#include "foucault/export/text_file.h"
#include "foucault/page/report_page.h"
#include "foucault/rawlog/rawlog_source.h"
#include "output_directory.h"
#include "pages/allan_page.h"
#include "version.h"

namespace foucault::app {
namespace {

using calibration::AllanCoefficient;
using calibration::SixAxes;

/// Samples are wanted as they were recorded, whatever they mean: no trapezoids between them.
rawlog::RawlogSource samples_of(const AllanJob& job) {
  return rawlog::RawlogSource(job.log, imu::SampleKind::interval_mean, job.settings.rawlog);
}

struct FoundRests {
  std::vector<diagnosis::Rest> rests;
  double interval_s = 0;  ///< of samples, the mean
};

constexpr double kShortestRest = 10;  // [s]

FoundRests rests_of(const AllanJob& job, Console& console) {
  rawlog::RawlogSource source = samples_of(job);
  diagnosis::RestWatch watch;
  double length = 0, count = 0;
  while (const std::optional<Measurement> measurement = source.next()) {
    if (const auto* fix = std::get_if<GnssFix>(&*measurement)) watch.add(*fix);
    if (const auto* increment = std::get_if<ImuIncrement>(&*measurement)) {
      watch.add(*increment);
      length += increment->dt();
      ++count;
    }
    console.progress("finding rests", source.progress());
  }
  FoundRests found{{}, length / count};
  for (const diagnosis::Rest& rest : watch.rests()) {
    if (seconds_between(rest.begin_ns, rest.end_ns) >= kShortestRest) found.rests.push_back(rest);
  }
  return found;
}

/// Samples at rest and in motion; what is near the ends of a rest is neither.
class Collector {
 public:
  explicit Collector(const FoundRests& found)
      : rests_(found.rests),
        allan_(found.interval_s),
        rest_spectrum_(found.interval_s, segment(found.interval_s)),
        motion_spectrum_(found.interval_s, segment(found.interval_s)) {}

  void add(const ImuIncrement& increment) {
    constexpr int64_t kMargin = 4 * kNanosecondsPerSecond;
    while (next_ < rests_.size() && increment.t_end_ns > rests_[next_].end_ns + kMargin) ++next_;
    if (increment.t_begin_ns != last_ns_) interrupt();
    last_ns_ = increment.t_end_ns;
    SixAxes sample;
    sample << increment.dtheta_b, increment.dvel_b;
    sample /= increment.dt();
    if (next_ == rests_.size() || increment.t_begin_ns < rests_[next_].begin_ns - kMargin) {
      motion_spectrum_.add(sample);
    } else if (increment.t_begin_ns >= rests_[next_].begin_ns &&
               increment.t_end_ns <= rests_[next_].end_ns) {
      rest_spectrum_.add(sample);
      allan_.add(sample);
    } else {
      interrupt();
    }
  }

  void give(AllanResult& result) const {
    result.curve = allan_.curve();
    result.at_rest = rest_spectrum_.spectrum();
    result.in_motion = motion_spectrum_.spectrum();
  }

 private:
  /// Five seconds or a little more: lines a fifth of a hertz apart are two.
  static std::size_t segment(double interval_s) {
    std::size_t length = 2;
    while (static_cast<double>(length) * interval_s < 5) length *= 2;
    return length;
  }

  void interrupt() {
    allan_.interrupt();
    rest_spectrum_.interrupt();
    motion_spectrum_.interrupt();
  }

  std::vector<diagnosis::Rest> rests_;
  std::size_t next_ = 0;
  int64_t last_ns_ = 0;
  calibration::AllanDeviation allan_;
  calibration::WelchSpectrum rest_spectrum_, motion_spectrum_;
};

/// How a sensor's numbers are called and shown.
struct Names {
  const char *name, *key, *unit, *density_unit;
  double shown, density_shown;
  const char *white, *white_unit, *flicker, *walk, *walk_unit, *bias;
  double white_shown;
};

const std::array<Names, 2>& names() {
  static const std::array<Names, 2> all{{
      {"Gyroscope", "gyroscope", "deg/h", "deg/s/√Hz", kSecondsPerHour / kDegree, 1 / kDegree,
       "arw_deg_sqrt_h", "deg/sqrt(h)", "bias_instability_deg_h", "rate_random_walk_deg_h_sqrt_h",
       "deg/h/sqrt(h)", "gyro_bias_deg_h", 60 / kDegree},
      {"Accelerometer", "accelerometer", "mGal", "m/s²/√Hz", 1e5, 1, "vrw_m_s_sqrt_h",
       "m/s/sqrt(h)", "bias_instability_mgal", "random_walk_mgal_sqrt_h", "mGal/sqrt(h)",
       "accel_bias_mgal", 60},
  }};
  return all;
}

AllanValue value_of(const char* name, const char* key, const char* unit,
                    const std::optional<AllanCoefficient>& coefficient, double shown) {
  AllanValue value{name, key, unit, std::nullopt, 1};
  if (!coefficient) return value;
  value.value = shown * coefficient->value;
  value.factor = std::exp(coefficient->log_sigma);
  return value;
}

std::vector<AllanValue> values_of(const Names& as, const calibration::AllanFit& fit) {
  const double per_sqrt_hour = std::sqrt(static_cast<double>(kSecondsPerHour));
  return {
      value_of("Random walk N", as.white, as.white_unit, fit.white, as.white_shown),
      value_of("Bias instability B", as.flicker, as.unit, fit.flicker, as.shown),
      value_of("Rate random walk K", as.walk, as.walk_unit, fit.walk, as.shown * per_sqrt_hour),
      value_of("K as Markov bias", as.bias, as.unit, fit.walk,
               as.shown * std::sqrt(fit.bias_tau_s / 2)),
  };
}

AllanSensor sensor_of(const AllanResult& result, int sensor) {
  constexpr std::size_t kLines = 6;
  const Names& as = names()[static_cast<std::size_t>(sensor)];
  const int first = 3 * sensor;
  AllanSensor out{as.name,          as.key, as.unit, as.shown, as.density_unit,
                  as.density_shown, {},     {},      {}};
  const std::vector<int> all{first, first + 1, first + 2};
  const std::array<std::vector<int>, 4> axes{{all, {first}, {first + 1}, {first + 2}}};
  const std::array<const char*, 4> called{"all axes", "x", "y", "z"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const calibration::AllanFit fit = calibration::fit(result.curve, axes[i], result.bias_tau_s);
    out.fitted[i] = {called[i], axes[i], fit, values_of(as, fit)};
  }
  out.lines_at_rest = calibration::lines_of(result.at_rest, all, kLines);
  out.lines_in_motion = calibration::lines_of(result.in_motion, all, kLines);
  return out;
}

std::string allan_csv(const AllanResult& result) {
  std::string text = "tau_s";
  for (const AllanSensor& sensor : result.sensors) {
    const std::string unit = sensor.key == "gyroscope" ? "deg_h" : "mgal";
    for (const char* what : {"x", "y", "z", "all", "fit"})
      text += fmt::format(",{}_{}_{}", sensor.key, what, unit);
    text += fmt::format(",{}_degrees_of_freedom", sensor.key);
  }
  text += "\n";
  for (const calibration::AllanPoint& point : result.curve.points) {
    text += fmt::format("{:.6g}", point.tau_s);
    for (const AllanSensor& sensor : result.sensors) {
      const AllanSensor::Fitted& all = sensor.fitted[0];
      for (const std::size_t i : {1, 2, 3, 0})
        text += fmt::format(",{:.6g}", sensor.shown * std::sqrt(calibration::variance_of(
                                                          point, sensor.fitted[i].axes)));
      text += fmt::format(",{:.6g},{:.4g}", sensor.shown * all.fit.deviation(point.tau_s),
                          calibration::degrees_of_freedom(result.curve, point.samples, 3, all.fit));
    }
    text += "\n";
  }
  return text;
}

exports::Json lines_json(const std::vector<calibration::SpectralLine>& lines) {
  exports::Json json = exports::Json::array();
  for (const calibration::SpectralLine& line : lines)
    json.push_back(exports::Object()
                       .with("frequency_hz", line.frequency_hz)
                       .with("rms", line.rms)
                       .with("over_beside", line.ratio));
  return json;
}

exports::Json sensor_json(const AllanSensor& sensor) {
  exports::Json json = exports::Json::object();
  for (const AllanSensor::Fitted& fitted : sensor.fitted) {
    exports::Json& of_axes = json[fitted.axes.size() > 1 ? "all" : fitted.name];
    for (const AllanValue& v : fitted.values)
      of_axes[v.key] = v.value ? exports::Json(exports::Object()
                                                   .with("value", *v.value)
                                                   .with("sigma_factor", v.factor)
                                                   .with("unit", v.unit))
                               : exports::Json(nullptr);
    of_axes["fitted_from_s"] = fitted.fit.from_s;
    of_axes["fitted_to_s"] = fitted.fit.to_s;
  }
  json["vibration"] = exports::Object()
                          .with("unit", sensor.key == "gyroscope" ? "rad/s" : "m/s^2")
                          .with("at_rest", lines_json(sensor.lines_at_rest))
                          .with("in_motion", lines_json(sensor.lines_in_motion));
  return json;
}

std::string allan_json(const AllanResult& result) {
  exports::Json json = exports::Object()
                           .with("version", kVersion)
                           .with("command", result.command_line)
                           .with("log", result.log)
                           .with("rests", result.rests)
                           .with("rest_s", result.curve.length_s())
                           .with("longest_rest_s", result.curve.longest_s())
                           .with("rate_hz", 1 / result.curve.interval_s)
                           .with("bias_tau_s", result.bias_tau_s);
  for (const AllanSensor& sensor : result.sensors) json[sensor.key] = sensor_json(sensor);
  return json.dump(2) + "\n";
}

std::string lines_text(const std::vector<calibration::SpectralLine>& lines) {
  std::string text;
  for (const calibration::SpectralLine& line : lines)
    text += fmt::format("{}{:.4g} Hz", text.empty() ? "" : ", ", line.frequency_hz);
  return text;
}

AllanResult measured(const AllanJob& job, const FoundRests& found, Console& console) {
  AllanResult result;
  result.log = std::filesystem::path(job.log).filename().string();
  result.out = job.out;
  result.report = job.report;
  result.command_line = job.command_line;
  result.bias_tau_s = settings_for(job.log, job.settings).imu.noise().bias_tau;
  result.rests = static_cast<int>(found.rests.size());
  Collector collector(found);
  rawlog::RawlogSource source = samples_of(job);
  while (const std::optional<Measurement> measurement = source.next()) {
    if (const auto* increment = std::get_if<ImuIncrement>(&*measurement)) collector.add(*increment);
    console.progress("averaging", source.progress());
  }
  console.clear_progress();
  if (source.damage()) console.warn(*source.damage());
  collector.give(result);
  for (int i = 0; i < 2; ++i) result.sensors[static_cast<std::size_t>(i)] = sensor_of(result, i);
  return result;
}

}  // namespace

std::optional<AllanResult> allan_of_rest(const AllanJob& job, double least_s, Console& console) {
  const FoundRests found = rests_of(job, console);
  double seconds = 0;
  for (const diagnosis::Rest& rest : found.rests)
    seconds += seconds_between(rest.begin_ns, rest.end_ns);
  if (seconds < least_s) return std::nullopt;
  return measured(job, found, console);
}

AllanResult allan(const AllanJob& job, Console& console) {
  OutputDirectory out(job.out);
  const FoundRests found = rests_of(job, console);
  if (found.rests.empty())
    throw DataError(fmt::format(
        "'{}': nowhere at rest for {:.0f} s as its fixes and its IMU show, and the Allan deviation "
        "is one of rest; record the IMU standing still (minutes for white noise, hours for the "
        "bias), or use `foucault learn`",
        job.log, kShortestRest));
  AllanResult result = measured(job, found, console);
  exports::write_text_file(out.staging() / "allan.csv", allan_csv(result));
  exports::write_text_file(out.staging() / "metrics.json", allan_json(result));
  if (job.report) page::write_report(allan_page(result), (out.staging() / "report").string());
  if (!job.report) out.withdraw("report");
  out.commit();
  return result;
}

std::vector<std::string> summary_lines(const AllanResult& result) {
  std::vector<std::string> lines{
      fmt::format("{} rests, {:.0f} s, the longest {:.0f} s; {:.4g} samples a second", result.rests,
                  result.curve.length_s(), result.curve.longest_s(), 1 / result.curve.interval_s)};
  for (const AllanSensor& sensor : result.sensors) {
    for (const AllanValue& v : sensor.fitted[0].values)
      lines.push_back(v.value ? fmt::format("{:<30} {:>10.3g} {:<14} one sigma: times or by {:.2f}",
                                            v.key, *v.value, v.unit, v.factor)
                              : fmt::format("{:<30} {:>10} {:<14} not told by this recording",
                                            v.key, "", v.unit));
  }
  for (const AllanSensor& sensor : result.sensors) {
    for (const auto& [when, found] : {std::pair{"at rest", &sensor.lines_at_rest},
                                      std::pair{"in motion", &sensor.lines_in_motion}})
      if (!found->empty())
        lines.push_back(fmt::format("{} shakes {} at {}", sensor.name, when, lines_text(*found)));
  }
  const std::vector<std::string> written = written_lines(result.out, result.report);
  lines.insert(lines.end(), written.begin(), written.end());
  return lines;
}

}  // namespace foucault::app
