#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "foucault/state/blocks.h"

namespace foucault::state {

/// A slow block as it is estimated: a constant, or a first-order Gauss-Markov process.
struct SlowBlock {
  Block block;
  double sigma = 0;  ///< before anything is measured, and steady state, each row
  double tau = 0;    ///< correlation time [s]; infinite for a constant
  int index = 0;     ///< first row among those of the slow blocks
};

/// Its part of a vector, or of a matrix, of a whole state.
template <class Vector>
auto part(Vector&& v, const SlowBlock& slow) {
  return v.segment(state_size(slow.index), slow.block.size);
}
template <class Matrix>
auto part(Matrix&& m, const SlowBlock& row, const SlowBlock& column) {
  return m.block(state_size(row.index), state_size(column.index), row.block.size,
                 column.block.size);
}
template <class Matrix>
auto columns_of(Matrix&& m, const SlowBlock& slow) {
  return m.middleCols(state_size(slow.index), slow.block.size);
}

/// Which blocks are estimated, and where each stands.
class Layout {
 public:
  /// At the end. Throws std::invalid_argument if it is there already, or if there is no room left.
  Layout& add(const Block& block, double sigma,
              double tau = std::numeric_limits<double>::infinity());

  const std::vector<SlowBlock>& slow() const { return slow_; }
  int slow_size() const { return slow_size_; }
  int size() const { return static_cast<int>(state_size(slow_size_)); }

  /// The block as it is estimated; null if it is not. Good until the next add().
  const SlowBlock* find(const Block& block) const;

  /// The first row of a slow block among the slow ones; none if it is not estimated.
  std::optional<int> slow_index(const Block& block) const;

  /// Scale factors and cross-axis terms of the IMU among slow blocks that have these values; zero
  /// where not estimated.
  ImuScale imu_scale(const SlowVector& slow) const;
  /// Whether any of these is estimated.
  bool has_imu_scale() const;

  /// Covariance of the slow blocks before anything is measured.
  SlowMatrix prior() const;

 private:
  std::vector<SlowBlock> slow_;
  int slow_size_ = 0;
};

}  // namespace foucault::state
