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
      : trajectory_(make_trajectory(options(window))), begin_ns_(nanoseconds(window.begin_s)) {
    const int64_t step = nanoseconds(1 / window.rate_hz);
    const auto count = static_cast<int64_t>(std::lround(window.length_s * window.rate_hz));
    for (int64_t k = 0; k < count; ++k) {
      increments_.push_back(exact_increment(trajectory_, Eigen::Quaterniond::Identity(), 0,
                                            begin_ns_ + k * step, begin_ns_ + (k + 1) * step));
    }
  }

  int64_t begin_ns() const { return begin_ns_; }
  const std::vector<ImuIncrement>& increments() const { return increments_; }

  NavState truth(int64_t t_ns) const {
    const Motion motion = trajectory_.at(to_seconds(t_ns));
    NavState state;
    state.t_ns = t_ns;
    state.position = motion.position;
    state.velocity_n = motion.velocity_n;
    state.q_n_b = motion.q_n_v;
    return state;
  }

  /// The exact fix of an antenna on kLeverArm.
  GnssFix exact_fix(int64_t t_ns, const Eigen::Vector3d& sigma_n) const {
    const Motion motion = trajectory_.at(to_seconds(t_ns));
    const Eigen::Vector3d arm_n = motion.q_n_v * kLeverArm;
    GnssFix fix;
    fix.t_ns = t_ns;
    fix.antenna = displaced(motion.position, arm_n, Place(motion.position));
    fix.position_covariance = sigma_n.cwiseAbs2().asDiagonal();
    fix.p_b_a = kLeverArm;
    fix.velocity_n = motion.velocity_n + motion.q_n_v * motion.omega_iv_v.cross(kLeverArm);
    return fix;
  }

 private:
  static ScenarioOptions options(const TripWindow& window) {
    ScenarioOptions o;
    o.name = window.scenario;
    o.duration_s = window.begin_s + window.length_s + 1;
    o.seed = 5;
    return o;
  }

  Trajectory trajectory_;
  int64_t begin_ns_;
  std::vector<ImuIncrement> increments_;
};

inline Eigen::Vector3d draw3(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  const double x = normal(rng);
  const double y = normal(rng);
  return {x, y, normal(rng)};
}

inline NodeVector draw15(std::mt19937_64& rng) {
  NodeVector v;
  for (int i = 0; i < 5; ++i) v.segment<3>(3 * i) = draw3(rng);
  return v;
}

/// A random symmetric positive definite matrix with the given sigmas on its diagonal's order.
inline NodeMatrix random_covariance(std::mt19937_64& rng, const NodeVector& sigmas) {
  NodeMatrix m;
  for (int i = 0; i < 15; ++i) m.col(i) = draw15(rng);
  const NodeMatrix spd = m * m.transpose() / 15 + 0.1 * NodeMatrix::Identity();
  return sigmas.asDiagonal() * spd * sigmas.asDiagonal();
}

inline Epoch to_epoch(const NavState& state, const NodeMatrix& covariance) {
  return {state, covariance};
}

}  // namespace foucault::test
