#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/config.h"
#include "foucault/core/interfaces.h"
#include "foucault/core/result.h"
#include "foucault/inertial/imu_noise.h"

namespace foucault {

/// Section `alignment` of the configuration. Angles are the vehicle's (forward-right-down).
class AlignmentOptions : public Configurable {
 public:
  std::string mode = "auto";  ///< auto | given
  std::optional<double> roll_deg, pitch_deg, heading_deg;  ///< in auto: overrides what is found
  double roll_sigma_deg = 0.5, pitch_sigma_deg = 0.5, heading_sigma_deg = 1.0;  ///< of given angles
  double min_speed_m_s = 3.0;       ///< slower, a course says nothing about the heading
  double max_course_sigma_deg = 3;  ///< of one course, from the fixes' sigmas
  double max_turn_rate_deg_s = 6;   ///< faster, the vehicle is not straight

  void fields(ConfigFields& f) override;
};

}  // namespace foucault
