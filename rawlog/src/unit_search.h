#pragma once

#include <optional>
#include <string>
#include <vector>

/// The unit of specific forces, found by gravity: their median over a while is about 1 g, whatever
/// the vehicle does.
namespace foucault::rawlog {

/// `forces`: lengths of the vectors as they stand in the table; `step`: time between rows [s].
/// The unit of acceleration_units() by which the median is nearest to g; none if none brings it
/// within 20 %.
std::optional<std::string> unit_by_gravity(const std::vector<double>& forces, double step);

}  // namespace foucault::rawlog
