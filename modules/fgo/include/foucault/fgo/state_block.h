#pragma once

#include <ceres/manifold.h>

#include <array>

#include "foucault/preintegration/motion.h"

/// A node's state as Ceres sees it: one block of 16 numbers, p(3) v(3) q(xyzw) bg(3) ba(3), with
/// the tangent of error_state. One block a node, since all factors touch whole nodes: the solver
/// then keeps an eighth of the bookkeeping of one with p, v, q and biases apart.
namespace foucault {

constexpr int kStateBlockSize = 16;
using StateBlock = std::array<double, kStateBlockSize>;

NodeState read_block(const double* block);
void write_block(const NodeState& x, double* block);

/// d block / d tangent, 16x15, and its left inverse d tangent / d block, 15x16, at `block`.
Eigen::Matrix<double, 16, 15, Eigen::RowMajor> plus_jacobian(const double* block);
Eigen::Matrix<double, 15, 16, Eigen::RowMajor> minus_jacobian(const double* block);

/// d dtheta / d(xyzw) at the unit quaternion q.
Eigen::Matrix<double, 3, 4> quaternion_minus_jacobian(const double* q);

/// tangent * minus_jacobian(block): only the attitude's columns are more than copied.
template <int kRows>
Eigen::Matrix<double, kRows, 16, Eigen::RowMajor> ambient_jacobian(
    const Eigen::Matrix<double, kRows, 15>& tangent, const double* block) {
  using error_state::kAttitude;
  Eigen::Matrix<double, kRows, 16, Eigen::RowMajor> J;
  J.template leftCols<6>() = tangent.template leftCols<6>();
  J.template middleCols<4>(6) =
      tangent.template middleCols<3>(kAttitude) * quaternion_minus_jacobian(block + 6);
  J.template rightCols<6>() = tangent.template rightCols<6>();
  return J;
}

/// Right perturbation, boxplus and boxminus of motion.h.
class StateManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kStateBlockSize; }
  int TangentSize() const override { return error_state::kSize; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace foucault
