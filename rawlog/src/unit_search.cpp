#include "unit_search.h"

#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/median.h"
#include "table_units.h"

namespace foucault::rawlog {

std::optional<std::string> unit_by_gravity(const std::vector<double>& forces, double step) {
  const double kFarOff = std::log(1.2);
  if (forces.empty() || !(step > 0)) return std::nullopt;
  const double force = median(forces);
  std::optional<std::string> found;
  double nearest = kFarOff;
  for (const Unit& unit : acceleration_units()) {
    const double factor = unit.increment ? unit.factor / step : unit.factor;
    const double off = std::abs(std::log(force * factor / kStandardGravity));
    if (off >= nearest) continue;
    nearest = off;
    found = unit.name;
  }
  return found;
}

}  // namespace foucault::rawlog
