#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <random>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/ekf/ekf.h"
#include "foucault/geodesy/place.h"
#include "foucault/simulation/imu_simulator.h"
#include "foucault/simulation/scenario.h"

/// A simulated trip that many seeded runs share: exact increments are computed once.
namespace foucault::test {

const Eigen::Vector3d kLeverArm(0.1, -0.3, -0.8);

struct TripWindow {
  std::string scenario = "city";
  double begin_s = 60;
  double length_s = 120;
  double rate_hz = 100;
};

class Trip {
 public:
  explicit Trip(const TripWindow& window)
      : trajectory_(simulation::make_trajectory(options(window))),
        begin_ns_(nanoseconds(window.begin_s)) {
    const int64_t step = nanoseconds(1 / window.rate_hz);
    const auto count = static_cast<int64_t>(std::lround(window.length_s * window.rate_hz));
    for (int64_t k = 0; k < count; ++k) {
      increments_.push_back(simulation::exact_increment(trajectory_, Eigen::Quaterniond::Identity(),
                                                        0, begin_ns_ + k * step,
                                                        begin_ns_ + (k + 1) * step));
    }
  }

  int64_t begin_ns() const { return begin_ns_; }
  const std::vector<ImuIncrement>& increments() const { return increments_; }

  state::NavState truth(int64_t t_ns) const {
    const simulation::Motion motion = trajectory_.at(to_seconds(t_ns));
    state::NavState state;
    state.t_ns = t_ns;
    state.position = motion.position;
    state.velocity_n = motion.velocity_n;
    state.q_n_b = motion.q_n_v;
    return state;
  }

  /// The exact fix of an antenna on kLeverArm.
  GnssFix exact_fix(int64_t t_ns, const Eigen::Vector3d& sigma_n) const {
    const simulation::Motion motion = trajectory_.at(to_seconds(t_ns));
    const Eigen::Vector3d arm_n = motion.q_n_v * kLeverArm;
    GnssFix fix;
    fix.t_ns = t_ns;
    fix.antenna = geodesy::displaced(motion.position, arm_n, geodesy::Place(motion.position));
    fix.position_covariance = sigma_n.cwiseAbs2().asDiagonal();
    fix.p_b_a = kLeverArm;
    fix.velocity_n = motion.velocity_n + motion.q_n_v * motion.omega_iv_v.cross(kLeverArm);
    return fix;
  }

 private:
  static simulation::ScenarioOptions options(const TripWindow& window) {
    simulation::ScenarioOptions o;
    o.name = window.scenario;
    o.duration_s = window.begin_s + window.length_s + 1;
    o.seed = 5;
    return o;
  }

  simulation::Trajectory trajectory_;
  int64_t begin_ns_;
  std::vector<ImuIncrement> increments_;
};

inline Eigen::Vector3d draw3(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  const double x = normal(rng);
  const double y = normal(rng);
  return {x, y, normal(rng)};
}

inline state::NodeVector draw15(std::mt19937_64& rng) {
  state::NodeVector v;
  for (int i = 0; i < 5; ++i) v.segment<3>(3 * i) = draw3(rng);
  return v;
}

/// A random symmetric positive definite matrix with the given sigmas on its diagonal's order.
inline state::NodeMatrix random_covariance(std::mt19937_64& rng, const state::NodeVector& sigmas) {
  state::NodeMatrix m;
  for (int i = 0; i < 15; ++i) m.col(i) = draw15(rng);
  const state::NodeMatrix spd = m * m.transpose() / 15 + 0.1 * state::NodeMatrix::Identity();
  return sigmas.asDiagonal() * spd * sigmas.asDiagonal();
}

inline state::Epoch to_epoch(const state::NavState& state, const state::NodeMatrix& covariance) {
  return {state, covariance};
}

}  // namespace foucault::test
