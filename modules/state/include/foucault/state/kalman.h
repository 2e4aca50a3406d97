#pragma once

#include "foucault/state/nav_state.h"

/// The Kalman update.
namespace foucault::state {

/// A linearized measurement: r = H error + noise, R the noise's covariance. r is measured minus
/// predicted, the columns of H are the rows of a state.
template <int kMostRows>
struct LinearizedRows {
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostRows, 1> r;
  RowsByState<kMostRows> H;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostRows, kMostRows> R;

  LinearizedRows() = default;
  /// H is zero.
  LinearizedRows(int rows, int columns) : r(rows), H(rows, columns), R(rows, rows) { H.setZero(); }
};

constexpr int kMostMeasured = 6;  ///< rows of one measurement
using Linearized = LinearizedRows<kMostMeasured>;
using LinearizedState = LinearizedRows<StateVector::MaxRowsAtCompileTime>;  ///< of all its rows

/// Prediction error of a measurement before it is used, and its covariance.
struct Innovation {
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostMeasured, 1> value;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostMeasured,
                kMostMeasured>
      covariance;
};
Innovation innovation_of(const Linearized& z, const StateMatrix& covariance);

/// Uses a measurement. Joseph form: the covariance stays positive definite whatever the rounding.
/// With the attitude moved by exp(d), the error that was d + x becomes Jr(d) x: the covariance is
/// turned so.
template <int kMostRows>
void kalman_update(const LinearizedRows<kMostRows>& z, NavState& x, StateMatrix& covariance);

}  // namespace foucault::state
