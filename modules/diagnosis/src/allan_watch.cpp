#include "foucault/diagnosis/allan_watch.h"

#include <cmath>

namespace foucault::diagnosis {

void AllanWatch::add(const Vector6d& mean) {
  sum_ += mean;
  if (++filled_ < seconds_) return;
  const Vector6d now = sum_ / seconds_;
  if (before_) {
    const Vector6d step = (now - *before_).cwiseAbs();
    for (std::size_t i = 0; i < 6; ++i) steps_[i].add(step[static_cast<int>(i)]);
  }
  before_ = now;
  sum_.setZero();
  filled_ = 0;
}

void AllanWatch::interrupt() {
  before_.reset();
  sum_.setZero();
  filled_ = 0;
}

/// The difference of two means has sqrt(2) their sigma; its absolute value has a median of 0.6745
/// sigma.
AllanWatch::Vector6d AllanWatch::density() const {
  Vector6d density;
  for (std::size_t i = 0; i < 6; ++i) density[static_cast<int>(i)] = steps_[i].median();
  return density * std::sqrt(seconds_ / 2.0) / 0.6745;
}

}  // namespace foucault::diagnosis
