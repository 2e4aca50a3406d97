#pragma once

#include <optional>

#include "foucault/geodesy/local_frame.h"
#include "foucault/preintegration/earth.h"
#include "foucault/state/layout.h"

namespace foucault::fgo {

/// What all nodes of a graph have in common.
struct GraphContext {
  LocalFrame frame{Geodetic{}};  ///< w
  PreintegrationModel model = PreintegrationModel::full;
  Layout layout;  ///< its slow blocks are the border
};

/// The blocks of a layout as a graph has them: as constants.
Layout as_constants(const Layout& layout);

/// Where the IMU's scale factors are among estimates, intervals are integrated at them.
std::optional<ImuScale> scale_of(const Layout& layout, const SlowVector& slow);

}  // namespace foucault::fgo
