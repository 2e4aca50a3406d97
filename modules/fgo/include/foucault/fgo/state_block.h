#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <array>
#include <vector>

#include "foucault/fgo/whitened_rows.h"
#include "foucault/state/nav_state.h"

/// A node's state as Ceres sees it: one block of 16 numbers, p(3) v(3) q(xyzw) bg(3) ba(3), with
/// the tangent of NodeVector. One block a node, since all factors touch whole nodes: the solver
/// then keeps an eighth of the bookkeeping of one with p, v, q and biases apart. The border is
/// another block, the last of a factor's.
namespace foucault::fgo {

constexpr int kStateBlockSize = 16;
using StateBlock = std::array<double, kStateBlockSize>;

state::NodeState read_block(const double* block);
void write_block(const state::NodeState& x, double* block);

/// Of a factor's blocks: those of its nodes, and the border's if there is one.
std::vector<int32_t> block_sizes(int nodes, Eigen::Index slow);
/// The border among a factor's blocks; of no length if there is none.
state::SlowVector read_border(const ceres::CostFunction& factor, double const* const* blocks,
                              int nodes = 1);

/// d block / d tangent, 16x15, and its left inverse d tangent / d block, 15x16, at `block`.
Eigen::Matrix<double, kStateBlockSize, state::kNodeSize, Eigen::RowMajor> plus_jacobian(
    const double* block);
Eigen::Matrix<double, state::kNodeSize, kStateBlockSize, Eigen::RowMajor> minus_jacobian(
    const double* block);

/// Writes a Jacobian by a node's tangent, as many rows by 15, as one by its block.
using NodeColumns = Eigen::Matrix<double, Eigen::Dynamic, state::kNodeSize, Eigen::ColMajor,
                                  state::kMostSize, state::kNodeSize>;
void write_node_jacobian(const NodeColumns& J, const double* block, double* out);
/// Writes one by the border.
using BorderColumns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                    state::kMostSize, state::kMostSlow>;
void write_border_jacobian(const BorderColumns& J, double* out);

/// What a factor of one node gives Ceres.
template <int kMostRows>
void write_rows(const WhitenedRows<kMostRows>& rows, double const* const* blocks, double* residual,
                double** jacobians) {
  Eigen::Map<Eigen::VectorXd>(residual, rows.r.size()) = rows.r;
  if (jacobians == nullptr) return;
  if (jacobians[0] != nullptr)
    write_node_jacobian(rows.J.template leftCols<state::kNodeSize>(), blocks[0], jacobians[0]);
  const Eigen::Index slow = rows.J.cols() - state::kNodeSize;
  if (slow > 0 && jacobians[1] != nullptr)
    write_border_jacobian(rows.J.rightCols(slow), jacobians[1]);
}

/// Right perturbation, boxplus and boxminus of NodeState.
class StateManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kStateBlockSize; }
  int TangentSize() const override { return state::kNodeSize; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace foucault::fgo
