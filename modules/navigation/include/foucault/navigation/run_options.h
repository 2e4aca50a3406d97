#pragma once

#include "foucault/alignment/alignment.h"
#include "foucault/diagnosis/gnss_options.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/measurement/aid_options.h"
#include "foucault/navigation/gap_options.h"
#include "foucault/state/interfaces.h"

namespace foucault::navigation {

enum class EpochRate { epochs, imu };

/// What a run is told. The noise of the IMU has no default; all else suits a car.
struct NavigationRunOptions {
  NavigationRunOptions() = default;
  explicit NavigationRunOptions(const imu::ImuNoise& noise) : imu(noise) {}

  diagnosis::GnssOptions gnss;
  GapOptions gaps;
  measurement::AidOptions aids;
  double node_interval_s = 1;  ///< longest time between nodes, see Navigator::hold()
  EpochRate rate = EpochRate::epochs;
  imu::ImuNoise imu;         ///< as configured
  state::Mounting mounting;  ///< of the IMU in the vehicle, as it was told
  state::Layout layout;      ///< what is estimated beside a node; the navigator's own
  alignment::AlignmentOptions alignment;
};

alignment::Aligner aligner_of(const NavigationRunOptions& options);

}  // namespace foucault::navigation
