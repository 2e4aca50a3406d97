#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "foucault/fgo/graph_context.h"
#include "foucault/fgo/preintegration_factor.h"

namespace foucault::fgo {

/// Between a node and the next: the factor, and what it was integrated from.
struct ImuInterval {
  std::vector<ImuIncrement> increments;  ///< kept to integrate again
  std::optional<ImuIncrement> before;    ///< the increment before the first
  std::unique_ptr<PreintegrationFactor> factor;
  std::unique_ptr<state::NodeMatrix>
      loosened;  ///< covariance beyond the IMU's, of the factor's residual
};

/// What the model takes from an integrator: in `full` the biases decay.
preintegration::Preintegration measured(const preintegration::Preintegrator& integrator,
                                        preintegration::PreintegrationModel model);

/// A change of the gyro bias turns an interval by |dbg| T. Beyond this angle the second order of
/// (46), g (|dbg| T)^2 T / 6, nears 1e-6 m/s, and the interval is to be integrated anew.
constexpr double kReintegrationAngle = 1e-3;  // [rad]

/// Scale factors of the gyroscopes likewise.
bool has_turned(const ImuInterval& interval, const state::ImuBias& bias,
                const state::SlowVector& slow);

/// The end of the interval from `begin` to `end` may have been off by more than the IMU's noise:
/// `added` comes to the covariance of its error.
void loosen(ImuInterval& interval, const state::NodeState& begin, const state::NodeState& end,
            const state::NodeMatrix& added, const state::Layout& layout);

/// Integrates the interval again, at these values; there is a new factor then.
void reintegrate(ImuInterval& interval, const state::ImuBias& bias, const state::SlowVector& slow,
                 const imu::ImuNoise& noise, const GraphContext& context);

}  // namespace foucault::fgo
