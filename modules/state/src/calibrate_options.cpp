#include "foucault/state/calibrate_options.h"

namespace foucault::state {

void CalibrateOptions::fields(ConfigFields& f) {
  f.text("mode", mode, {"auto", "none"}, "auto: what is on below; none: nothing beside the biases");
  f.text("gyro_scale", gyro_scale, {"on", "off"}, "scale factors of the gyroscopes");
  f.text("accel_scale", accel_scale, {"on", "off"}, "scale factors of the accelerometers");
  f.number("gyro_scale_sigma_ppm", gyro_scale_sigma_ppm, kPositive,
           "what is known of the gyroscopes' before, 1 sigma");
  f.number("accel_scale_sigma_ppm", accel_scale_sigma_ppm, kPositive,
           "what is known of the accelerometers' before, 1 sigma");
  f.number("scale_tau_s", scale_tau_s, kPositive,
           "correlation time of scale factors; a graph takes them as constant");
}

Layout CalibrateOptions::layout() const {
  constexpr double kPpm = 1e-6;
  Layout layout;
  if (mode == "none") return layout;
  if (gyro_scale == "on") layout.add(block::gyro_scale, kPpm * gyro_scale_sigma_ppm, scale_tau_s);
  if (accel_scale == "on")
    layout.add(block::accel_scale, kPpm * accel_scale_sigma_ppm, scale_tau_s);
  return layout;
}

}  // namespace foucault::state
