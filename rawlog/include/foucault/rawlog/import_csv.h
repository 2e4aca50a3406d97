#pragma once

#include <optional>
#include <string>

#include "foucault/rawlog/import.h"
#include "foucault/rawlog/import_mapping.h"

namespace foucault::rawlog {

/// Tables of IMU, GNSS, reference and wheel speeds, told by a mapping (import_mapping.h).
struct CsvImport : ImportOptions {
  std::string mapping;                  ///< YAML
  std::optional<std::string> data_dir;  ///< folder of the files; without it the mapping's own
  std::optional<std::string> imu, gnss, reference, wheel;  ///< instead of the mapping's files
  std::optional<Eigen::Vector3d> lever_arm;                ///< instead of the mapping's
};

ImportSummary import_csv(const CsvImport& options);

}  // namespace foucault::rawlog
