#include "foucault/state/calibrate_options.h"

#include "foucault/core/constants.h"

namespace foucault::state {

void CalibrateOptions::fields(ConfigFields& f) {
  f.text("mode", mode, {"auto", "none"},
         "auto: as below; none: nothing beside the biases. Of the keys below, auto: where the "
         "recording can show it");
  f.text("gyro_scale", gyro_scale, {"auto", "on", "off"}, "scale factors of the gyroscopes");
  f.text("accel_scale", accel_scale, {"auto", "on", "off"}, "scale factors of the accelerometers");
  f.text("gyro_cross_axis", gyro_cross_axis, {"auto", "on", "off"},
         "what of one axis of the gyroscopes shows on another");
  f.text("accel_cross_axis", accel_cross_axis, {"auto", "on", "off"},
         "the same of the accelerometers");
  f.text("noise", noise, {"auto", "on", "off"},
         "noise of IMU, fixes and wheels from the recording: on; auto: where it contradicts what "
         "was told");
  f.replaced("imu_noise", "calibrate.noise (auto | on | off)");
  f.text("lever_arm", lever_arm, {"auto", "on", "off"},
         "IMU to antenna, what it was given wrong by");
  f.text("time_offset", time_offset, {"auto", "on", "off"},
         "how late fixes are stamped, on the clock of the IMU; the log is gone through twice");
  f.text("time_drift", time_drift, {"auto", "on", "off"},
         "change of the time offset: clocks run apart");
  f.text("mounting", mounting, {"auto", "on", "off"},
         "pitch and heading of the IMU in the vehicle, what they were told wrong by");
  f.text("wheel_scale", wheel_scale, {"auto", "on", "off"}, "of the speed that wheels tell");
  f.text("wheel_lever_arm", wheel_lever_arm, {"auto", "on", "off"},
         "IMU to the point of the vehicle that does not slip sideways");
  f.text("cornering_compliance", cornering_compliance, {"auto", "on", "off"},
         "angle by which that point drifts outward in a bend, by its acceleration");
  f.text("baseline_heading", baseline_heading, {"auto", "on", "off"},
         "direction of the baseline of two antennas in the vehicle, what it was told wrong by");
  f.optional_number(
      "lever_arm_sigma_m", lever_arm_sigma_m, kPositive,
      "what is known of the lever arm before, 1 sigma an axis; not set: 0.05 where it "
      "was given in the import, else 1");
  f.number("time_offset_sigma_s", time_offset_sigma_s, {1e-6, 1},
           "what is known of the time offset before, 1 sigma");
  f.number("time_offset_s", time_offset_s, {-1, 1},
           "known time offset: fixes are taken as of so much before their stamps [s]");
  f.number("mounting_sigma_deg", mounting_sigma_deg, {1e-3, 45},
           "what is known of the mounting before, 1 sigma");
  f.number("wheel_scale_sigma", wheel_scale_sigma, {1e-6, 1},
           "what is known of the scale of the wheels' speed before, 1 sigma");
  f.number("wheel_lever_arm_sigma_m", wheel_lever_arm_sigma_m, kPositive,
           "what is known of the point that does not slip before, 1 sigma an axis");
  f.number("cornering_compliance_sigma", cornering_compliance_sigma, kPositive,
           "what is known of that before, 1 sigma [rad/(m/s^2)]");
  f.number("baseline_heading_sigma_deg", baseline_heading_sigma_deg, {1e-3, 45},
           "what is known of that direction before, 1 sigma");
  f.number("gyro_scale_sigma_ppm", gyro_scale_sigma_ppm, kPositive,
           "what is known of the gyroscopes' before, 1 sigma");
  f.number("accel_scale_sigma_ppm", accel_scale_sigma_ppm, kPositive,
           "what is known of the accelerometers' before, 1 sigma");
  f.number("gyro_cross_axis_sigma_ppm", gyro_cross_axis_sigma_ppm, kPositive,
           "what is known of cross-axis terms of gyroscopes before, 1 sigma");
  f.number("accel_cross_axis_sigma_ppm", accel_cross_axis_sigma_ppm, kPositive,
           "what is known of those of accelerometers before, 1 sigma");
  f.number("time_drift_sigma_ppm", time_drift_sigma_ppm, kPositive,
           "what is known of the drift of the time offset before, 1 sigma");
  f.number("scale_tau_s", scale_tau_s, kPositive,
           "correlation time of scale factors; a graph takes them as constant");
}

CalibrateOptions CalibrateOptions::resolved(const Carried& carried) const {
  CalibrateOptions out = *this;
  const auto resolve = [](std::string& choice, bool on) {
    if (choice == "auto") choice = on ? "on" : "off";
  };
  for (std::string* always :
       {&out.gyro_scale, &out.accel_scale, &out.lever_arm, &out.time_offset, &out.time_drift})
    resolve(*always, true);
  for (std::string* rare : {&out.gyro_cross_axis, &out.accel_cross_axis}) resolve(*rare, false);
  for (std::string* rolling : {&out.mounting, &out.wheel_lever_arm, &out.cornering_compliance})
    resolve(*rolling, carried.rolling || carried.wheel_speed);
  resolve(out.wheel_scale, carried.wheel_speed);
  resolve(out.baseline_heading, carried.heading);
  return out;
}

Layout CalibrateOptions::layout() const {
  constexpr double kPpm = 1e-6;
  Layout layout;
  constexpr double kUnknownLeverArm = 1;
  if (mode == "none") return layout;
  if (time_offset == "on") layout.add(block::time_offset, time_offset_sigma_s);
  if (time_drift == "on") layout.add(block::time_drift, kPpm * time_drift_sigma_ppm);
  if (lever_arm == "on") layout.add(block::lever_arm, lever_arm_sigma_m.value_or(kUnknownLeverArm));
  if (gyro_scale == "on") layout.add(block::gyro_scale, kPpm * gyro_scale_sigma_ppm, scale_tau_s);
  if (accel_scale == "on")
    layout.add(block::accel_scale, kPpm * accel_scale_sigma_ppm, scale_tau_s);
  if (gyro_cross_axis == "on")
    layout.add(block::gyro_cross_axis, kPpm * gyro_cross_axis_sigma_ppm, scale_tau_s);
  if (accel_cross_axis == "on")
    layout.add(block::accel_cross_axis, kPpm * accel_cross_axis_sigma_ppm, scale_tau_s);
  if (mounting == "on") layout.add(block::mounting, kDegree * mounting_sigma_deg);
  if (wheel_lever_arm == "on") layout.add(block::wheel_lever_arm, wheel_lever_arm_sigma_m);
  if (cornering_compliance == "on")
    layout.add(block::cornering_compliance, cornering_compliance_sigma);
  if (wheel_scale == "on") layout.add(block::wheel_scale, wheel_scale_sigma);
  if (baseline_heading == "on")
    layout.add(block::baseline_heading, kDegree * baseline_heading_sigma_deg);
  return layout;
}

}  // namespace foucault::state
