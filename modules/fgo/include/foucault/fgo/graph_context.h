#pragma once

#include <optional>

#include "foucault/geodesy/local_frame.h"
#include "foucault/preintegration/earth.h"
#include "foucault/state/layout.h"

namespace foucault::fgo {

/// What all nodes of a graph have in common.
struct GraphContext {
  geodesy::LocalFrame frame{Geodetic{}};  ///< w
  preintegration::PreintegrationModel model = preintegration::PreintegrationModel::full;
  state::Layout layout;  ///< its slow blocks are the border
};

/// The blocks of a layout as a graph has them: as constants.
state::Layout as_constants(const state::Layout& layout);

/// Where the IMU's scale factors are among estimates, intervals are integrated at them.
std::optional<state::ImuScale> scale_of(const state::Layout& layout, const state::SlowVector& slow);

}  // namespace foucault::fgo
