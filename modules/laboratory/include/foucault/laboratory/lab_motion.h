#pragma once

#include <string>
#include <vector>

#include "foucault/simulation/scenario.h"

namespace foucault::laboratory {

/// A kind of motion that is integrated, and the intervals of the trip that are.
struct LabMotion {
  std::string name;   ///< for options and files
  std::string title;  ///< for readers
  simulation::ScenarioOptions scenario;
  double first_start_s = 0;  ///< of the intervals, after the start of the trip
  double period_s = 0;       ///< from one to the next
  int intervals = 10;

  /// [s] after the start of the trip. Besides the period each start is 13 ms later than the one
  /// before, so that it meets a vibration at another phase.
  double start_s(int interval) const { return first_start_s + interval * (period_s + 0.013); }
};

/// `city` 0-16 m/s with turns and stops; `vibration` the same with an engine's vibration, 1 m/s^2
/// and 0.05 deg along and about every axis at 23.7 Hz (so often fires a four-cylinder engine idling
/// at 711 rpm; in step with none of the rates and few of the durations); `motorway` 30 m/s;
/// `airliner` 250 m/s at 10 km with turns, 200 to 360 km from the start of the trip.
std::vector<std::string> lab_motion_names();

/// Throws UsageError naming the known ones.
LabMotion lab_motion(const std::string& name);

}  // namespace foucault::laboratory
