#pragma once

#include "foucault/state/kalman.h"

namespace foucault::fgo {

/// Rows that say something of a node's tangent and of the border: cost |r + J d|^2 / 2 with
/// d = (node, border). The border are the slow blocks, which all nodes of a graph share.
template <int kMostRows>
struct WhitenedRows {
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostRows, 1> r;
  RowsByState<kMostRows> J;
};
using ObservationRows = WhitenedRows<kMostMeasured>;
using StateRows = WhitenedRows<StateVector::MaxRowsAtCompileTime>;

}  // namespace foucault::fgo
