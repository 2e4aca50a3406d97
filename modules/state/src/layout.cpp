#include "foucault/state/layout.h"

#include <Eigen/LU>
#include <stdexcept>
#include <string>

namespace foucault::state {
namespace {

void put(const Eigen::Vector3d& values, const AxisPairs& pairs, Eigen::Matrix3d& M) {
  for (int m = 0; m < 3; ++m) M(pairs.row[m], pairs.column[m]) = values[m];
}

Eigen::Matrix3d gain(const Eigen::Matrix3d& M) {
  return (Eigen::Matrix3d::Identity() + M).inverse();
}

}  // namespace

Eigen::Matrix3d ImuScale::gyro_matrix() const {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  put(gyro, axis_pairs::scale, M);
  put(gyro_cross.head<3>(), axis_pairs::gyro_cross[0], M);
  put(gyro_cross.tail<3>(), axis_pairs::gyro_cross[1], M);
  return M;
}

Eigen::Matrix3d ImuScale::accel_matrix() const {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  put(accel, axis_pairs::scale, M);
  put(accel_cross, axis_pairs::accel_cross, M);
  return M;
}

Eigen::Matrix3d ImuScale::gyro_gain() const { return gain(gyro_matrix()); }
Eigen::Matrix3d ImuScale::accel_gain() const { return gain(accel_matrix()); }

Layout& Layout::add(const Block& block, double sigma, double tau) {
  if (find(block))
    throw std::invalid_argument("block " + std::string(block.name) + " is there already");
  if (slow_size_ + block.size > kMostSlow)
    throw std::invalid_argument("no room for block " + std::string(block.name));
  slow_.push_back({block, sigma, tau, slow_size_});
  slow_size_ += block.size;
  return *this;
}

const SlowBlock* Layout::find(const Block& block) const {
  for (const SlowBlock& slow : slow_) {
    if (slow.block.name == block.name) return &slow;
  }
  return nullptr;
}

std::optional<int> Layout::slow_index(const Block& block) const {
  const SlowBlock* found = find(block);
  return found ? std::optional<int>(found->index) : std::nullopt;
}

ImuScale Layout::imu_scale(const SlowVector& slow) const {
  ImuScale scale;
  if (const SlowBlock* gyro = find(block::gyro_scale)) scale.gyro = slow.segment<3>(gyro->index);
  if (const SlowBlock* accel = find(block::accel_scale))
    scale.accel = slow.segment<3>(accel->index);
  if (const SlowBlock* gyro = find(block::gyro_cross_axis))
    scale.gyro_cross = slow.segment(gyro->index, gyro->block.size);
  if (const SlowBlock* accel = find(block::accel_cross_axis))
    scale.accel_cross = slow.segment<3>(accel->index);
  return scale;
}

bool Layout::has_imu_scale() const {
  return find(block::gyro_scale) || find(block::accel_scale) || find(block::gyro_cross_axis) ||
         find(block::accel_cross_axis);
}

SlowMatrix Layout::prior() const {
  SlowMatrix P = SlowMatrix::Zero(slow_size_, slow_size_);
  for (const SlowBlock& slow : slow_)
    P.diagonal().segment(slow.index, slow.block.size).setConstant(slow.sigma * slow.sigma);
  return P;
}

}  // namespace foucault::state
