#pragma once

#include <cstdint>
#include <string>

#include "foucault/core/config.h"
#include "foucault/core/measurement.h"

namespace foucault::diagnosis {

/// Section `gnss` of the configuration: which fixes are used, and how much they are trusted.
class GnssOptions : public Configurable {
 public:
  std::string min_quality = "any";  ///< any | single | differential | ppp | float_rtk | fixed_rtk
  double sigma_scale = 1;           ///< multiplies the sigmas of positions
  double sigma_floor_m = 0;         ///< smallest sigma of a position, each axis
  double gate_false_alarm = 1e-7;   ///< probability that a good fix is gated; 0: no gate
  int64_t reinstate_after = 3;      ///< gated fixes in a row after which the state may be wrong

  void fields(ConfigFields& f) override;
  FixQuality lowest_quality() const;  ///< of min_quality
  /// The fix with the sigmas of this section.
  GnssFix weighted(const GnssFix& fix) const;
  /// Whether it has a covariance that is one, weighted.
  bool has_valid_sigma(const GnssFix& fix) const;
  /// Whether the fix may be used, whatever the state.
  bool allows(const GnssFix& fix) const;
};
/// Finite and positive definite.
bool is_valid_covariance(const Eigen::Matrix3d& covariance);

}  // namespace foucault::diagnosis
