#pragma once

#include <optional>
#include <string>

#include "foucault/rawlog/import.h"
#include "foucault/rawlog/import_mapping.h"

namespace foucault::rawlog {

/// NMEA 0183 of a receiver, of any constellation: GGA with RMC, VTG, ZDA and GST of the same time;
/// and an IMU table told by a mapping, if there is one. Sentences whose checksum is wrong or
/// missing are left out and counted. Heights are GGA's above sea level and its geoid separation.
/// Sigmas are GST's, else HDOP times gnss.sigma_m, else HDOP times a number by quality (a notice
/// says which). Velocity is RMC's, else VTG's, along the ground.
/// Of the mapping's `gnss` count: file, time.offset_s, time.date (where no RMC or ZDA tells it),
/// geoid_separation_m (where GGA has none), sigma_m, velocity, velocity_sigma_m_s.
struct NmeaImport : ImportOptions {
  std::string mapping;  ///< YAML; may be empty without an IMU
  std::optional<std::string> data_dir;
  std::optional<std::string> imu, gnss, reference, wheel;
  std::optional<Eigen::Vector3d> lever_arm;
};

ImportSummary import_nmea(const NmeaImport& options);

}  // namespace foucault::rawlog
