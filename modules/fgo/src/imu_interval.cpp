#include "foucault/fgo/imu_interval.h"

namespace foucault::fgo {

Preintegration measured(const Preintegrator& integrator, PreintegrationModel model) {
  return model == PreintegrationModel::full ? integrator.result_with_bias_decay()
                                            : integrator.result();
}

bool has_turned(const ImuInterval& interval, const ImuBias& bias, const SlowVector& slow) {
  return interval.factor->turned_by(bias, slow) >= kReintegrationAngle;
}

void reintegrate(ImuInterval& interval, const ImuBias& bias, const SlowVector& slow,
                 const ImuNoise& noise, const GraphContext& context) {
  const EarthModel earth = interval.factor->earth();
  Preintegrator integrator(noise, bias, interval.factor->t_begin_ns(), interval.before,
                           scale_of(context.layout, slow));
  for (const ImuIncrement& increment : interval.increments) integrator.add(increment);
  Preintegration pre = measured(integrator, context.model);
  if (interval.loosened) pre.covariance += *interval.loosened;
  interval.factor = std::make_unique<PreintegrationFactor>(pre, earth, context.layout);
}

void loosen(ImuInterval& interval, const NodeState& begin, const NodeState& end,
            const NodeMatrix& added, const Layout& layout) {
  Preintegration pre = interval.factor->preintegration();
  const EarthModel earth = interval.factor->earth();
  const NodeMatrix J = motion_residual(begin, end, pre, earth).J_x1;
  const NodeMatrix of_residual = J * added * J.transpose();
  if (!interval.loosened) interval.loosened = std::make_unique<NodeMatrix>(NodeMatrix::Zero());
  *interval.loosened += of_residual;
  pre.covariance += of_residual;
  interval.factor = std::make_unique<PreintegrationFactor>(pre, earth, layout);
}

}  // namespace foucault::fgo
