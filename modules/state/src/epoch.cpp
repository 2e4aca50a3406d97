#include "foucault/state/epoch.h"

#include <cmath>

namespace foucault {

Epoch with_slow_blocks(const Epoch& epoch, const Layout& layout) {
  if (epoch.covariance.rows() == layout.size()) return epoch;
  Epoch out = epoch;
  out.slow = SlowVector::Zero(layout.slow_size());
  out.covariance = StateMatrix::Zero(layout.size(), layout.size());
  node_part(out.covariance) = node_part(epoch.covariance);
  out.covariance.bottomRightCorner(layout.slow_size(), layout.slow_size()) = layout.prior();
  return out;
}

PackedSymmetric::PackedSymmetric(const StateMatrix& m) {
  lower_.reserve(static_cast<std::size_t>(m.rows() * (m.rows() + 1) / 2));
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) lower_.push_back(m(i, j));
  }
}

StateMatrix PackedSymmetric::full() const {
  const auto size = static_cast<Eigen::Index>(
      (std::sqrt(8 * static_cast<double>(lower_.size()) + 1) - 1) / 2 + 0.5);
  StateMatrix m(size, size);
  auto value = lower_.begin();
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) m(i, j) = m(j, i) = *value++;
  }
  return m;
}

}  // namespace foucault
