#pragma once

#include <algorithm>

#include "foucault/core/so3.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/imu/increments.h"
#include "foucault/simulation/imu_simulator.h"
#include "foucault/simulation/trajectory.h"

/// Two navigators of the tests, both in ECEF and sharing nothing with Trajectory's NED equations:
/// a Runge-Kutta integration of the differential equations, fed with the true rates, and a
/// strapdown mechanization of increments with coning and sculling.
namespace foucault::testing {

/// What the navigators know of the Earth; the negative controls take it away.
struct Earth {
  Eigen::Vector3d rate_e{0, 0, geodesy::wgs84::kEarthRate};
  bool gravity_follows_place =
      true;  ///< false: the gravity vector of the start (no transport rate)
};

struct EcefState {
  Eigen::Vector3d p;  ///< ECEF [m]
  Eigen::Vector3d v;  ///< [m/s]
  Eigen::Quaterniond q_e_v;
};

inline Eigen::Matrix3d R_e_n(const Geodetic& place) {
  return geodesy::wgs84::R_e_n(place.latitude, place.longitude);
}

inline EcefState ecef_state(const simulation::Motion& motion) {
  const Eigen::Matrix3d R = R_e_n(motion.position);
  return {motion.p_e, R * motion.velocity_n, Eigen::Quaterniond(R) * motion.q_n_v};
}

inline Eigen::Vector3d gravity_e(const Eigen::Vector3d& p_e) {
  const Geodetic place = geodesy::wgs84::ecef_to_geodetic(p_e);
  return R_e_n(place) *
         Eigen::Vector3d(0, 0, geodesy::wgs84::normal_gravity(place.latitude, place.height));
}

/// Free-inertial navigation with position as an offset from the start, so that rounding in ECEF
/// metres (1 nm) does not add up.
class FreeInertial {
 public:
  FreeInertial(const simulation::Motion& start, const Earth& earth)
      : earth_(earth), start_e_(start.p_e), start_gravity_e_(gravity_e(start.p_e)) {
    const EcefState state = ecef_state(start);
    v_ = state.v;
    q_ = state.q_e_v;
  }

  EcefState state() const { return {start_e_ + offset_, v_, q_}; }

 protected:
  Eigen::Vector3d gravity(const Eigen::Vector3d& offset) const {
    return earth_.gravity_follows_place ? gravity_e(start_e_ + offset) : start_gravity_e_;
  }

  Earth earth_;
  Eigen::Vector3d start_e_, start_gravity_e_;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_;
  Eigen::Quaterniond q_;
};

class RungeKutta : public FreeInertial {
 public:
  using FreeInertial::FreeInertial;

  void step(const simulation::Trajectory& trajectory, double t, double dt) {
    const simulation::Motion begin = trajectory.at(t);
    const simulation::Motion middle = trajectory.at(t + dt / 2);
    const simulation::Motion end = trajectory.at(t + dt);
    const State y{offset_, v_, q_.coeffs()};
    const State k1 = derivative(y, begin);
    const State k2 = derivative(plus(y, k1, dt / 2), middle);
    const State k3 = derivative(plus(y, k2, dt / 2), middle);
    const State k4 = derivative(plus(y, k3, dt), end);
    const State next = plus(plus(plus(plus(y, k1, dt / 6), k2, dt / 3), k3, dt / 3), k4, dt / 6);
    offset_ = next.p;
    v_ = next.v;
    q_ = Eigen::Quaterniond(next.q).normalized();
  }

 private:
  struct State {
    Eigen::Vector3d p, v;
    Eigen::Vector4d q;
  };

  static State plus(const State& y, const State& k, double h) {
    return {y.p + h * k.p, y.v + h * k.v, y.q + h * k.q};
  }

  static Eigen::Quaterniond pure(const Eigen::Vector3d& v) { return {0, v.x(), v.y(), v.z()}; }

  State derivative(const State& y, const simulation::Motion& truth) const {
    const Eigen::Quaterniond q(y.q);
    const Eigen::Vector3d acceleration =
        q * truth.f_v + gravity(y.p) - 2 * earth_.rate_e.cross(y.v);
    const Eigen::Vector4d turn = (q * pure(truth.omega_iv_v)).coeffs();
    const Eigen::Vector4d earth_turn = (pure(earth_.rate_e) * q).coeffs();
    return {y.v, acceleration, 0.5 * (turn - earth_turn)};
  }
};

class Strapdown : public FreeInertial {
 public:
  using FreeInertial::FreeInertial;

  /// Both increments of the same length.
  void step(const ImuIncrement& previous, const ImuIncrement& current) {
    const double dt = current.dt();
    const Eigen::Vector3d turn = imu::rotation_with_coning(previous.dtheta_b, current.dtheta_b);
    const Eigen::Vector3d dv_b = imu::velocity_with_sculling(previous.dtheta_b, previous.dvel_b,
                                                             current.dtheta_b, current.dvel_b);
    const Eigen::Quaterniond half_earth = so3::exp(-earth_.rate_e * (dt / 2));
    const Eigen::Vector3d dv_f = half_earth * (q_ * dv_b);
    const Eigen::Vector3d coasting = gravity(offset_) - 2 * earth_.rate_e.cross(v_);
    const Eigen::Vector3d v_mid = v_ + 0.5 * (dv_f + coasting * dt);
    const Eigen::Vector3d p_mid = offset_ + v_ * (dt / 2);
    const Eigen::Vector3d dv = dv_f + (gravity(p_mid) - 2 * earth_.rate_e.cross(v_mid)) * dt;
    offset_ += (v_ + 0.5 * dv) * dt;
    v_ += dv;
    q_ = (half_earth * half_earth * q_ * so3::exp(turn)).normalized();
  }
};

/// Largest errors on the way.
struct Closure {
  double position = 0;  ///< [m]
  double velocity = 0;  ///< [m/s]
  double angle = 0;     ///< [rad]

  void compare(const EcefState& estimate, const EcefState& truth) {
    position = std::max(position, (estimate.p - truth.p).norm());
    velocity = std::max(velocity, (estimate.v - truth.v).norm());
    angle = std::max(angle, so3::log(truth.q_e_v.conjugate() * estimate.q_e_v).norm());
  }
};

inline Closure close_runge_kutta(const simulation::Trajectory& trajectory, double begin,
                                 double length, double dt, const Earth& earth = {}) {
  RungeKutta navigator(trajectory.at(begin), earth);
  Closure closure;
  const int steps = static_cast<int>(length / dt + 0.5);
  for (int i = 0; i < steps; ++i) {
    navigator.step(trajectory, begin + i * dt, dt);
    closure.compare(navigator.state(), ecef_state(trajectory.at(begin + (i + 1) * dt)));
  }
  return closure;
}

inline Closure close_strapdown(const simulation::Trajectory& trajectory, double begin,
                               double length, int64_t dt_ns, const Earth& earth = {}) {
  const int64_t begin_ns = static_cast<int64_t>(begin * 1e9 + 0.5);
  const Eigen::Quaterniond same = Eigen::Quaterniond::Identity();
  Strapdown navigator(trajectory.at(static_cast<double>(begin_ns) * 1e-9), earth);
  ImuIncrement previous =
      simulation::exact_increment(trajectory, same, 0, begin_ns - dt_ns, begin_ns);
  Closure closure;
  const int64_t end_ns = begin_ns + static_cast<int64_t>(length * 1e9 + 0.5);
  for (int64_t t = begin_ns; t < end_ns; t += dt_ns) {
    const ImuIncrement current = simulation::exact_increment(trajectory, same, 0, t, t + dt_ns);
    navigator.step(previous, current);
    closure.compare(navigator.state(),
                    ecef_state(trajectory.at(static_cast<double>(t + dt_ns) * 1e-9)));
    previous = current;
  }
  return closure;
}

}  // namespace foucault::testing
