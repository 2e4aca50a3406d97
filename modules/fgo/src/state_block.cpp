#include "foucault/fgo/state_block.h"

namespace foucault {
namespace {

constexpr int kP = 0, kV = 3, kQ = 6, kBg = 10, kBa = 13;

/// d(q * exp(d)) / dd at d = 0 for q = xyzw, 4x3: half of the left product matrix (5).
Eigen::Matrix<double, 4, 3> quaternion_plus_jacobian(const double* q) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  Eigen::Matrix<double, 4, 3> J;
  J << w, -z, y, z, w, -x, -y, x, w, -x, -y, -z;
  return 0.5 * J;
}

}  // namespace

NodeState read_block(const double* block) {
  NodeState x;
  x.p_w_b = Eigen::Map<const Eigen::Vector3d>(block + kP);
  x.v_w_b = Eigen::Map<const Eigen::Vector3d>(block + kV);
  x.q_w_b = Eigen::Map<const Eigen::Quaterniond>(block + kQ);
  x.bias.gyro = Eigen::Map<const Eigen::Vector3d>(block + kBg);
  x.bias.accel = Eigen::Map<const Eigen::Vector3d>(block + kBa);
  return x;
}

void write_block(const NodeState& x, double* block) {
  Eigen::Map<Eigen::Vector3d>(block + kP) = x.p_w_b;
  Eigen::Map<Eigen::Vector3d>(block + kV) = x.v_w_b;
  Eigen::Map<Eigen::Quaterniond>(block + kQ) = x.q_w_b;
  Eigen::Map<Eigen::Vector3d>(block + kBg) = x.bias.gyro;
  Eigen::Map<Eigen::Vector3d>(block + kBa) = x.bias.accel;
}

Eigen::Matrix<double, 16, 15, Eigen::RowMajor> plus_jacobian(const double* block) {
  Eigen::Matrix<double, 16, 15, Eigen::RowMajor> J =
      Eigen::Matrix<double, 16, 15, Eigen::RowMajor>::Zero();
  J.block<6, 6>(kP, error_state::kPosition).setIdentity();
  J.block<4, 3>(kQ, error_state::kAttitude) = quaternion_plus_jacobian(block + kQ);
  J.block<6, 6>(kBg, error_state::kGyroBias).setIdentity();
  return J;
}

Eigen::Matrix<double, 15, 16, Eigen::RowMajor> minus_jacobian(const double* block) {
  Eigen::Matrix<double, 15, 16, Eigen::RowMajor> J =
      Eigen::Matrix<double, 15, 16, Eigen::RowMajor>::Zero();
  J.block<6, 6>(error_state::kPosition, kP).setIdentity();
  J.block<3, 4>(error_state::kAttitude, kQ) = quaternion_minus_jacobian(block + kQ);
  J.block<6, 6>(error_state::kGyroBias, kBg).setIdentity();
  return J;
}

Eigen::Matrix<double, 3, 4> quaternion_minus_jacobian(const double* q) {
  return 4 * quaternion_plus_jacobian(q).transpose();
}

bool StateManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  write_block(boxplus(read_block(x), Eigen::Map<const Vector15d>(delta)), x_plus_delta);
  return true;
}

bool StateManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 16, 15, Eigen::RowMajor>>{jacobian} = plus_jacobian(x);
  return true;
}

bool StateManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vector15d>{y_minus_x} = boxminus(read_block(y), read_block(x));
  return true;
}

bool StateManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 15, 16, Eigen::RowMajor>>{jacobian} = minus_jacobian(x);
  return true;
}

}  // namespace foucault
