#pragma once

#include "foucault/diagnosis/gnss_options.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/measurement/aid_options.h"
#include "foucault/navigation/gap_options.h"
#include "foucault/state/interfaces.h"

namespace foucault::navigation {

enum class EpochRate { epochs, imu };

struct NavigationRunOptions {
  diagnosis::GnssOptions gnss;
  GapOptions gaps;
  measurement::AidOptions aids;
  double node_interval_s = 1;  ///< longest time between nodes, see Navigator::hold()
  EpochRate rate = EpochRate::epochs;
  imu::ImuNoise imu;  ///< as configured; for what is said of the recording, as is the mounting
  state::Mounting mounting;
};

}  // namespace foucault::navigation
