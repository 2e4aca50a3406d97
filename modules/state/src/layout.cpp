#include "foucault/state/layout.h"

#include <stdexcept>
#include <string>

namespace foucault::state {

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
  return scale;
}

SlowMatrix Layout::prior() const {
  SlowMatrix P = SlowMatrix::Zero(slow_size_, slow_size_);
  for (const SlowBlock& slow : slow_)
    P.diagonal().segment(slow.index, slow.block.size).setConstant(slow.sigma * slow.sigma);
  return P;
}

}  // namespace foucault::state
