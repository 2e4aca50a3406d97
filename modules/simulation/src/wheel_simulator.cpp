#include "foucault/simulation/wheel_simulator.h"

#include <cmath>

namespace foucault::simulation {
namespace {

constexpr double kStandstill = 1e-3;  ///< [m/s]

}  // namespace

WheelSimulator::WheelSimulator(const ScenarioOptions& options)
    : p_v_wheel_(options.wheel_lever_arm_m),
      scale_(1 + options.wheel_scale_percent / 100),
      sigma_(options.wheel_sigma_m_s),
      step_(options.wheel_step_m_s),
      draws_(options.seed, RandomStream::wheel) {}

WheelSpeed WheelSimulator::measure(const Motion& motion, int64_t t_ns) {
  const Eigen::Vector3d velocity_v =
      motion.q_n_v.conjugate() * point_velocity_n(motion, p_v_wheel_);
  const double noise = sigma_ * draws_.normal();
  if (std::abs(velocity_v.x()) < kStandstill) return {t_ns, 0};
  const double measured = scale_ * velocity_v.x() + noise;
  return {t_ns, step_ > 0 ? std::round(measured / step_) * step_ : measured};
}

}  // namespace foucault::simulation
