#pragma once

namespace foucault::benchmarks {

/// "window/1 Hz", "window/10 Hz": an epoch of the window of 20 s: optimization, elimination,
/// covariance; preintegration left out. "ekf": an IMU sample, with updates at 1 Hz.
/// "batch": a node of the optimization with its covariance, without the forward run.
void register_methods();

}  // namespace foucault::benchmarks
