#pragma once

#include <optional>
#include <string>

#include "foucault/core/config.h"
#include "foucault/state/layout.h"

namespace foucault::state {

/// Section `calibrate` of the configuration: which slow blocks are estimated.
class CalibrateOptions : public Configurable {
 public:
  std::string mode = "auto";  ///< auto: as below | none: nothing beside the biases
  /// auto | on | off
  std::string gyro_scale = "auto", accel_scale = "auto";
  std::string gyro_cross_axis = "off", accel_cross_axis = "off";
  std::string noise = "auto";  ///< no block: of IMU, fixes and wheels, from the recording
  std::string lever_arm = "auto";
  std::string time_offset = "auto", time_drift = "auto";
  std::string mounting = "auto", wheel_scale = "auto", wheel_lever_arm = "auto";
  std::string cornering_compliance = "auto";
  std::string baseline_heading = "auto";
  /// Not set: 5 cm where the lever arm was given in the import, else 1 m.
  std::optional<double> lever_arm_sigma_m;
  double time_offset_sigma_s = 0.3;
  double time_offset_s = 0;  ///< known of it: fixes are of so much before their stamps
  double mounting_sigma_deg = 10;
  double wheel_scale_sigma = 0.05;
  double wheel_lever_arm_sigma_m = 1.5;
  double cornering_compliance_sigma = 0.005;  ///< rear axles of cars have 1 to 8 mrad per m/s^2
  double baseline_heading_sigma_deg = 5;
  double gyro_scale_sigma_ppm = 1000;
  double accel_scale_sigma_ppm = 1000;
  double gyro_cross_axis_sigma_ppm = 1000;
  double accel_cross_axis_sigma_ppm = 1000;
  double time_drift_sigma_ppm = 100;  ///< crystals
  /// By default a constant, as in a graph. What wanders leaves the vertical free: with ten days it
  /// drifts 1.3 times, with an hour 5 times as far in 60 s.
  double scale_tau_s = 1e9;

  void fields(ConfigFields& f) override;

  /// What a recording carries, for what is `auto`.
  struct Carried {
    bool rolling = false;      ///< wheels were seen to roll without slip
    bool wheel_speed = false;  ///< and their speed to be that of the vehicle
    bool heading = false;      ///< two antennas tell the heading
  };
  /// Blocks `on` or `off` in the place of `auto`; the noise stays as it is.
  CalibrateOptions resolved(const Carried& carried) const;

  /// Of the blocks that are `on`.
  Layout layout() const;
};

}  // namespace foucault::state
