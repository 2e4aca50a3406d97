#include "foucault/laboratory/exact_interval.h"

#include <cmath>
#include <stdexcept>

#include "foucault/core/time.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/simulation/imu_simulator.h"

namespace foucault::laboratory {

state::NodeState true_state(const simulation::Trajectory& trajectory,
                            const geodesy::LocalFrame& frame, double t) {
  const simulation::Motion motion = trajectory.at(t);
  const Geodetic& origin = frame.origin();
  const Eigen::Matrix3d R_w_e =
      geodesy::wgs84::R_e_n(origin.latitude, origin.longitude).transpose();
  const Eigen::Matrix3d R_w_n = frame.R_w_n(motion.position);
  state::NodeState x;
  x.p_w_b = R_w_e * (motion.p_e - geodesy::wgs84::geodetic_to_ecef(origin));
  x.v_w_b = R_w_n * motion.velocity_n;
  x.q_w_b = Eigen::Quaterniond(R_w_n) * motion.q_n_v;
  return x;
}

ExactIncrements::ExactIncrements(const simulation::Trajectory& trajectory, double begin,
                                 double length, double base_rate_hz, double coarsest_rate_hz)
    : base_rate_hz_(base_rate_hz),
      before_(static_cast<std::size_t>(std::lround(base_rate_hz / coarsest_rate_hz))) {
  const int64_t step = nanoseconds(1 / base_rate_hz);
  const int64_t count = std::llround(length * base_rate_hz);
  const Eigen::Quaterniond same = Eigen::Quaterniond::Identity();
  base_.reserve(before_ + static_cast<std::size_t>(count));
  for (int64_t i = -static_cast<int64_t>(before_); i < count; ++i) {
    const int64_t t = nanoseconds(begin) + i * step;
    base_.push_back(simulation::exact_increment(trajectory, same, 0, t, t + step));
  }
}

std::vector<ImuIncrement> ExactIncrements::at(double rate_hz) const {
  const auto share = static_cast<std::size_t>(std::lround(base_rate_hz_ / rate_hz));
  if (share < 1 || share > before_ || static_cast<double>(share) * rate_hz != base_rate_hz_) {
    throw std::invalid_argument("laboratory: rate does not divide the base rate");
  }
  std::vector<ImuIncrement> sums;
  for (std::size_t i = before_ - share; i + share <= base_.size(); i += share) {
    ImuIncrement sum = base_[i];
    for (std::size_t j = 1; j < share; ++j) {
      sum.dtheta_b += base_[i + j].dtheta_b;
      sum.dvel_b += base_[i + j].dvel_b;
    }
    sum.t_end_ns = base_[i + share - 1].t_end_ns;
    sums.push_back(sum);
  }
  return sums;
}

}  // namespace foucault::laboratory
