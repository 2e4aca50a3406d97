#include "foucault/laboratory/lab_motion.h"

#include "foucault/core/error.h"

namespace foucault::laboratory {
namespace {

LabMotion motion(const char* name, const char* title, const char* scenario, double first_start_s,
                 double period_s) {
  constexpr double kLongestInterval = 60;
  constexpr double kMargin = 10;
  LabMotion m;
  m.name = name;
  m.title = title;
  m.first_start_s = first_start_s;
  m.period_s = period_s;
  m.scenario.name = scenario;
  m.scenario.duration_s = m.start_s(m.intervals - 1) + kLongestInterval + kMargin;
  return m;
}

LabMotion vibrating_car() {
  LabMotion m = motion("vibration", "Vibrating city car", "city", 60, 150);
  m.scenario.vibration_hz = 23.7;
  m.scenario.vibration_m_s2 = 1;
  m.scenario.vibration_deg = 0.05;
  return m;
}

/// Climb and acceleration to cruise take some 900 s; the trip is made long enough to stay up.
LabMotion cruising_airliner() {
  LabMotion m = motion("airliner", "Airliner at cruise", "airliner", 1050, 120);
  m.scenario.duration_s += 1400;
  return m;
}

const std::vector<LabMotion>& motions() {
  static const std::vector<LabMotion> kMotions{
      motion("city", "City car", "city", 60, 150), vibrating_car(),
      motion("motorway", "Motorway", "motorway", 120, 180), cruising_airliner()};
  return kMotions;
}

}  // namespace

std::vector<std::string> lab_motion_names() {
  std::vector<std::string> names;
  for (const LabMotion& m : motions()) names.push_back(m.name);
  return names;
}

LabMotion lab_motion(const std::string& name) {
  std::string known;
  for (const LabMotion& m : motions()) {
    if (m.name == name) return m;
    known += std::string(known.empty() ? "" : ", ") + m.name;
  }
  throw UsageError("motion '" + name + "' is unknown; choose one of " + known);
}

}  // namespace foucault::laboratory
