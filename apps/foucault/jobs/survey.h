#pragma once

#include <map>
#include <optional>
#include <string>

#include "console.h"
#include "foucault/calibration/recorded_way.h"
#include "settings.h"

namespace foucault::app {

/// What a filter finds in a log before it is processed.
struct Survey {
  double time_offset_s = 0;  ///< calibrate.time_offset_s; what is left is small
  state::CalibrateOptions::Carried carried;
  std::optional<imu::ImuNoise> noise;  ///< if the recording contradicts what was told
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

 private:
  Survey survey(const std::string& log, Settings settings);
  bool raise_noise(const std::string& log, const calibration::RecordedWay& way, Settings& settings,
                   Survey& found);

  Console& console_;
  std::map<std::string, Survey> seen_;
};

}  // namespace foucault::app
