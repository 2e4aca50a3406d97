#pragma once

#include <Eigen/Core>

/// Lower triangles, column by column.
namespace foucault::fgo {

template <class Matrix>
double* pack_lower(const Matrix& M, double* to) {
  for (Eigen::Index j = 0; j < M.cols(); ++j) {
    for (Eigen::Index i = j; i < M.rows(); ++i) *to++ = M(i, j);
  }
  return to;
}

/// What is above the diagonal stays as it is.
template <class Matrix>
const double* unpack_lower(const double* from, Matrix& M) {
  for (Eigen::Index j = 0; j < M.cols(); ++j) {
    for (Eigen::Index i = j; i < M.rows(); ++i) M(i, j) = *from++;
  }
  return from;
}

}  // namespace foucault::fgo
