#include "jobs/survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "foucault/calibration/learn.h"
#include "foucault/core/error.h"
#include "foucault/diagnosis/fix_judge.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/state/told_blocks.h"
#include "methods.h"

namespace foucault::app {
namespace {

class Watcher : public state::Sink {
 public:
  void epoch(const state::Epoch& epoch) override { last = epoch; }
  void observation(const state::ObservationResult& result) override {
    if (result.used) ++used[std::string(result.name)];
  }

  std::optional<state::Epoch> last;
  state::Told told;
  std::map<std::string, int> used;
  calibration::UnfoldedWay way;
};

/// One that leaves its way, for the noise, or that does not.
std::unique_ptr<measurement::Navigator> filter_of(const Settings& settings, bool leaves_way,
                                                  calibration::UnfoldedWay& way) {
  ekf::EkfOptions coarse = settings.ekf;
  coarse.cov_interval_s = 0.5;
  const imu::ImuNoise noise = settings.imu.noise();
  const state::Layout layout = settings.calibrate.layout();
  if (leaves_way) return std::make_unique<calibration::WayRecorder>(noise, layout, coarse, way);
  return std::make_unique<ekf::EkfNavigator>(noise, layout, coarse);
}

/// A filter through the log; none where it cannot be processed, which the run itself tells.
std::optional<Watcher> look_through(const std::string& log, const Settings& settings,
                                    bool leaves_way, Console& console) {
  Watcher watcher;
  try {
    rawlog::RawlogSource source(log, settings.imu.sample_kind(), settings.rawlog);
    watcher.told = {settings.calibrate.layout(), settings.calibrate.time_offset_s,
                    source.lever_arm(), source.mounting().q_v_b};
    const std::unique_ptr<state::Estimator> estimator =
        drive(filter_of(settings, leaves_way, watcher.way), settings, source.mounting(), watcher);
    while (const std::optional<Measurement> measurement = source.next()) {
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
  return c.time_offset != "off" || c.noise != "off" ||
         (wheels && (c.mounting == "auto" || c.wheel_scale == "auto" ||
                     c.wheel_lever_arm == "auto" || c.cornering_compliance == "auto"));
}

std::string noise_text(const Settings& settings) {
  std::string text = fmt::format(
      "imu.arw_deg_sqrt_h {:.3g}, vrw_m_s_sqrt_h {:.3g}, gyro_bias_deg_h {:.3g}, accel_bias_mgal "
      "{:.3g}, gnss.sigma_scale {:.2g}",
      *settings.imu.arw_deg_sqrt_h, *settings.imu.vrw_m_s_sqrt_h, *settings.imu.gyro_bias_deg_h,
      *settings.imu.accel_bias_mgal, settings.gnss.sigma_scale);
  const measurement::AidOptions& aids = settings.aids;
  if (aids.nonholonomic_sigma_m_s)
    text += fmt::format(", aids.nonholonomic_sigma_m_s {:.2g} (down {:.2g})",
                        *aids.nonholonomic_sigma_m_s,
                        aids.nonholonomic_down_sigma_m_s.value_or(*aids.nonholonomic_sigma_m_s));
  if (aids.wheel_speed_sigma_m_s)
    text += fmt::format(", wheel_speed_sigma_m_s {:.2g}", *aids.wheel_speed_sigma_m_s);
  return text;
}

}  // namespace

calibration::RecordedWay recorded_way(const std::string& log, const Settings& settings,
                                      Console& console) {
  const std::optional<Watcher> watcher = look_through(log, settings, true, console);
  if (!watcher) return {};
  return calibration::folded(watcher->way, watcher->last->slow);
}

LearnedNoise noise_of(const calibration::NoiseModel& model, const calibration::RecordedWay& way) {
  using calibration::NoiseOf;
  LearnedNoise noise;
  noise.imu = model.imu;
  noise.imu.gyro_turn_on_sigma = std::max(noise.imu.gyro_turn_on_sigma, noise.imu.gyro_bias_sigma);
  noise.imu.accel_turn_on_sigma =
      std::max(noise.imu.accel_turn_on_sigma, noise.imu.accel_bias_sigma);
  noise.sigma_scale = model.fix_white;
  const Eigen::Vector3d slip = told_sigma(way, NoiseOf::slip);
  const auto sigma = [](double factor, double told) {
    return std::hypot(factor * told, calibration::kLeastWheelNoise);
  };
  if (slip[0] > 0)
    noise.slip_m_s = Eigen::Vector2d(sigma(model.slip, slip[0]), sigma(model.bounce, slip[1]));
  const double wheel = told_sigma(way, NoiseOf::wheel)[0];
  if (wheel > 0) noise.wheel_m_s = sigma(model.wheel, wheel);
  return noise;
}

void LearnedNoise::apply_to(Settings& settings) const {
  settings.imu = settings.imu.with(imu);
  settings.gnss.sigma_scale *= sigma_scale;
  if (slip_m_s) {
    settings.aids.nonholonomic_sigma_m_s = slip_m_s->x();
    settings.aids.nonholonomic_down_sigma_m_s = slip_m_s->y();
  }
  if (wheel_m_s) settings.aids.wheel_speed_sigma_m_s = *wheel_m_s;
}

/// The noise is learned once the clocks agree to about what is linear, after the first pass; with
/// it the log is gone through again.
Survey Surveyor::survey(const std::string& log, Settings settings) {
  constexpr int kMostPasses = 4;
  constexpr double kMost = 1;  // [s]; as the key
  bool asks_noise = settings.calibrate.noise != "off";
  Survey found;
  found.time_offset_s = settings.calibrate.time_offset_s;
  settings.calibrate = settings.calibrate.resolved({true, true});
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::optional<Watcher> watcher = look_through(log, settings, asks_noise, console_);
    if (!watcher) break;
    found.blocks = evaluation::calibrated_blocks(
        state::as_users_know(*watcher->last, watcher->told), watcher->told.layout);
    found.told = evaluation::calibrated_blocks(state::prior_as_users_know(watcher->told),
                                               watcher->told.layout);
    found.carried = {uses(*watcher, "nonholonomic"), uses(*watcher, "wheel_speed")};
    const std::optional<double> rest = rest_of_offset(*watcher, settings.calibrate.layout());
    const bool moves = rest && std::abs(found.time_offset_s + *rest) < kMost;
    const bool learns = asks_noise && !watcher->way.empty() && (pass > 0 || !moves);
    if (learns) {
      asks_noise = false;
      found.noise =
          learn_noise(log, calibration::folded(watcher->way, watcher->last->slow), settings);
      found.noise->apply_to(settings);
    }
    if (moves) {
      found.time_offset_s += *rest;
      settings.calibrate.time_offset_s = settings.rawlog.fix_delay_s = found.time_offset_s;
    }
    if (!moves && !learns) break;
  }
  return found;
}

/// What the methods take of slip and of the wheels' speed is found whatever was told. The rest as
/// it was told, unless the recording contradicts it: twice the gain of the likelihood would be a
/// chi-square of as many degrees of freedom as numbers were told, at the next fix and at each
/// horizon.
LearnedNoise Surveyor::learn_noise(const std::string& log, const calibration::RecordedWay& way,
                                   const Settings& settings) {
  constexpr double kChance = 1e-4;
  calibration::NoiseModel told;
  told.imu = settings.imu.noise();
  const std::vector<calibration::RecordedWay> ways{way};
  const calibration::NoiseAxes axes = calibration::axes_of(ways);
  console_.progress("noise", 0);
  const calibration::Learned aids = calibration::learn(ways, told, {axes.of_aids});
  calibration::LearnOptions of_all{axes.all()};
  of_all.lasting = true;
  const calibration::Learned all = calibration::learn(ways, aids.noise, of_all);
  console_.clear_progress();
  const double tries = 1 + static_cast<double>(calibration::LearnOptions{}.horizons_s.size());
  const double chance =
      tries * diagnosis::chi_square_tail(2 * all.gain, static_cast<int>(axes.told.size()));
  if (settings.calibrate.noise == "auto" && chance > kChance) return noise_of(aids.noise, way);
  const LearnedNoise noise = noise_of(all.noise, way);
  Settings with = settings;
  noise.apply_to(with);
  console_.warn(fmt::format(
      "{}: noise as the recording shows it, not as configured: {} (calibrate.noise=off: as "
      "configured)",
      log, noise_text(with)));
  return noise;
}

const Survey* Surveyor::found(const std::string& log) const {
  const auto found = seen_.find(log);
  return found == seen_.end() ? nullptr : &found->second;
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
  completed.calibrate.noise = "off";  // it is in the settings now
  if (found->second.noise) found->second.noise->apply_to(completed);
  if (settings.calibrate.time_offset != "off") {
    completed.calibrate.time_offset_s = completed.rawlog.fix_delay_s = found->second.time_offset_s;
  }
  return completed;
}

}  // namespace foucault::app
