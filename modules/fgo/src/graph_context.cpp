#include "foucault/fgo/graph_context.h"

namespace foucault::fgo {

state::Layout as_constants(const state::Layout& layout) {
  state::Layout constants;
  for (const state::SlowBlock& slow : layout.slow()) constants.add(slow.block, slow.sigma);
  return constants;
}

std::optional<state::ImuScale> scale_of(const state::Layout& layout,
                                        const state::SlowVector& slow) {
  if (!layout.has_imu_scale()) return std::nullopt;
  return layout.imu_scale(slow);
}

}  // namespace foucault::fgo
