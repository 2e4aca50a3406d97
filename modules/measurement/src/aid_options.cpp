#include "foucault/measurement/aid_options.h"

#include <cmath>

namespace foucault::measurement {

void AidOptions::fields(ConfigFields& f) {
  f.text("mode", mode, {"auto", "none"},
         "auto: what is on below; none: positions alone, also in the alignment");
  f.text("gnss_velocity", gnss_velocity, {"on", "off"}, "velocities that the receiver gives");
  f.optional_number("gnss_velocity_sigma_m_s", gnss_velocity_sigma_m_s, kPositive,
                    "sigma of these velocities, each axis, in the place of the receiver's");
}

void AidOptions::apply_to(GnssFix& fix) const {
  if (mode == "none") fix.velocity_n.reset();
  if (gnss_velocity_sigma_m_s)
    fix.velocity_covariance = std::pow(*gnss_velocity_sigma_m_s, 2) * Eigen::Matrix3d::Identity();
}

}  // namespace foucault::measurement
