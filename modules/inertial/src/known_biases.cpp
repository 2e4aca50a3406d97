#include "known_biases.h"

#include <Eigen/Cholesky>

#include "foucault/core/so3.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault {

Epoch with_known_biases(const Epoch& aligned, const Epoch& earlier) {
  using namespace error_state;
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  constexpr double kVarianceGrows = 4;
  const Matrix15d& P = aligned.covariance;
  const Matrix6d R =
      kVarianceGrows * earlier.covariance.block<6, 6>(kGyroBias, kGyroBias).diagonal().asDiagonal();
  const Matrix6d S = P.block<6, 6>(kGyroBias, kGyroBias) + R;
  const Eigen::Matrix<double, 6, 15> HP = P.middleRows<6>(kGyroBias);
  const Eigen::Matrix<double, 15, 6> K = Eigen::LDLT<Matrix6d>(S).solve(HP).transpose();
  Vector6d innovation;
  innovation << earlier.bias.gyro - aligned.bias.gyro, earlier.bias.accel - aligned.bias.accel;
  const Vector15d error = K * innovation;

  Epoch out = aligned;
  out.position = LocalFrame(aligned.position).to_geodetic(error.segment<3>(kPosition));
  out.velocity_n += error.segment<3>(kVelocity);
  out.q_n_b = (aligned.q_n_b * so3::exp(error.segment<3>(kAttitude))).normalized();
  out.bias.gyro += error.segment<3>(kGyroBias);
  out.bias.accel += error.segment<3>(kAccelBias);
  Matrix15d I_KH = Matrix15d::Identity();
  I_KH.middleCols<6>(kGyroBias) -= K;
  const Matrix15d updated = I_KH * P * I_KH.transpose() + K * R * K.transpose();
  out.covariance = 0.5 * (updated + updated.transpose());
  return out;
}

}  // namespace foucault
