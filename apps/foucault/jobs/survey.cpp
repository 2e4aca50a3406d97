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
  void fix(const state::FixResult& fix) override {
    if (fix.verdict != state::FixVerdict::used) return;
    const std::optional<double> square =
        evaluation::normalized_square(fix.innovation_n, fix.innovation_covariance);
    if (!square) return;
    ++fixes;
    nis_sum += *square;
  }
  void observation(const state::ObservationResult& result) override {
    if (result.used) ++used[std::string(result.name)];
  }
  /// Innovations are not much larger than their sigmas.
  bool is_believable() const {
    constexpr double kLargest = 1.5;  // as of a run without reservations
    return fixes > 0 && nis_sum < 3 * kLargest * kLargest * static_cast<double>(fixes);
  }

  std::optional<state::Epoch> last;
  state::Told told;
  std::map<std::string, int> used;
  int64_t fixes = 0;
  double nis_sum = 0;
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

/// A filter through the log; none where it cannot be processed, and why.
std::optional<Watcher> look_through(const std::string& log, const Settings& settings,
                                    bool leaves_way, Console& console, std::string& failure) {
  Watcher watcher;
  try {
    rawlog::RawlogSource source(log, settings.imu.sample_kind(), settings.rawlog);
    watcher.told = {settings.calibrate.layout(), settings.calibrate.time_offset_s,
                    source.lever_arm(), source.mounting().q_v_b};
    navigation::NavigationRun run(filter_of(settings, leaves_way, watcher.way),
                                  method_options(settings, source.mounting()).run, watcher);
    while (const std::optional<Measurement> measurement = source.next()) {
      run.process(*measurement);
      console.progress("looking through", source.progress());
    }
    run.finish();
  } catch (const DataError& error) {
    failure = error.what();
    return std::nullopt;
  }
  console.clear_progress();
  if (!watcher.last) return std::nullopt;
  return watcher;
}

/// Time offset at the end of a pass, and what may be taken for known of it before the next one.
struct OffsetLeft {
  double value = 0, sigma = 0;  ///< [s]
  /// What is left is of the second order; moved by it, fixes would say the same.
  bool small() const {
    constexpr double kSmall = 0.01;  // [s]; at 3 m/s^2 its second order is 0.15 mm
    return std::abs(value) < std::max(kSmall, sigma);
  }
  /// So wide that the same fixes count for a ninth at most when they are used again, or that they
  /// are in the linear range from the start: at 3 m/s^2 its second order is 0.6 mm. With the 0.3 s
  /// of users it is 14 cm, for which the first metres of a trip took an offset of many sigmas.
  double next_sigma(double told) const {
    constexpr double kReuse = 3, kLinear = 0.02;  // [s]
    return std::min(told, std::max(kReuse * sigma, kLinear));
  }
};

std::optional<OffsetLeft> offset_left(const Watcher& watcher, const state::Layout& layout) {
  const state::SlowBlock* offset = layout.find(state::block::time_offset);
  if (!offset) return std::nullopt;
  return OffsetLeft{watcher.last->slow[offset->index],
                    std::sqrt(state::part(watcher.last->covariance, *offset, *offset)(0, 0))};
}

bool uses(const Watcher& watcher, const char* aid) {
  constexpr int kTold = 10;  // fewer tell nothing of what they depend on
  const auto count = watcher.used.find(aid);
  return count != watcher.used.end() && count->second >= kTold;
}

/// Nobody said what the IMU is like.
bool is_untold(const Settings& settings) { return settings.imu.preset == "auto"; }

/// Throws UsageError if something of what is to be learned was told all the same.
void expect_untold(const imu::ImuOptions& told) {
  const std::pair<const char*, const std::optional<double>&> learned[]{
      {"arw_deg_sqrt_h", told.arw_deg_sqrt_h},
      {"vrw_m_s_sqrt_h", told.vrw_m_s_sqrt_h},
      {"gyro_bias_deg_h", told.gyro_bias_deg_h},
      {"accel_bias_mgal", told.accel_bias_mgal}};
  for (const auto& [key, value] : learned) {
    if (value)
      throw UsageError(fmt::format(
          "imu.{}: imu.preset auto learns it; leave it out, or name a preset beside it", key));
  }
}

imu::ImuOptions coarse(imu::ImuOptions options) {
  options.preset = "consumer";
  return options;
}

bool leaves_open(const Settings& settings) {
  const state::CalibrateOptions& c = settings.calibrate;
  const measurement::AidOptions& aids = settings.aids;
  if (is_untold(settings)) return true;
  if (c.mode == "none") return false;
  const bool wheels = aids.uses(aids.nonholonomic) || aids.uses(aids.wheel_speed);
  return c.time_offset != "off" || c.noise != "off" ||
         (aids.uses(aids.heading) && c.baseline_heading == "auto") ||
         (wheels && (c.mounting == "auto" || c.wheel_scale == "auto" ||
                     c.wheel_lever_arm == "auto" || c.cornering_compliance == "auto"));
}

std::vector<calibration::NoiseModel> models_of_presets(double bias_tau) {
  std::vector<calibration::NoiseModel> models;
  for (const std::string& name : imu::imu_preset_names()) {
    models.emplace_back().imu = imu::imu_preset(name);
    models.back().imu.bias_tau = bias_tau;
  }
  return models;
}

/// What nobody tells, the rest as it was told.
calibration::Learned learn_aids(const std::vector<calibration::RecordedWay>& ways,
                                const calibration::NoiseModel& told) {
  return calibration::learn(ways, told, {calibration::axes_of(ways).of_aids});
}

calibration::Learned learn_all(const std::vector<calibration::RecordedWay>& ways,
                               const calibration::NoiseModel& told) {
  calibration::LearnOptions options{calibration::axes_of(ways).all()};
  options.lasting = true;
  return calibration::learn(ways, told, options);
}

/// At least what was found.
double turn_on(double usual, const Eigen::Vector3d& bias) {
  return std::max(usual, std::sqrt(bias.squaredNorm() / 3));
}

}  // namespace

calibration::RecordedWay recorded_way(const std::string& log, const Settings& settings,
                                      Console& console) {
  std::string failure;
  const std::optional<Watcher> watcher = look_through(log, settings, true, console, failure);
  if (!watcher) return {};
  return calibration::folded(watcher->way, watcher->last->slow);
}

std::string noise_text(const Settings& settings) {
  const imu::ImuOptions imu = settings.imu.with(settings.imu.noise());
  std::string text = fmt::format(
      "imu.arw_deg_sqrt_h {:.3g}, vrw_m_s_sqrt_h {:.3g}, gyro_bias_deg_h {:.3g}, accel_bias_mgal "
      "{:.3g}, gnss.sigma_scale {:.2g}",
      *imu.arw_deg_sqrt_h, *imu.vrw_m_s_sqrt_h, *imu.gyro_bias_deg_h, *imu.accel_bias_mgal,
      settings.gnss.sigma_scale);
  const measurement::AidOptions& aids = settings.aids;
  if (aids.nonholonomic_sigma_m_s)
    text += fmt::format(", aids.nonholonomic_sigma_m_s {:.2g} (down {:.2g})",
                        *aids.nonholonomic_sigma_m_s,
                        aids.nonholonomic_down_sigma_m_s.value_or(*aids.nonholonomic_sigma_m_s));
  if (aids.wheel_speed_sigma_m_s)
    text += fmt::format(", wheel_speed_sigma_m_s {:.2g}", *aids.wheel_speed_sigma_m_s);
  return text;
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
  if (!preset.empty()) settings.imu.preset = preset;
  settings.gnss.sigma_scale *= sigma_scale;
  if (slip_m_s) {
    settings.aids.nonholonomic_sigma_m_s = slip_m_s->x();
    settings.aids.nonholonomic_down_sigma_m_s = slip_m_s->y();
  }
  if (wheel_m_s) settings.aids.wheel_speed_sigma_m_s = *wheel_m_s;
}

/// The noise is learned once the clocks agree to about what is linear, after the first pass; with
/// it the log is gone through again. A noise that nobody told is learned twice. One with which no
/// filter keeps to the fixes, where one did with what was told, is not what the IMU has (fixes that
/// are interpolated or filtered look better than they are).
Survey Surveyor::survey(const std::string& log, Settings settings) {
  constexpr int kMostPasses = 5;
  constexpr double kMost = 1;  // [s]; as the key
  const bool untold = is_untold(settings);
  if (untold) settings.imu = coarse(settings.imu);
  int questions = untold ? 2 : settings.calibrate.noise == "off" ? 0 : 1;
  const Settings told = settings;
  bool told_is_believable = false, keeps_to_fixes = true;
  Survey found;
  const double told_sigma_s = settings.calibrate.time_offset_sigma_s;
  found.time_offset_s = settings.calibrate.time_offset_s;
  found.time_offset_sigma_s = told_sigma_s;
  settings.calibrate = settings.calibrate.resolved({true, true, true});
  for (int pass = 0; pass < kMostPasses; ++pass) {
    found.failure.clear();
    const std::optional<Watcher> watcher =
        look_through(log, settings, questions > 0, console_, found.failure);
    keeps_to_fixes = watcher && watcher->is_believable();
    if (!watcher) break;
    if (!found.noise) told_is_believable = keeps_to_fixes;
    found.blocks = evaluation::calibrated_blocks(
        state::as_users_know(*watcher->last, watcher->told), watcher->told.layout);
    found.told = evaluation::calibrated_blocks(state::prior_as_users_know(watcher->told),
                                               watcher->told.layout);
    found.carried = {uses(*watcher, "nonholonomic"), uses(*watcher, "wheel_speed"),
                     uses(*watcher, "heading")};
    const std::optional<OffsetLeft> left = offset_left(*watcher, settings.calibrate.layout());
    const bool known = left && std::abs(found.time_offset_s + left->value) < kMost;
    const bool moves = known && !left->small();
    const bool learns = questions > 0 && !watcher->way.empty() && (pass > 0 || !moves);
    if (learns) {
      const calibration::RecordedWay way = calibration::folded(watcher->way, watcher->last->slow);
      std::optional<LearnedNoise> noise =
          untold ? find_noise(way, watcher->last->bias, found.noise, settings)
                 : learn_noise(way, settings);
      questions = noise ? questions - 1 : 0;
      if (noise) {
        noise->apply_to(settings);
        if (found.noise) noise->sigma_scale *= found.noise->sigma_scale;
        found.noise = std::move(noise);
      }
    }
    if (known) {
      found.time_offset_sigma_s = left->next_sigma(told_sigma_s);
      settings.calibrate.time_offset_sigma_s = found.time_offset_sigma_s;
    }
    if (moves) {
      found.time_offset_s += left->value;
      settings.calibrate.time_offset_s = settings.rawlog.fix_delay_s = found.time_offset_s;
    }
    if (!moves && !learns) break;
  }
  const bool is_news = found.noise && found.noise->is_news;
  if (is_news && told.calibrate.noise == "auto" && !keeps_to_fixes && told_is_believable) {
    Settings without = told;
    without.calibrate.noise = "off";
    warn(log,
         "noise as configured: with what the recording shows no filter keeps to its fixes, "
         "whose errors may last (calibrate.noise=on: as the recording shows it)");
    return survey(log, without);
  }
  if (is_news) {
    warn(log, fmt::format("noise as the recording shows it, not as configured: {} "
                          "(calibrate.noise=off: as configured)",
                          noise_text(settings)));
  }
  return found;
}

/// What the methods take of slip and of the wheels' speed is found whatever was told. The rest as
/// it was told, unless the recording contradicts it: twice the gain of the likelihood would be a
/// chi-square of as many degrees of freedom as numbers were told, at the next fix and at each
/// horizon.
LearnedNoise Surveyor::learn_noise(const calibration::RecordedWay& way, const Settings& settings) {
  constexpr double kChance = 1e-4;
  calibration::NoiseModel told;
  told.imu = settings.imu.noise();
  const std::vector<calibration::RecordedWay> ways{way};
  console_.progress("noise", 0);
  const calibration::Learned aids = learn_aids(ways, told);
  const calibration::Learned all = learn_all(ways, aids.noise);
  console_.clear_progress();
  const double tries = 1 + static_cast<double>(calibration::LearnOptions{}.horizons_s.size());
  const double chance =
      tries * diagnosis::chi_square_tail(2 * all.gain,
                                         static_cast<int>(calibration::axes_of(ways).told.size()));
  const bool is_news = settings.calibrate.noise == "on" || chance <= kChance;
  LearnedNoise noise = noise_of(is_news ? all.noise : aids.noise, way);
  noise.imu.learned = true;  // or confirmed
  noise.is_news = is_news;
  return noise;
}

/// From the nearest preset the first time (there is none `before`), then from what was learned.
/// Turn-on values are what presets say, or as large as the biases that the filter came to. None if
/// the way tells nothing.
std::optional<LearnedNoise> Surveyor::find_noise(const calibration::RecordedWay& way,
                                                 const state::ImuBias& bias,
                                                 const std::optional<LearnedNoise>& before,
                                                 const Settings& settings) {
  const std::vector<calibration::RecordedWay> ways{way};
  const imu::ImuNoise taken = settings.imu.noise();
  const std::vector<calibration::NoiseModel> presets = models_of_presets(taken.bias_tau);
  console_.progress("noise", 0);
  const std::size_t nearest = calibration::most_likely(ways, presets, {});
  calibration::NoiseModel told = presets[nearest];
  if (before) told.imu = taken;
  const calibration::Learned all = learn_all(ways, learn_aids(ways, told).noise);
  console_.clear_progress();
  const auto is_told = [](const calibration::LearnedAxis& one) { return one.observable; };
  if (std::none_of(all.axes.begin(), all.axes.end(), is_told)) return std::nullopt;
  LearnedNoise noise = noise_of(all.noise, way);
  noise.imu.learned = true;
  noise.imu.gyro_turn_on_sigma = turn_on(noise.imu.gyro_turn_on_sigma, bias.gyro);
  noise.imu.accel_turn_on_sigma = turn_on(noise.imu.accel_turn_on_sigma, bias.accel);
  noise.preset = imu::imu_preset_names()[nearest];
  return noise;
}

const Survey* Surveyor::found(const std::string& log) const {
  const auto found = seen_.find(log);
  return found == seen_.end() ? nullptr : &found->second;
}

std::vector<std::string> Surveyor::warnings(const std::string& log) const {
  const auto found = warnings_.find(log);
  return found == warnings_.end() ? std::vector<std::string>() : found->second;
}

void Surveyor::warn(const std::string& log, const std::string& text) {
  console_.warn(log + ": " + text);
  warnings_[log].push_back(text);
}

Settings Surveyor::complete(const std::string& log, const Settings& settings) {
  Settings completed = settings;
  if (is_untold(settings)) expect_untold(settings.imu);
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
    completed.calibrate.time_offset_sigma_s = found->second.time_offset_sigma_s;
  }
  if (is_untold(completed)) {
    completed.imu = coarse(completed.imu);
    warn(log, fmt::format("too short to tell the noise of its IMU; imu.preset={} instead of auto",
                          completed.imu.preset));
  }
  return completed;
}

}  // namespace foucault::app
