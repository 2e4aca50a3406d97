#include "foucault/fgo/imu_interval.h"

namespace foucault {
Preintegration measured(const Preintegrator& integrator, PreintegrationModel model) {
  return model == PreintegrationModel::full ? integrator.result_with_bias_decay()
                                            : integrator.result();
}

bool bias_moved(const Preintegration& pre, const ImuBias& bias) {
  return (bias.gyro - pre.bias.gyro).norm() * pre.dt >= kReintegrationAngle;
}

void reintegrate(ImuInterval& interval, const ImuBias& bias, const ImuNoise& noise,
                 PreintegrationModel model) {
  const EarthModel earth = interval.factor->earth();
  Preintegrator integrator(noise, bias, interval.factor->preintegration().t_begin_ns,
                           interval.before);
  for (const ImuIncrement& increment : interval.increments) integrator.add(increment);
  Preintegration pre = measured(integrator, model);
  if (interval.loosened) pre.covariance += *interval.loosened;
  interval.factor = std::make_unique<PreintegrationFactor>(pre, earth);
}

MotionResidual unwhitened(const ImuInterval& interval, const NodeState& begin,
                          const NodeState& end) {
  return motion_residual(begin, end, interval.factor->preintegration(), interval.factor->earth());
}

void loosen(ImuInterval& interval, const Matrix15d& added) {
  if (!interval.loosened) interval.loosened = std::make_unique<Matrix15d>(Matrix15d::Zero());
  *interval.loosened += added;
  Preintegration pre = interval.factor->preintegration();
  pre.covariance += added;
  interval.factor = std::make_unique<PreintegrationFactor>(pre, interval.factor->earth());
}

}  // namespace foucault
