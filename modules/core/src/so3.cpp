#include "foucault/core/so3.h"

#include <array>
#include <cmath>

#include "foucault/core/constants.h"

namespace foucault::so3 {
namespace {

/// sin(x/2) / x. Below 1e-4 the next term, x^4 / 1920, is under 6e-20 of the value.
double half_sinc(double x) { return x < 1e-4 ? 0.5 - x * x / 48 : std::sin(x / 2) / x; }

/// (x - sin x) / x^3 = 1/3! - x^2/5! + x^4/7! - ... The difference loses 6 eps / x^2, so below 1
/// the series is summed; its first term left out is under 2e-20.
double sine_remainder(double x) {
  if (x >= 1) return (x - std::sin(x)) / (x * x * x);
  double sum = 1;
  for (int k = 18; k >= 4; k -= 2) sum = 1 - x * x / (k * (k + 1)) * sum;
  return sum / 6;
}

/// (1 - x/2 cot(x/2)) / x^2 = sum of |B_2k| / (2k)! x^(2k-2), B the Bernoulli numbers. The
/// difference loses 12 eps / x^2; below 0.3 the first term left out is under 8e-18.
double cotangent_remainder(double x) {
  if (x >= 0.3) return (1 - x / 2 * std::cos(x / 2) / std::sin(x / 2)) / (x * x);
  constexpr std::array kCoefficients{1.0 / 12,      1.0 / 720,      1.0 / 30240,
                                     1.0 / 1209600, 1.0 / 47900160, 691.0 / 1307674368000.0};
  double sum = 0;
  for (auto c = kCoefficients.rbegin(); c != kCoefficients.rend(); ++c) sum = sum * x * x + *c;
  return sum;
}

/// I + a [r x] + b [r x]^2.
Eigen::Matrix3d rotation_polynomial(const Eigen::Vector3d& r, double a, double b) {
  const Eigen::Matrix3d r_cross = skew(r);
  return Eigen::Matrix3d::Identity() + a * r_cross + b * r_cross * r_cross;
}

/// exp() for an angle below 0.1, with x its square: sin(a/2)/a and cos(a/2) by their series; what
/// is left out is under 3e-19. Most rotations are those of an IMU's sample.
Eigen::Quaterniond exp_of_small(const Eigen::Vector3d& rotation, double x) {
  const double s = 0.5 - x * (1.0 / 48 - x * (1.0 / 3840 - x * (1.0 / 645120 - x / 185794560)));
  const double c = 1 - x * (1.0 / 8 - x * (1.0 / 384 - x * (1.0 / 46080 - x / 10321920)));
  return {c, s * rotation.x(), s * rotation.y(), s * rotation.z()};
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond exp(const Eigen::Vector3d& rotation) {
  const double square = rotation.squaredNorm();
  if (square < 0.01) return exp_of_small(rotation, square);
  const double angle = std::sqrt(square);
  const Eigen::Vector3d vec = half_sinc(angle) * rotation;
  return {std::cos(angle / 2), vec.x(), vec.y(), vec.z()};
}

Eigen::Vector3d log(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1 : 1;  // q and -q are one rotation: take the shorter way
  const double w = sign * q.w();
  const double n = q.vec().norm();
  // atan(n/w) = n/w - (n/w)^3/3 + ...; below 1e-4 the next term is under 2e-17 of the value.
  const double scale = n < 1e-4 * w ? 2 / w * (1 - n * n / (3 * w * w)) : 2 * std::atan2(n, w) / n;
  return sign * scale * q.vec();
}

Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const double h = half_sinc(angle);  // (1 - cos x) / x^2 = 2 (sin(x/2) / x)^2
  return rotation_polynomial(rotation, -2 * h * h, sine_remainder(angle));
}

Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& rotation) {
  return rotation_polynomial(rotation, 0.5, cotangent_remainder(rotation.norm()));
}

Euler to_euler(const Eigen::Quaterniond& q_n_v) {
  const Eigen::Matrix3d R = q_n_v.toRotationMatrix();
  const double heading = std::atan2(R(1, 0), R(0, 0));
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  // Roll by the heading just found: where pitch nears +-pi/2 and only their sum or difference is
  // determined, the pair still gives the right rotation.
  const double s = std::sin(heading);
  const double c = std::cos(heading);
  const double roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  const double positive = heading < 0 ? heading + 2 * kPi : heading;
  return {wrap(roll), pitch, positive < 2 * kPi ? positive : 0};
}

Eigen::Quaterniond from_euler(const Euler& euler) {
  return Eigen::AngleAxisd(euler.heading, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(euler.pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(euler.roll, Eigen::Vector3d::UnitX());
}

Eigen::Matrix3d euler_jacobian(const Euler& euler) {
  const double s = std::sin(euler.roll);
  const double c = std::cos(euler.roll);
  const double cos_pitch = std::cos(euler.pitch);
  const double tan_pitch = std::tan(euler.pitch);
  Eigen::Matrix3d J;
  J << 1, s * tan_pitch, c * tan_pitch,  //
      0, c, -s,                          //
      0, s / cos_pitch, c / cos_pitch;
  return J;
}

double wrap(double angle) {
  const double wrapped = std::remainder(angle, 2 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

}  // namespace foucault::so3
