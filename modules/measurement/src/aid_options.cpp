#include "foucault/measurement/aid_options.h"

#include <cmath>

#include "foucault/core/constants.h"

namespace foucault::measurement {

void AidOptions::fields(ConfigFields& f) {
  f.text("mode", mode, {"auto", "none"},
         "auto: what is on below; none: positions alone, also in the alignment");
  f.text("gnss_velocity", gnss_velocity, {"on", "off"}, "velocities that the receiver gives");
  f.optional_number("gnss_velocity_sigma_m_s", gnss_velocity_sigma_m_s, kPositive,
                    "sigma of these velocities, each axis, in the place of the receiver's");
  f.text("zero_velocity", zero_velocity, {"auto", "on", "off"},
         "no velocity and no rate where the vehicle stands still, as the data show");
  f.number("zero_velocity_sigma_m_s", zero_velocity_sigma_m_s, kPositive,
           "sigma of that velocity, each axis");
  f.text("nonholonomic", nonholonomic, {"auto", "on", "off"},
         "wheels do not slip sideways; auto: once the recording has shown that it is so");
  f.optional_number("nonholonomic_sigma_m_s", nonholonomic_sigma_m_s, kPositive,
                    "sigma of the mean velocity to the right and downward over a second; not set: "
                    "as the recording shows");
  f.optional_number("nonholonomic_down_sigma_m_s", nonholonomic_down_sigma_m_s, kPositive,
                    "the same downward alone; not set: as to the right");
  f.text("wheel_speed", wheel_speed, {"auto", "on", "off"},
         "speed of the wheels; auto: once it was found to be that of the vehicle");
  f.optional_number("wheel_speed_sigma_m_s", wheel_speed_sigma_m_s, kPositive,
                    "sigma of the mean speed over a second; not set: as the recording shows");
  f.text("heading", heading, {"auto", "on", "off"},
         "heading of two antennas; auto: once the recording does not contradict it");
  f.optional_number("heading_sigma_deg", heading_sigma_deg, kPositive,
                    "sigma of that heading, in the place of the receiver's");
  f.number("heading_baseline_deg", heading_baseline_deg, {-360, 360},
           "direction in the vehicle, from forward to the right, of which that heading is");
}

void AidOptions::apply_to(GnssFix& fix) const {
  if (mode == "none") fix.velocity_n.reset();
  if (gnss_velocity_sigma_m_s)
    fix.velocity_covariance = std::pow(*gnss_velocity_sigma_m_s, 2) * Eigen::Matrix3d::Identity();
  if (!uses(heading)) fix.heading.reset();
  if (!fix.heading) return;
  fix.heading->baseline = heading_baseline_deg * kDegree;
  if (heading_sigma_deg) fix.heading->sigma = *heading_sigma_deg * kDegree;
}

std::vector<std::string> AidOptions::in_use() const {
  std::vector<std::string> keys;
  if (uses_gnss_velocity()) keys.push_back("gnss_velocity");
  if (uses(zero_velocity)) keys.push_back("zero_velocity");
  if (uses(nonholonomic)) keys.push_back("nonholonomic");
  if (uses(wheel_speed)) keys.push_back("wheel_speed");
  if (uses(heading)) keys.push_back("heading");
  return keys;
}

}  // namespace foucault::measurement
