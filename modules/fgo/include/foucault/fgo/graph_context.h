#pragma once

#include "foucault/geodesy/local_frame.h"
#include "foucault/preintegration/earth.h"
#include "foucault/state/layout.h"

namespace foucault {

/// What all nodes of a graph have in common.
struct GraphContext {
  LocalFrame frame;  ///< w
  PreintegrationModel model = PreintegrationModel::full;
  Layout layout;  ///< its slow blocks are the border
};

}  // namespace foucault
