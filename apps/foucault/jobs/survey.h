#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "foucault/calibration/learn.h"
#include "foucault/evaluation/run_metrics.h"
#include "settings.h"

namespace foucault::app {

/// Noise that a recording shows, as the settings have it.
struct LearnedNoise {
  imu::ImuNoise imu;
  double sigma_scale = 1;                   ///< factor on gnss.sigma_scale
  std::optional<Eigen::Vector2d> slip_m_s;  ///< to the right, downward; if wheels were assumed
  std::optional<double> wheel_m_s;
  std::string preset;    ///< that is nearest, where none was told
  bool is_news = false;  ///< the recording contradicts what was told

  void apply_to(Settings& settings) const;
};

/// What a filter finds in a log before it is processed.
struct Survey {
  double time_offset_s = 0;        ///< calibrate.time_offset_s; what is left is small
  double time_offset_sigma_s = 0;  ///< calibrate.time_offset_sigma_s, of what is left
  state::CalibrateOptions::Carried carried;
  std::optional<LearnedNoise> noise;  ///< as told where the recording does not contradict it
  /// At the end of the log, as users know them: value and sigma, and that of what was told.
  std::vector<evaluation::CalibratedBlock> blocks, told;
  std::string failure;  ///< why the log cannot be processed with what was found; empty if it can
};

/// The way of a filter through a log with settings that are complete; empty if it cannot be
/// processed or is shorter than a minute.
calibration::RecordedWay recorded_way(const std::string& log, const Settings& settings,
                                      Console& console);

/// What of imu and gnss is random, in the names of the settings.
std::string noise_text(const Settings& settings);

/// As the settings have it. `way`: on which it was learned.
LearnedNoise noise_of(const calibration::NoiseModel& model, const calibration::RecordedWay& way);

/// Looks through logs where the settings leave something to the recording (`auto`, the time
/// offset): a filter with all that may be estimated goes through the log; what it does not come to
/// use is not estimated afterwards. An estimate of a time offset is of the first order: fixes are
/// moved by it and it is made again, until what is left is small. What the filter cannot process
/// changes nothing. With imu.preset `auto` the noise is learned on the way of a filter that was
/// told a coarse one, from the preset that makes that way the most likely, and once more on the way
/// of one that knows it.
class Surveyor {
 public:
  explicit Surveyor(Console& console) : console_(console) {}

  /// Settings without `auto` among calibrate.* and as imu.preset, from settings_for(). A log is
  /// looked through once.
  Settings complete(const std::string& log, const Settings& settings);
  /// What it found for that; null if there was nothing to look for.
  const Survey* found(const std::string& log) const;
  /// What it warned of, without the name of the log.
  std::vector<std::string> warnings(const std::string& log) const;

 private:
  Survey survey(const std::string& log, Settings settings);
  LearnedNoise learn_noise(const calibration::RecordedWay& way, const Settings& settings);
  std::optional<LearnedNoise> find_noise(const calibration::RecordedWay& way,
                                         const state::ImuBias& bias,
                                         const std::optional<LearnedNoise>& before,
                                         const Settings& settings);

  void warn(const std::string& log, const std::string& text);

  Console& console_;
  std::map<std::string, Survey> seen_;
  std::map<std::string, std::vector<std::string>> warnings_;
};

}  // namespace foucault::app
