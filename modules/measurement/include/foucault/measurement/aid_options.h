#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/core/config.h"
#include "foucault/core/measurement.h"

namespace foucault::measurement {

/// Section `aids` of the configuration: what is measured beside positions. Off here; the program
/// sets `auto`.
class AidOptions : public Configurable {
 public:
  std::string mode = "auto";          ///< auto: as below | none: positions alone
  std::string gnss_velocity = "off";  ///< on | off
  std::optional<double> gnss_velocity_sigma_m_s;
  std::string zero_velocity = "off";  ///< auto | on | off
  double zero_velocity_sigma_m_s = 0.02;
  std::string nonholonomic = "off";                   ///< auto | on | off
  std::optional<double> nonholonomic_sigma_m_s;       ///< not set: as the recording shows
  std::optional<double> nonholonomic_down_sigma_m_s;  ///< not set: as to the right
  std::string wheel_speed = "off";                    ///< auto | on | off
  std::optional<double> wheel_speed_sigma_m_s;        ///< not set: as the recording shows

  std::string heading = "off";              ///< auto | on | off
  std::optional<double> heading_sigma_deg;  ///< not set: the receiver's
  double heading_baseline_deg = 0;

  void fields(ConfigFields& f) override;
  /// Takes off a fix what is not to be used of it, and tells it what was told of the rest.
  void apply_to(GnssFix& fix) const;
  bool uses_gnss_velocity() const { return mode != "none" && gnss_velocity == "on"; }
  bool uses(const std::string& aid) const { return mode != "none" && aid != "off"; }
  /// The keys of the aids that are used, where the data carry them.
  std::vector<std::string> in_use() const;
};

}  // namespace foucault::measurement
