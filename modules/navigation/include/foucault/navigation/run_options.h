#pragma once

#include "foucault/diagnosis/gnss_options.h"
#include "foucault/measurement/aid_options.h"
#include "foucault/navigation/gap_options.h"

namespace foucault::navigation {

enum class EpochRate { epochs, imu };

struct NavigationRunOptions {
  diagnosis::GnssOptions gnss;
  GapOptions gaps;
  measurement::AidOptions aids;
  double node_interval_s = 1;  ///< longest time between nodes, see Navigator::hold()
  EpochRate rate = EpochRate::epochs;
};

}  // namespace foucault::navigation
