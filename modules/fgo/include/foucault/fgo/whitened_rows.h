#pragma once

#include "foucault/state/kalman.h"

namespace foucault::fgo {

/// Rows that say something of a node's tangent and of the border: cost |r + J d|^2 / 2 with
/// d = (node, border). The border are the slow blocks, which all nodes of a graph share.
template <int kMostRows>
struct WhitenedRows {
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostRows, 1> r;
  state::RowsByState<kMostRows> J;
};
using ObservationRows = WhitenedRows<state::kMostMeasured>;
using StateRows = WhitenedRows<state::StateVector::MaxRowsAtCompileTime>;

}  // namespace foucault::fgo
