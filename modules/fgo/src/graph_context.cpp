#include "foucault/fgo/graph_context.h"

namespace foucault::fgo {

Layout as_constants(const Layout& layout) {
  Layout constants;
  for (const SlowBlock& slow : layout.slow()) constants.add(slow.block, slow.sigma);
  return constants;
}

std::optional<ImuScale> scale_of(const Layout& layout, const SlowVector& slow) {
  if (!layout.find(block::gyro_scale) && !layout.find(block::accel_scale)) return std::nullopt;
  return layout.imu_scale(slow);
}

}  // namespace foucault::fgo
