#pragma once

#include <optional>
#include <string>

#include "foucault/core/config.h"
#include "foucault/core/measurement.h"

namespace foucault::measurement {

/// Section `aids` of the configuration: what is measured beside positions.
class AidOptions : public Configurable {
 public:
  std::string mode = "auto";          ///< auto: as below | none: positions alone
  std::string gnss_velocity = "off";  ///< on | off
  std::optional<double> gnss_velocity_sigma_m_s;

  void fields(ConfigFields& f) override;
  /// Takes off a fix what is not to be used of it.
  void apply_to(GnssFix& fix) const;
  bool uses_gnss_velocity() const { return mode != "none" && gnss_velocity == "on"; }
};

}  // namespace foucault::measurement
