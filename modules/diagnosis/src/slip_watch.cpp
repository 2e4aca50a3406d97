#include "foucault/diagnosis/slip_watch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "foucault/core/median.h"
#include "foucault/core/so3.h"
#include "lasting_noise.h"

namespace foucault::diagnosis {
namespace {

constexpr std::size_t kSlipMemory = 600;  // stretches: ten minutes in motion
constexpr std::size_t kLeastStretches = 30;
constexpr int kFitEvery = 10;     // stretches from fit to fit
constexpr double kMovesAt = 1;    // [m/s]; below, a mounting says nothing
constexpr double kSlipHuber = 2;  // deviations
/// What is known of the fit before: 10 deg, 1.5 m.
constexpr double kSlipMountingSigma = 0.17, kSlipArmSigma = 1.5;
constexpr double kLeastSlip = 0.01;  // [m/s], below which no road is smooth

/// Deviation beyond what is explained, with two sigmas of what so many values tell of it, so that
/// errors of the state do not pass for the absence of slip; and of white noise of as much power a
/// sample.
struct SlipNoise {
  double deviation = 0, white = 0;
};

SlipNoise slip_noise_of(const std::vector<double>& r, double explained) {
  const LastingNoise noise = lasting_noise(r);
  const double beyond =
      std::sqrt(std::max(noise.variance - explained, 0.0) + 2 * noise.variance_sigma);
  const double deviation = std::max(beyond, kLeastSlip);
  return {deviation, deviation * std::sqrt(noise.factor)};
}

}  // namespace

void SlipWatch::add(const measurement::BodyStretch& stretch, const state::Epoch& epoch,
                    const std::optional<double>& wheel) {
  const measurement::BodyVelocity u = measurement::body_velocity(stretch, epoch);
  if (u.value_b.norm() < kMovesAt) return;
  const Eigen::Matrix3d covariance_b = u.J * state::node_part(epoch.covariance) * u.J.transpose();
  samples_.push_back({C_v_b_ * u.value_b, C_v_b_ * (stretch.rate_b - epoch.bias.gyro),
                      C_v_b_ * covariance_b * C_v_b_.transpose(), wheel});
  if (samples_.size() > kSlipMemory) samples_.pop_front();
  if (samples_.size() < kLeastStretches || ++since_fit_ < kFitEvery) return;
  since_fit_ = 0;
  fit();
}

Eigen::Vector3d SlipWatch::point_velocity(const Sample& sample, const Fit& fit) const {
  const Eigen::Vector3d arm = fit.tail<3>();
  return so3::exp({0, fit[0], fit[1]}) * (sample.velocity_v + sample.rate_v.cross(arm));
}

/// Gauss and Newton with Huber's weights; the spread of one round weighs the next.
void SlipWatch::fit() {
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) step();
  judge_slip();
  judge_wheel();
}

void SlipWatch::step() {
  using Information = Eigen::Matrix<double, 5, 5>;
  Fit prior;
  prior << Eigen::Vector2d::Constant(1 / kSlipMountingSigma),
      Eigen::Vector3d::Constant(1 / kSlipArmSigma);
  Information A = prior.cwiseAbs2().asDiagonal();
  Fit b = -prior.cwiseAbs2().cwiseProduct(fit_);
  const Eigen::Vector3d turn(0, fit_[0], fit_[1]);
  const Eigen::Matrix3d M = so3::exp(turn).toRotationMatrix();
  const Eigen::Matrix3d Jr = so3::right_jacobian(turn);
  for (const Sample& sample : samples_) {
    const Eigen::Vector3d told =
        sample.velocity_v + sample.rate_v.cross(Eigen::Vector3d(fit_.tail<3>()));
    const Eigen::Vector3d p = M * told;
    Eigen::Matrix<double, 3, 5> J;
    J.leftCols<2>() = -(M * so3::skew(told) * Jr).rightCols<2>();
    J.rightCols<3>() = M * so3::skew(sample.rate_v);
    const Eigen::Matrix3d P = M * sample.covariance_v * M.transpose();
    for (int axis = 1; axis < 3; ++axis) {
      const double sigma = std::sqrt(P(axis, axis) + std::pow(spread_[axis - 1], 2));
      const double size = std::abs(p[axis]) / sigma;
      const double weight = (size > kSlipHuber ? kSlipHuber / size : 1) / (sigma * sigma);
      A += weight * J.row(axis).transpose() * J.row(axis);
      b -= weight * J.row(axis).transpose() * p[axis];
    }
  }
  fit_ += A.llt().solve(b);
  std::vector<double> right, down;
  for (const Sample& sample : samples_) {
    const Eigen::Vector3d p = point_velocity(sample, fit_);
    right.push_back(std::abs(p.y()));
    down.push_back(std::abs(p.z()));
  }
  spread_ = Eigen::Vector2d(median(right), median(down)) / 0.6745;
  spread_ = spread_.cwiseMax(kLeastSlip);
}

void SlipWatch::judge_slip() {
  SlipFindings found;
  found.samples = static_cast<int>(samples_.size());
  found.mounting = fit_.head<2>();
  found.arm_b = C_v_b_.transpose() * fit_.tail<3>();
  std::vector<double> right, down, explained_right, explained_down;
  double squares = 0;
  for (const Sample& sample : samples_) {
    const Eigen::Vector3d p = point_velocity(sample, fit_);
    right.push_back(p.y());
    down.push_back(p.z());
    explained_right.push_back(sample.covariance_v(1, 1));
    explained_down.push_back(sample.covariance_v(2, 2));
    squares += sample.velocity_v.squaredNorm();
  }
  const SlipNoise to_right = slip_noise_of(right, median(explained_right));
  const SlipNoise downward = slip_noise_of(down, median(explained_down));
  found.deviation = {to_right.deviation, downward.deviation};
  found.white = {to_right.white, downward.white};
  found.speed = std::sqrt(squares / static_cast<double>(samples_.size()));
  slip_ = found;
}

/// The scale is the median of ratios.
void SlipWatch::judge_wheel() {
  std::vector<double> ratios, r, explained;
  for (const Sample& sample : samples_) {
    if (!sample.wheel || std::abs(*sample.wheel) < 0.5 * kMovesAt) continue;
    ratios.push_back(point_velocity(sample, fit_).x() / *sample.wheel);
  }
  if (ratios.size() < kLeastStretches) return;
  WheelFindings found;
  found.samples = static_cast<int>(ratios.size());
  found.scale = median(ratios) - 1;
  for (const Sample& sample : samples_) {
    if (!sample.wheel) continue;
    r.push_back(point_velocity(sample, fit_).x() - (1 + found.scale) * *sample.wheel);
    explained.push_back(sample.covariance_v(0, 0));
  }
  const SlipNoise noise = slip_noise_of(r, median(explained));
  found.deviation = noise.deviation;
  found.white = noise.white;
  wheel_ = found;
}

}  // namespace foucault::diagnosis
