#pragma once

#include <string>

#include "foucault/core/config.h"
#include "foucault/imu/imu_noise.h"

/// What an importer knows of a recording and no observation says. It stands in the log as YAML: the
/// text of a CObservationComment, before all else.
namespace foucault::rawlog {

class RecordingNotes : public Configurable {
 public:
  std::string lever_arm = "not_told";  ///< not_told | given | unknown (zero was written)
  imu::ImuOptions imu;                 ///< what a run takes where its configuration leaves it open

  void fields(ConfigFields& f) override;
};

/// Of a log; without notes the defaults. Reads no further than the first observation.
/// Throws DataError if the file cannot be read, is no rawlog, or its notes cannot be understood.
RecordingNotes read_notes(const std::string& path);

}  // namespace foucault::rawlog
