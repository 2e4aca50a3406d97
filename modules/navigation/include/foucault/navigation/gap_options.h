#pragma once

#include "foucault/core/config.h"

namespace foucault::navigation {

/// Section `gaps` of the configuration: how holes in the IMU stream are bridged. Over a hole the
/// rates are interpolated between its ends, turned by what the courses before and after it tell;
/// the sigmas are those of what the vehicle does instead, as constant errors over the hole.
class GapOptions : public Configurable {
 public:
  double max_gap_s = 10;        ///< longer: the alignment is done anew
  double rate_sigma_deg_s = 6;  ///< error of the angular rate
  double accel_sigma_m_s2 = 1;  ///< error of the specific force

  void fields(ConfigFields& f) override;
};

}  // namespace foucault::navigation
