#pragma once

#include <memory>

#include "foucault/ekf/ekf.h"
#include "foucault/inertial/smoother.h"

namespace foucault {

/// Method `rts`: the EKF forward, then backward. Memory grows by 5 kB a node.
std::unique_ptr<Estimator> make_rts_smoother(const ImuNoise& imu, const Layout& layout,
                                             const EkfOptions& options, Aligner aligner,
                                             const NavigationRunOptions& run_options, Sink& sink);

}  // namespace foucault
