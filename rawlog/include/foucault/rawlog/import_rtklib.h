#pragma once

#include <optional>
#include <string>

#include "foucault/rawlog/import.h"
#include "foucault/rawlog/import_mapping.h"

namespace foucault::rawlog {

/// A solution of RTKLIB (.pos, latitude/longitude/height) and an IMU table told by a mapping.
/// Of the mapping's `gnss` count: file, time.offset_s, height and geoid_separation_m (unless the
/// .pos header says the datum), velocity, velocity_sigma_m_s; RTKLIB's header tells the rest.
/// Time: date and time of day, or week and seconds; GPST or UTC.
struct RtklibImport : ImportOptions {
  std::string mapping;
  std::optional<std::string> data_dir;
  std::optional<std::string> imu, gnss, reference;
  std::optional<Eigen::Vector3d> lever_arm;
};

ImportSummary import_rtklib(const RtklibImport& options);

}  // namespace foucault::rawlog
