#pragma once

#include "vehicle.h"

namespace foucault::simulation {

/// The vehicles of make_trajectory(); what a whole trip has in common (wind, length of the rows) is
/// drawn here.
VehicleStyle walk_style(Draws& draws);
VehicleStyle robot_style(Draws& draws);
VehicleStyle rows_style(Draws& draws);
VehicleStyle boat_style(Draws& draws);
VehicleStyle copter_style(Draws& draws);
VehicleStyle fixed_wing_style(Draws& draws);
VehicleStyle train_style(Draws& draws);
VehicleStyle reversing_style(Draws& draws);

}  // namespace foucault::simulation
