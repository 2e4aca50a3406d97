#include "table_units.h"

#include <stdexcept>

#include "foucault/core/constants.h"

namespace foucault::rawlog {

const Units& rate_units() {
  static const Units units{
      {"rad_s", 1}, {"deg_s", kDegree}, {"rad", 1, true}, {"deg", kDegree, true}};
  return units;
}

const Units& acceleration_units() {
  static const Units units{{"m_s2", 1},
                           {"g", kStandardGravity},
                           {"mg", kStandardGravity / 1000},
                           {"cm_s2", 0.01},
                           {"m_s", 1, true}};
  return units;
}

const Units& length_units() {
  static const Units units{{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"ft", 0.3048}};
  return units;
}

const Units& speed_units() {
  static const Units units{
      {"m_s", 1}, {"cm_s", 0.01}, {"mm_s", 0.001}, {"km_h", 1 / 3.6}, {"knots", 1852.0 / 3600}};
  return units;
}

const Units& bearing_units() {
  static const Units units{{"deg", kDegree}, {"rad", 1}, {"e5", 1e-5 * kDegree}};
  return units;
}

std::vector<std::string> names_of(const Units& units) {
  std::vector<std::string> names;
  for (const Unit& unit : units) names.emplace_back(unit.name);
  return names;
}

const Unit& unit_of(const Units& units, const std::string& name) {
  for (const Unit& unit : units) {
    if (name == unit.name) return unit;
  }
  throw std::invalid_argument("no unit '" + name + "'");
}

}  // namespace foucault::rawlog
