#include "foucault/navigation/gap_options.h"

namespace foucault::navigation {

void GapOptions::fields(ConfigFields& f) {
  f.number("max_gap_s", max_gap_s, kNotNegative,
           "longer holes in the IMU data start a new alignment");
  f.number("rate_sigma_deg_s", rate_sigma_deg_s, kNotNegative,
           "angular rate in a hole against the one before it, 1 sigma");
  f.number("accel_sigma_m_s2", accel_sigma_m_s2, kNotNegative,
           "specific force in a hole against the one before it, 1 sigma");
}

}  // namespace foucault::navigation
