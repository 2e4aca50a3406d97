#pragma once

#include <string>
#include <vector>

/// Units that columns of a table may have.
namespace foucault::rawlog {

struct Unit {
  const char* name;  ///< in a mapping
  double factor;     ///< to SI
  /// The value is what came together since the row before, not a rate.
  bool increment = false;
};

using Units = std::vector<Unit>;

const Units& rate_units();          ///< of angular rates
const Units& acceleration_units();  ///< of specific forces
const Units& length_units();
const Units& speed_units();
const Units& bearing_units();

std::vector<std::string> names_of(const Units& units);

/// Throws std::invalid_argument if there is none of this name.
const Unit& unit_of(const Units& units, const std::string& name);

}  // namespace foucault::rawlog
