#include "foucault/calibration/noise_model.h"

namespace foucault::calibration::noise_axis {

const NoiseAxis accel_white{"accel_white", "m/s^2/sqrt(Hz)",
                            [](NoiseModel& m) -> double& { return m.imu.accel_noise_density; }};
const NoiseAxis gyro_white{"gyro_white", "rad/s/sqrt(Hz)",
                           [](NoiseModel& m) -> double& { return m.imu.gyro_noise_density; }};
const NoiseAxis accel_bias{"accel_bias", "m/s^2",
                           [](NoiseModel& m) -> double& { return m.imu.accel_bias_sigma; }};
const NoiseAxis gyro_bias{"gyro_bias", "rad/s",
                          [](NoiseModel& m) -> double& { return m.imu.gyro_bias_sigma; }};
const NoiseAxis fix_white{"fix_white", "1", [](NoiseModel& m) -> double& { return m.fix_white; }};
const NoiseAxis fix_coloured{"fix_coloured", "1",
                             [](NoiseModel& m) -> double& { return m.fix_coloured; }};
const NoiseAxis fix_tau{"fix_tau", "s", [](NoiseModel& m) -> double& { return m.fix_tau_s; }};
const NoiseAxis velocity{"velocity", "1", [](NoiseModel& m) -> double& { return m.velocity; }};
const NoiseAxis slip{"slip", "1", [](NoiseModel& m) -> double& { return m.slip; }};
const NoiseAxis bounce{"bounce", "1", [](NoiseModel& m) -> double& { return m.bounce; }};
const NoiseAxis wheel{"wheel", "1", [](NoiseModel& m) -> double& { return m.wheel; }};

}  // namespace foucault::calibration::noise_axis
