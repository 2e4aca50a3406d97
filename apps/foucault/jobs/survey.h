#pragma once

#include <map>
#include <optional>
#include <string>

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

  void apply_to(Settings& settings) const;
};

/// What a filter finds in a log before it is processed.
struct Survey {
  double time_offset_s = 0;  ///< calibrate.time_offset_s; what is left is small
  state::CalibrateOptions::Carried carried;
  std::optional<LearnedNoise> noise;  ///< as told where the recording does not contradict it
  /// At the end of the log, as users know them: value and sigma, and that of what was told.
  std::vector<evaluation::CalibratedBlock> blocks, told;
};

/// Looks through logs where the settings leave something to the recording (`auto`, the time
/// offset): a filter with all that may be estimated goes through the log; what it does not come to
/// use is not estimated afterwards. An estimate of a time offset is of the first order: fixes are
/// moved by it and it is made again, until what is left is small. What the filter cannot process
/// changes nothing.
class Surveyor {
 public:
  explicit Surveyor(Console& console) : console_(console) {}

  /// Settings without `auto` among calibrate.*, from settings_for(). A log is looked through once.
  Settings complete(const std::string& log, const Settings& settings);
  /// What it found for that; null if there was nothing to look for.
  const Survey* found(const std::string& log) const;

 private:
  Survey survey(const std::string& log, Settings settings);
  LearnedNoise learn_noise(const std::string& log, const calibration::RecordedWay& way,
                           const Settings& settings);

  Console& console_;
  std::map<std::string, Survey> seen_;
};

}  // namespace foucault::app
