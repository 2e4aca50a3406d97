#pragma once

#include <cstdint>
#include <optional>

#include "foucault/core/measurement.h"

namespace foucault::diagnosis {

/// Velocities of a receiver against the way between its fixes, horizontally, as complex numbers
/// z = north + i east: way = k * velocity where the velocity is turned and scaled, way = k *
/// conj(velocity) where it is mirrored as well (east of the other sign: k = 1, north: -1, north and
/// east exchanged: i). By least squares; positions are the noise, so that k has no bias.
struct VelocityFacts {
  int64_t pairs = 0;      ///< of fixes in a row, in motion
  bool mirrored = false;  ///< explains the way better
  double scale = 1;       ///< |k|
  double angle = 0;       ///< of k: of the way, to the right of the velocity [rad]
  double sigma = 0;       ///< of |k| and, in rad, of a turn of it; by what is left
};

/// Collects them.
class VelocityWatch {
 public:
  void add(const GnssFix& fix);
  VelocityFacts facts() const;

 private:
  std::optional<GnssFix> last_;
  int64_t pairs_ = 0;
  double ways_ = 0, velocities_ = 0;  ///< sums of squares
  double straight_n_ = 0, straight_e_ = 0, mirrored_n_ = 0, mirrored_e_ = 0;
};

}  // namespace foucault::diagnosis
