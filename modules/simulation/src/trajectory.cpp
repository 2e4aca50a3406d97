#include "foucault/simulation/trajectory.h"

#include <cmath>
#include <utility>

#include "foucault/core/constants.h"
#include "foucault/geodesy/wgs84.h"

namespace foucault::simulation {
namespace {

/// A number that changes, with its derivatives by time.
struct Changing {
  double value, rate, acceleration;
};

/// Adds amplitude * sin(w t + k pi / 2) on axis k, with its derivatives.
void add_sine(QuinticSpline::Sample& sample, const Changing& amplitude, double frequency_hz,
              double t) {
  const double w = 2 * kPi * frequency_hz;
  const double s = std::sin(w * t), c = std::cos(w * t);
  const Eigen::Vector3d sine(s, c, -s), cosine(c, -s, -c);
  sample.value += amplitude.value * sine;
  sample.rate += amplitude.value * w * cosine + amplitude.rate * sine;
  sample.acceleration -= amplitude.value * w * w * sine;
  sample.acceleration += 2 * amplitude.rate * w * cosine + amplitude.acceleration * sine;
}

/// Rate of n relative to e, in n [rad/s] (transport rate).
Eigen::Vector3d transport_rate_n(const Geodetic& position, const Eigen::Vector3d& velocity_n) {
  const double north_radius = geodesy::wgs84::meridian_radius(position.latitude) + position.height;
  const double east_radius = geodesy::wgs84::transverse_radius(position.latitude) + position.height;
  const double about_north = velocity_n.y() / east_radius;
  return {about_north, -velocity_n.x() / north_radius, -about_north * std::tan(position.latitude)};
}

struct SinCos {
  explicit SinCos(double angle) : s(std::sin(angle)), c(std::cos(angle)) {}
  double s, c;
};

/// Rotation n from v and the rate of v relative to n, of roll, pitch, heading and their rates.
struct Attitude {
  Attitude(const Eigen::Vector3d& euler, const Eigen::Vector3d& rate) {
    const SinCos r(euler.x()), p(euler.y()), h(euler.z());
    R_n_v << p.c * h.c, r.s * p.s * h.c - r.c * h.s, r.c * p.s * h.c + r.s * h.s,  //
        p.c * h.s, r.s * p.s * h.s + r.c * h.c, r.c * p.s * h.s - r.s * h.c,       //
        -p.s, r.s * p.c, r.c * p.c;
    omega_nv_v = {rate.x() - rate.z() * p.s, rate.y() * r.c + rate.z() * p.c * r.s,
                  rate.z() * p.c * r.c - rate.y() * r.s};
  }
  Eigen::Matrix3d R_n_v;
  Eigen::Vector3d omega_nv_v;
};

}  // namespace

Eigen::Vector3d point_velocity_n(const Motion& motion, const Eigen::Vector3d& p_v_x) {
  const Eigen::Vector3d omega_ie_v =
      motion.q_n_v.conjugate() * geodesy::wgs84::earth_rate_n(motion.position.latitude);
  const Eigen::Vector3d omega_ev_v = motion.omega_iv_v - omega_ie_v;
  return motion.velocity_n + motion.q_n_v * omega_ev_v.cross(p_v_x);
}

Trajectory::Trajectory(const Geodetic& origin, QuinticSpline position_w, QuinticSpline euler,
                       Vibration vibration)
    : origin_e_(geodesy::wgs84::geodetic_to_ecef(origin)),
      R_e_w_(geodesy::wgs84::R_e_n(origin.latitude, origin.longitude)),
      position_w_(std::move(position_w)),
      euler_(std::move(euler)),
      vibration_(std::move(vibration)) {}

void Trajectory::vibrate(QuinticSpline::Sample& sample, double amplitude, double t) const {
  if (amplitude == 0) return;
  Changing changing{amplitude, 0, 0};
  if (vibration_.growth) {
    const QuinticSpline::Sample growth = vibration_.growth->at(t);
    changing = {amplitude * (1 + growth.value.x()), amplitude * growth.rate.x(),
                amplitude * growth.acceleration.x()};
  }
  add_sine(sample, changing, vibration_.frequency_hz, t);
}

QuinticSpline::Sample Trajectory::position_at(double t) const {
  QuinticSpline::Sample sample = position_w_.at(t);
  vibrate(sample, vibration_.position_amplitude, t);
  return sample;
}

QuinticSpline::Sample Trajectory::euler_at(double t) const {
  QuinticSpline::Sample sample = euler_.at(t);
  vibrate(sample, vibration_.angle_amplitude, t);
  return sample;
}

Motion Trajectory::at(double t) const { return motion_of(position_at(t), euler_at(t)); }

Motion Trajectory::steady_at(double t) const { return motion_of(position_w_.at(t), euler_.at(t)); }

Motion Trajectory::motion_of(const QuinticSpline::Sample& position,
                             const QuinticSpline::Sample& euler) const {
  const Attitude attitude(euler.value, euler.rate);

  Motion motion;
  motion.p_e = origin_e_ + R_e_w_ * position.value;
  motion.position = geodesy::wgs84::ecef_to_geodetic(motion.p_e);
  const Geodetic& place = motion.position;
  const Eigen::Matrix3d R_n_w =
      geodesy::wgs84::R_e_n(place.latitude, place.longitude).transpose() * R_e_w_;
  motion.velocity_n = R_n_w * position.rate;
  motion.q_n_v = Eigen::Quaterniond(attitude.R_n_v);

  const Eigen::Vector3d omega_ie_n = geodesy::wgs84::earth_rate_n(place.latitude);
  const Eigen::Vector3d omega_en_n = transport_rate_n(place, motion.velocity_n);
  const Eigen::Vector3d g_n(0, 0, geodesy::wgs84::normal_gravity(place.latitude, place.height));
  const Eigen::Vector3d f_n =
      R_n_w * position.acceleration + 2 * omega_ie_n.cross(motion.velocity_n) - g_n;
  motion.omega_iv_v = attitude.R_n_v.transpose() * (omega_ie_n + omega_en_n) + attitude.omega_nv_v;
  motion.f_v = attitude.R_n_v.transpose() * f_n;
  return motion;
}

}  // namespace foucault::simulation
