#pragma once

#include "foucault/core/measurement.h"

namespace foucault::geodesy {

/// A lower bound of the way between two positions, good also across the Earth [m].
double least_distance(const Geodetic& a, const Geodetic& b);

/// Whether a vehicle may have come from one fix to the other: no further than 10 km (chosen: nearer
/// errors are for those who know the state) and 1000 m/s in between. Receivers give no position
/// beyond 1000 knots, 515 m/s (export rules); this is twice that.
bool within_reach(const GnssFix& a, const GnssFix& b);

}  // namespace foucault::geodesy
