#include "foucault/state/epoch.h"

#include <cmath>

namespace foucault::state {
namespace {

/// Of each row, what its sigma is to be multiplied by.
StateVector shrinkage(const StateMatrix& covariance, const Layout& layout) {
  StateVector factors = StateVector::Ones(layout.size());
  for (const SlowBlock& slow : layout.slow()) {
    const StateVector sigmas = part(covariance.diagonal(), slow).cwiseMax(0).cwiseSqrt();
    part(factors, slow) = (sigmas.array() > slow.sigma).select(slow.sigma / sigmas.array(), 1);
  }
  return factors;
}

Epoch within_prior(const Epoch& epoch, const Layout& layout) {
  const StateVector factors = shrinkage(epoch.covariance, layout);
  if (factors.minCoeff() == 1) return epoch;
  Epoch out = epoch;
  out.covariance = factors.asDiagonal() * epoch.covariance * factors.asDiagonal();
  return out;
}

}  // namespace

Epoch with_slow_blocks(const Epoch& epoch, const Layout& layout) {
  if (epoch.covariance.rows() == layout.size()) return within_prior(epoch, layout);
  Epoch out = epoch;
  out.slow = SlowVector::Zero(layout.slow_size());
  out.covariance = StateMatrix::Zero(layout.size(), layout.size());
  node_part(out.covariance) = node_part(epoch.covariance);
  slow_part(out.covariance) = layout.prior();
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

}  // namespace foucault::state
