#pragma once

#include <string>

#include "foucault/core/config.h"
#include "foucault/state/layout.h"

namespace foucault::state {

/// Section `calibrate` of the configuration: which slow blocks are estimated.
class CalibrateOptions : public Configurable {
 public:
  std::string mode = "auto";        ///< auto: as below | none: nothing beside the biases
  std::string gyro_scale = "off";   ///< on | off
  std::string accel_scale = "off";  ///< on | off
  double gyro_scale_sigma_ppm = 1000;
  double accel_scale_sigma_ppm = 1000;
  /// By default a constant, as in a graph. What wanders leaves the vertical free: with ten days it
  /// drifts 1.3 times, with an hour 5 times as far in 60 s.
  double scale_tau_s = 1e9;

  void fields(ConfigFields& f) override;
  Layout layout() const;
};

}  // namespace foucault::state
