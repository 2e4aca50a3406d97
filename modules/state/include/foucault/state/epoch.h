#pragma once

#include <vector>

#include "foucault/state/layout.h"
#include "foucault/state/nav_state.h"

namespace foucault::state {

/// An estimate: a state and the covariance of its error. Of what has no slow blocks the covariance
/// is that of a node.
struct Epoch : NavState {
  StateMatrix covariance = NodeMatrix::Zero();

  Eigen::Matrix3d covariance_of(const NodeBlock& block) const {
    return part(covariance, block, block);
  }
  Eigen::Vector3d sigma_of(const NodeBlock& block) const {
    return covariance_of(block).diagonal().cwiseMax(0).cwiseSqrt();
  }
};

/// The same with the slow blocks of a layout; those that it lacks are zero within their prior. None
/// is less certain than its prior, whatever was made of it over restarts; correlations stay.
Epoch with_slow_blocks(const Epoch& epoch, const Layout& layout);

/// A symmetric matrix that is kept for long: half of it.
class PackedSymmetric {
 public:
  PackedSymmetric() = default;
  explicit PackedSymmetric(const StateMatrix& m);
  StateMatrix full() const;

 private:
  std::vector<double> lower_;  ///< rows of the lower triangle
};

}  // namespace foucault::state
