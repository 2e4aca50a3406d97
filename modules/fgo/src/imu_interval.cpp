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
  interval.factor = std::make_unique<PreintegrationFactor>(measured(integrator, model), earth);
}

}  // namespace foucault
