#pragma once

#include <optional>
#include <string>

#include "foucault/rawlog/import.h"

namespace foucault::rawlog {

/// A DataFlash log of ArduPilot, binary (.bin) or text (.log), plain or gzip; axes
/// forward-right-down. Source: ardupilot.org, "Onboard Message Log Messages".
/// IMU: delta angles of IMT where they were logged without holes, else rates of IMU. Of several
///   sensors the first.
/// GNSS: GPS, fixes of three dimensions of the first receiver that was logged in full, heights
/// above
///   the sea. Sigmas: GPA's, else HDOP times 1.7 m, 0.3 m/s (a notice says so).
/// Time: the fixes' GPS week and milliseconds, to which the clock since boot is fitted, its drift
///   included. How long a receiver takes to send a fix is not known here: it is part of the time
///   offset of IMU and GNSS.
struct DataflashImport : ImportOptions {
  std::string log;
  /// IMU to antenna, forward-right-down [m]; without it that of the log's parameters.
  std::optional<Eigen::Vector3d> lever_arm;
};

ImportSummary import_dataflash(const DataflashImport& options);

}  // namespace foucault::rawlog
