#pragma once

#include <optional>
#include <string>

#include "foucault/core/config.h"
#include "foucault/state/layout.h"

namespace foucault::state {

/// Section `calibrate` of the configuration: which slow blocks are estimated.
class CalibrateOptions : public Configurable {
 public:
  std::string mode = "auto";             ///< auto: as below | none: nothing beside the biases
  std::string gyro_scale = "off";        ///< on | off
  std::string accel_scale = "off";       ///< on | off
  std::string gyro_cross_axis = "off";   ///< on | off
  std::string accel_cross_axis = "off";  ///< on | off
  std::string lever_arm = "off";         ///< on | off
  std::string time_offset = "off";       ///< on | off
  std::string time_drift = "off";        ///< on | off
  std::string mounting = "off";          ///< on | off
  std::string wheel_scale = "off";       ///< on | off
  std::string wheel_lever_arm = "off";   ///< on | off
  /// Not set: 5 cm where the lever arm was given in the import, else 1 m.
  std::optional<double> lever_arm_sigma_m;
  double time_offset_sigma_s = 0.3;
  double time_offset_s = 0;  ///< known of it: fixes are of so much before their stamps
  double mounting_sigma_deg = 10;
  double wheel_scale_sigma = 0.05;
  double wheel_lever_arm_sigma_m = 1.5;
  double gyro_scale_sigma_ppm = 1000;
  double accel_scale_sigma_ppm = 1000;
  double gyro_cross_axis_sigma_ppm = 1000;
  double accel_cross_axis_sigma_ppm = 1000;
  double time_drift_sigma_ppm = 100;  ///< crystals
  /// By default a constant, as in a graph. What wanders leaves the vertical free: with ten days it
  /// drifts 1.3 times, with an hour 5 times as far in 60 s.
  double scale_tau_s = 1e9;

  void fields(ConfigFields& f) override;
  Layout layout() const;
};

}  // namespace foucault::state
