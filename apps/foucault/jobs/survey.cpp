#include "jobs/survey.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "foucault/calibration/noise_fit.h"
#include "foucault/core/error.h"
#include "foucault/rawlog/rawlog_source.h"
#include "methods.h"

namespace foucault::app {
namespace {

class Watcher : public state::Sink {
 public:
  void epoch(const state::Epoch& epoch) override {
    way.epoch(epoch);
    last = epoch;
  }
  void fix(const state::FixResult& result) override {
    if (result.verdict == state::FixVerdict::used) way.used(result.t_ns);
  }
  void observation(const state::ObservationResult& result) override {
    if (result.used) ++used[std::string(result.name)];
  }

  std::optional<state::Epoch> last;
  std::map<std::string, int> used;
  calibration::WayRecorder way;
};

/// A filter through the log; none where it cannot be processed, which the run itself tells.
std::optional<Watcher> look_through(const std::string& log, const Settings& settings,
                                    Console& console) {
  Watcher watcher;
  try {
    rawlog::RawlogSource source(log, settings.imu.sample_kind(), settings.rawlog);
    const std::unique_ptr<state::Estimator> estimator =
        find_method("ekf").make(settings, source.mounting(), watcher);
    while (const std::optional<Measurement> measurement = source.next()) {
      watcher.way.add(*measurement);
      estimator->process(*measurement);
      console.progress("looking through", source.progress());
    }
    estimator->finish();
  } catch (const DataError&) {
    return std::nullopt;
  }
  console.clear_progress();
  if (!watcher.last) return std::nullopt;
  return watcher;
}

/// What is left of the offset at the end of the log is more than small, and is known.
std::optional<double> rest_of_offset(const Watcher& watcher, const state::Layout& layout) {
  constexpr double kSmall = 0.002;  // [s]; at 3 m/s^2 the second order is 6 micrometres
  const state::SlowBlock* offset = layout.find(state::block::time_offset);
  if (!offset) return std::nullopt;
  const double value = watcher.last->slow[offset->index];
  const double sigma = std::sqrt(state::part(watcher.last->covariance, *offset, *offset)(0, 0));
  if (std::abs(value) < std::max(kSmall, sigma)) return std::nullopt;
  return value;
}

bool uses(const Watcher& watcher, const char* aid) {
  constexpr int kTold = 10;  // fewer tell nothing of what they depend on
  const auto count = watcher.used.find(aid);
  return count != watcher.used.end() && count->second >= kTold;
}

bool leaves_open(const Settings& settings) {
  const state::CalibrateOptions& c = settings.calibrate;
  const measurement::AidOptions& aids = settings.aids;
  if (c.mode == "none") return false;
  const bool wheels = aids.uses(aids.nonholonomic) || aids.uses(aids.wheel_speed);
  return c.time_offset != "off" || c.imu_noise != "off" ||
         (wheels &&
          (c.mounting == "auto" || c.wheel_scale == "auto" || c.wheel_lever_arm == "auto"));
}

}  // namespace

/// The noise is raised once the clocks agree to about what is linear, after the first pass.
Survey Surveyor::survey(const std::string& log, Settings settings) {
  constexpr int kMostPasses = 4;
  constexpr double kMost = 1;  // [s]; as the key
  bool asked = false;          // for the noise
  Survey found;
  found.time_offset_s = settings.calibrate.time_offset_s;
  settings.calibrate = settings.calibrate.resolved({true, true});
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::optional<Watcher> watcher = look_through(log, settings, console_);
    if (!watcher) break;
    found.carried = {uses(*watcher, "nonholonomic"), uses(*watcher, "wheel_speed")};
    const std::optional<double> rest = rest_of_offset(*watcher, settings.calibrate.layout());
    const bool moves = rest && std::abs(found.time_offset_s + *rest) < kMost;
    const bool asks = settings.calibrate.imu_noise == "on" && !asked && (pass > 0 || !moves);
    asked |= asks;
    const bool raised = asks && raise_noise(log, *watcher->way.way(), settings, found);
    if (moves) {
      found.time_offset_s += *rest;
      settings.calibrate.time_offset_s = settings.rawlog.fix_delay_s = found.time_offset_s;
    }
    if (!moves && !raised) break;
  }
  return found;
}

/// False if the recording does not contradict it.
bool Surveyor::raise_noise(const std::string& log, const calibration::RecordedWay& way,
                           Settings& settings, Survey& found) {
  console_.progress("noise of the IMU", 0);
  const calibration::NoiseFit fit =
      calibration::raised_noise(way, settings.imu.noise(), settings.calibrate.layout());
  console_.clear_progress();
  if (fit.gain == 0) return false;
  found.noise = fit.noise;
  settings.imu = settings.imu.with(fit.noise);
  console_.warn(fmt::format(
      "{}: the recording shows more noise of the IMU than was told, which is taken: "
      "imu.arw_deg_sqrt_h {:.3g}, vrw_m_s_sqrt_h {:.3g}, gyro_bias_deg_h {:.3g}, accel_bias_mgal "
      "{:.3g} (calibrate.imu_noise=off: as told)",
      log, *settings.imu.arw_deg_sqrt_h, *settings.imu.vrw_m_s_sqrt_h,
      *settings.imu.gyro_bias_deg_h, *settings.imu.accel_bias_mgal));
  return true;
}

Settings Surveyor::complete(const std::string& log, const Settings& settings) {
  Settings completed = settings;
  if (!leaves_open(settings)) {
    completed.calibrate = settings.calibrate.resolved({});
    return completed;
  }
  auto found = seen_.find(log);
  if (found == seen_.end()) found = seen_.emplace(log, survey(log, settings)).first;
  completed.calibrate = settings.calibrate.resolved(found->second.carried);
  if (found->second.noise) completed.imu = settings.imu.with(*found->second.noise);
  if (settings.calibrate.time_offset != "off") {
    completed.calibrate.time_offset_s = completed.rawlog.fix_delay_s = found->second.time_offset_s;
  }
  return completed;
}

}  // namespace foucault::app
