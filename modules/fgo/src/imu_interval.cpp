#include "foucault/fgo/imu_interval.h"

namespace foucault::fgo {

preintegration::Preintegration measured(const preintegration::Preintegrator& integrator,
                                        preintegration::PreintegrationModel model) {
  return model == preintegration::PreintegrationModel::full ? integrator.result_with_bias_decay()
                                                            : integrator.result();
}

bool has_turned(const ImuInterval& interval, const state::ImuBias& bias,
                const state::SlowVector& slow) {
  return interval.factor->turned_by(bias, slow) >= kReintegrationAngle;
}

void reintegrate(ImuInterval& interval, const state::ImuBias& bias, const state::SlowVector& slow,
                 const imu::ImuNoise& noise, const GraphContext& context) {
  const preintegration::EarthModel earth = interval.factor->earth();
  preintegration::Preintegrator integrator(noise, bias, interval.factor->t_begin_ns(),
                                           interval.before, scale_of(context.layout, slow));
  for (const ImuIncrement& increment : interval.increments) integrator.add(increment);
  preintegration::Preintegration pre = measured(integrator, context.model);
  if (interval.loosened) pre.covariance += *interval.loosened;
  interval.factor = std::make_unique<PreintegrationFactor>(pre, earth, context.layout);
}

void loosen(ImuInterval& interval, const state::NodeState& begin, const state::NodeState& end,
            const state::NodeMatrix& added, const state::Layout& layout) {
  preintegration::Preintegration pre = interval.factor->preintegration();
  const preintegration::EarthModel earth = interval.factor->earth();
  const state::NodeMatrix J = preintegration::motion_residual(begin, end, pre, earth).J_x1;
  const state::NodeMatrix of_residual = J * added * J.transpose();
  if (!interval.loosened)
    interval.loosened = std::make_unique<state::NodeMatrix>(state::NodeMatrix::Zero());
  *interval.loosened += of_residual;
  pre.covariance += of_residual;
  interval.factor = std::make_unique<PreintegrationFactor>(pre, earth, layout);
}

}  // namespace foucault::fgo
