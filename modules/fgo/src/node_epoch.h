#pragma once

#include "foucault/state/result.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/preintegration/motion.h"

/// Between a node's state in w and an epoch in the local NED of its place.
namespace foucault {

/// Turns the position and velocity rows of a covariance from one local frame to another.
Matrix15d turned(const Matrix15d& P, const Eigen::Matrix3d& R);

/// `model`: a model whose gravity is constant in w levels its attitude by the accelerometers, which
/// feel the gravity of the place: what it calls the vertical of w is the local vertical. Its
/// attitude is turned by the convergence of the meridians alone, or the curvature would count
/// twice.
NodeState to_node(const Epoch& epoch, const LocalFrame& frame, PreintegrationModel model);
Epoch to_epoch(int64_t t_ns, const NodeState& x, const Matrix15d& covariance_w,
               const LocalFrame& frame, PreintegrationModel model);

}  // namespace foucault
