#pragma once

#include <optional>
#include <string>

#include "foucault/rawlog/import.h"
#include "foucault/rawlog/import_mapping.h"

namespace foucault::rawlog {

/// A solution of RTKLIB (.pos) and an IMU table told by a mapping. Positions are latitude,
/// longitude, height in degrees or in degrees, minutes, seconds, ECEF, or a baseline east, north,
/// up from the header's `ref pos` or the mapping's gnss.origin. Time: date and time of day, or week
/// and seconds, of GPST, UTC or JST. Without a header: RTKLIB's own order, in GPST, with a notice.
/// Of the mapping's `gnss` count: file, time.offset_s, height and geoid_separation_m (unless the
/// .pos header says the datum), origin, velocity, velocity_sigma_m_s; RTKLIB's header tells the
/// rest.
struct RtklibImport : ImportOptions {
  std::string mapping;
  std::optional<std::string> data_dir;
  std::optional<std::string> imu, gnss, reference, wheel;
  std::optional<Eigen::Vector3d> lever_arm;
};

ImportSummary import_rtklib(const RtklibImport& options);

}  // namespace foucault::rawlog
