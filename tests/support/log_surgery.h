#pragma once

#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>

#include <functional>
#include <string>

namespace foucault::test {

/// Changes an observation; false leaves it out.
using Operation = std::function<bool(mrpt::obs::CObservation&)>;

/// Copies an observation-only rawlog, each observation through `operate`.
void operate_on_log(const std::string& from, const std::string& to, const Operation& operate);

/// Operations on one kind of observation; the others stay as they are.
Operation on_imu(std::function<bool(mrpt::obs::CObservationIMU&)> operate);
/// Not the reference.
Operation on_gnss(std::function<bool(mrpt::obs::CObservationGPS&)> operate);

/// Sets the sigmas of a NovAtel BESTPOS [m].
void set_sigma(mrpt::obs::CObservationGPS& gps, float sigma);

}  // namespace foucault::test
