#pragma once

namespace foucault::benchmarks {

/// "preintegration/MODEL", "preintegration/dense": an IMU sample, with covariance and Jacobians by
/// the biases. "factor/residual", "factor/residual and Jacobians": PreintegrationFactor as the
/// solver calls it.
void register_kernels();

}  // namespace foucault::benchmarks
