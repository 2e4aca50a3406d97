#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/measurement.h"
#include "foucault/core/so3.h"
#include "foucault/preintegration/motion.h"

/// Motion over a rotating Earth with the gravity of an EarthModel, in closed form: position by
/// sines, attitude by a cone about the vertical. Specific force and angular rate are exact,
/// increments come from 5-point Gauss-Legendre quadrature.
namespace foucault::testing {

class ClosedFormMotion {
 public:
  explicit ClosedFormMotion(const preintegration::EarthModel& earth, double liveliness = 1)
      : earth_(earth), live_(liveliness) {}

  Eigen::Vector3d p(double t) const {
    return live_ * Eigen::Vector3d(12 * t + 3 * std::sin(0.9 * t), 5 * std::cos(0.6 * t),
                                   0.4 * std::sin(1.7 * t));
  }
  Eigen::Vector3d v(double t) const {
    return live_ * Eigen::Vector3d(12 + 2.7 * std::cos(0.9 * t), -3 * std::sin(0.6 * t),
                                   0.68 * std::cos(1.7 * t));
  }
  Eigen::Vector3d a(double t) const {
    return live_ * Eigen::Vector3d(-2.43 * std::sin(0.9 * t), -1.8 * std::cos(0.6 * t),
                                   -1.156 * std::sin(1.7 * t));
  }
  /// q = Rz(alpha t) Ry(beta) Rz(gamma t): the axis of rotation turns with t.
  Eigen::Quaterniond q(double t) const {
    using Eigen::AngleAxisd;
    using Eigen::Vector3d;
    return Eigen::Quaterniond(AngleAxisd(alpha() * t, Vector3d::UnitZ()) *
                              AngleAxisd(kBeta, Vector3d::UnitY()) *
                              AngleAxisd(gamma() * t, Vector3d::UnitZ()));
  }
  /// Rate of b relative to w, in b.
  Eigen::Vector3d rate(double t) const {
    const double g = gamma() * t;
    const Eigen::Vector3d z_in_b(-std::sin(kBeta) * std::cos(g), std::sin(kBeta) * std::sin(g),
                                 std::cos(kBeta));
    return alpha() * z_in_b + gamma() * Eigen::Vector3d::UnitZ();
  }

  Eigen::Vector3d omega_ib_b(double t) const {
    return rate(t) + q(t).conjugate() * earth_.omega_ie_w;
  }
  Eigen::Vector3d specific_force_b(double t) const {
    return q(t).conjugate() * (a(t) - earth_.gravity(p(t)) + 2 * earth_.omega_ie_w.cross(v(t)));
  }

  state::NodeState state(double t) const {
    state::NodeState x;
    x.p_w_b = p(t);
    x.v_w_b = v(t);
    x.q_w_b = q(t);
    return x;
  }

  ImuIncrement increment(int64_t begin_ns, int64_t end_ns) const {
    constexpr double kNode[5] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                 0.9061798459386640};
    constexpr double kWeight[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                   0.4786286704993665, 0.2369268850561891};
    ImuIncrement out;
    out.t_begin_ns = begin_ns;
    out.t_end_ns = end_ns;
    const double half = 0.5 * out.dt();
    const double middle = 0.5e-9 * static_cast<double>(begin_ns + end_ns);
    for (int i = 0; i < 5; ++i) {
      const double t = middle + half * kNode[i];
      out.dtheta_b += half * kWeight[i] * omega_ib_b(t);
      out.dvel_b += half * kWeight[i] * specific_force_b(t);
    }
    return out;
  }

  /// Increments of `rate_hz` over [begin, end) s, the one before `begin` in front.
  std::vector<ImuIncrement> increments(double begin, double end, double rate_hz) const {
    const int64_t step = static_cast<int64_t>(std::llround(1e9 / rate_hz));
    const int64_t first = static_cast<int64_t>(std::llround(begin * 1e9));
    const int64_t last = static_cast<int64_t>(std::llround(end * 1e9));
    std::vector<ImuIncrement> out;
    for (int64_t t = first - step; t < last; t += step) out.push_back(increment(t, t + step));
    return out;
  }

 private:
  static constexpr double kBeta = 0.3;
  double alpha() const { return 0.7 * live_; }
  double gamma() const { return -0.5 * live_; }

  preintegration::EarthModel earth_;
  double live_;
};

/// What an IMU with these errors makes of increments.
inline std::vector<ImuIncrement> measured(std::vector<ImuIncrement> increments,
                                          const state::ImuBias& bias,
                                          const state::ImuScale& scale) {
  for (ImuIncrement& i : increments) {
    i.dtheta_b += scale.gyro.cwiseProduct(i.dtheta_b) + i.dt() * bias.gyro;
    i.dvel_b += scale.accel.cwiseProduct(i.dvel_b) + i.dt() * bias.accel;
  }
  return increments;
}

/// Preintegrates all but the first increment, which stands before the interval.
inline preintegration::Preintegration preintegrate(
    const std::vector<ImuIncrement>& increments, const imu::ImuNoise& noise = {},
    const state::ImuBias& bias = {}, const std::optional<state::ImuScale>& scale = std::nullopt) {
  preintegration::Preintegrator integrator(noise, bias, increments[1].t_begin_ns,
                                           increments.front(), scale);
  for (std::size_t i = 1; i < increments.size(); ++i) integrator.add(increments[i]);
  return integrator.result();
}

inline preintegration::EarthModel wuhan_earth() {
  return preintegration::earth_model(
      preintegration::PreintegrationModel::refined,
      geodesy::LocalFrame(Geodetic{30.45 * kDegree, 114.47 * kDegree, 20}),
      Eigen::Vector3d::Zero());
}

}  // namespace foucault::testing
