#include "foucault/fgo/state_block.h"

namespace foucault::fgo {
namespace {

constexpr int kP = 0, kV = 3, kQ = 6, kBg = 10, kBa = 13;

/// All but the attitude are their own tangents.
struct Copied {
  int at;
  state::NodeBlock tangent;
};
constexpr Copied kCopied[] = {{kP, state::block::position},
                              {kV, state::block::velocity},
                              {kBg, state::block::gyro_bias},
                              {kBa, state::block::accel_bias}};

/// d(q * exp(d)) / dd at d = 0 for q = xyzw, 4x3: half of the left product matrix (5).
Eigen::Matrix<double, 4, 3> quaternion_plus_jacobian(const double* q) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  Eigen::Matrix<double, 4, 3> J;
  J << w, -z, y, z, w, -x, -y, x, w, -x, -y, -z;
  return 0.5 * J;
}

/// d dtheta / d(xyzw) at the unit quaternion q.
Eigen::Matrix<double, 3, 4> quaternion_minus_jacobian(const double* q) {
  return 4 * quaternion_plus_jacobian(q).transpose();
}

using PlusMatrix = Eigen::Matrix<double, kStateBlockSize, state::kNodeSize, Eigen::RowMajor>;
using MinusMatrix = Eigen::Matrix<double, state::kNodeSize, kStateBlockSize, Eigen::RowMajor>;

}  // namespace

state::NodeState read_block(const double* block) {
  state::NodeState x;
  x.p_w_b = Eigen::Map<const Eigen::Vector3d>(block + kP);
  x.v_w_b = Eigen::Map<const Eigen::Vector3d>(block + kV);
  x.q_w_b = Eigen::Map<const Eigen::Quaterniond>(block + kQ);
  x.bias.gyro = Eigen::Map<const Eigen::Vector3d>(block + kBg);
  x.bias.accel = Eigen::Map<const Eigen::Vector3d>(block + kBa);
  return x;
}

void write_block(const state::NodeState& x, double* block) {
  Eigen::Map<Eigen::Vector3d>(block + kP) = x.p_w_b;
  Eigen::Map<Eigen::Vector3d>(block + kV) = x.v_w_b;
  Eigen::Map<Eigen::Quaterniond>(block + kQ) = x.q_w_b;
  Eigen::Map<Eigen::Vector3d>(block + kBg) = x.bias.gyro;
  Eigen::Map<Eigen::Vector3d>(block + kBa) = x.bias.accel;
}

std::vector<int32_t> block_sizes(int nodes, Eigen::Index slow) {
  std::vector<int32_t> sizes(nodes, kStateBlockSize);
  if (slow > 0) sizes.push_back(static_cast<int32_t>(slow));
  return sizes;
}

state::SlowVector read_border(const ceres::CostFunction& factor, double const* const* blocks,
                              int nodes) {
  const std::vector<int32_t>& sizes = factor.parameter_block_sizes();
  if (static_cast<int>(sizes.size()) == nodes) return state::SlowVector(0);
  return Eigen::Map<const Eigen::VectorXd>(blocks[nodes], sizes[nodes]);
}

PlusMatrix plus_jacobian(const double* block) {
  PlusMatrix J = PlusMatrix::Zero();
  for (const Copied& copied : kCopied)
    J.block<3, 3>(copied.at, copied.tangent.offset).setIdentity();
  J.block<4, 3>(kQ, state::block::attitude.offset) = quaternion_plus_jacobian(block + kQ);
  return J;
}

MinusMatrix minus_jacobian(const double* block) {
  MinusMatrix J = MinusMatrix::Zero();
  for (const Copied& copied : kCopied)
    J.block<3, 3>(copied.tangent.offset, copied.at).setIdentity();
  J.block<3, 4>(state::block::attitude.offset, kQ) = quaternion_minus_jacobian(block + kQ);
  return J;
}

/// J * minus_jacobian(block): only the attitude's columns are more than copied.
void write_node_jacobian(const NodeColumns& J, const double* block, double* out) {
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kStateBlockSize, Eigen::RowMajor>> ambient(
      out, J.rows(), kStateBlockSize);
  for (const Copied& copied : kCopied)
    ambient.middleCols<3>(copied.at) = state::columns_of(J, copied.tangent);
  ambient.middleCols<4>(kQ) = state::columns_of(J, state::block::attitude)
                                  .lazyProduct(quaternion_minus_jacobian(block + kQ));
}

void write_border_jacobian(const BorderColumns& J, double* out) {
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(out, J.rows(),
                                                                                     J.cols()) = J;
}

bool StateManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  write_block(state::boxplus(read_block(x), Eigen::Map<const state::NodeVector>(delta)),
              x_plus_delta);
  return true;
}

bool StateManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<PlusMatrix>{jacobian} = plus_jacobian(x);
  return true;
}

bool StateManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<state::NodeVector>{y_minus_x} = state::boxminus(read_block(y), read_block(x));
  return true;
}

bool StateManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<MinusMatrix>{jacobian} = minus_jacobian(x);
  return true;
}

}  // namespace foucault::fgo
