#include "foucault/diagnosis/commutation_facts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/imu/increments.h"

namespace foucault::diagnosis {
namespace {

constexpr double kSecond = 1;       // [s]
constexpr double kHalfRateIs = 16;  // times the error of the full rate

}  // namespace

void CommutationWatch::Turn::add(const ImuIncrement& increment) {
  const double scale = before ? imu::previous_increment_scale(before->dt(), increment.dt()) : 0.0;
  const Eigen::Vector3d previous =
      before ? Eigen::Vector3d(scale * before->dtheta_b) : Eigen::Vector3d::Zero();
  q = (q * so3::exp(imu::rotation_with_coning(previous, increment.dtheta_b))).normalized();
  before = increment;
}

void CommutationWatch::add(const ImuIncrement& increment) {
  if (last_ns_ != increment.t_begin_ns) restart();
  last_ns_ = increment.t_end_ns;
  const std::optional<ImuIncrement> first = std::exchange(first_, std::nullopt);
  if (!first) {
    first_ = increment;
    if (!full_.before) begin_ns_ = increment.t_begin_ns;
    full_.add(increment);
    return;
  }
  ImuIncrement pair = increment;
  pair.t_begin_ns = first->t_begin_ns;
  pair.dtheta_b += first->dtheta_b;
  full_.add(increment);
  half_.add(pair);
  if (seconds_between(begin_ns_, increment.t_end_ns) >= kSecond) end_second();
}

void CommutationWatch::restart() {
  full_ = half_ = Turn();
  first_.reset();
}

void CommutationWatch::end_second() {
  const Eigen::Vector3d error = so3::log(full_.q.conjugate() * half_.q) / (kHalfRateIs - 1);
  sum_ += error;
  squares_ += error.squaredNorm();
  seconds_ += seconds_between(begin_ns_, *last_ns_);
  ++count_;
  begin_ns_ = *last_ns_;
  full_.q = half_.q = Eigen::Quaterniond::Identity();
}

CommutationFacts CommutationWatch::facts() const {
  CommutationFacts facts;
  if (count_ == 0) return facts;
  facts.seconds = seconds_;
  facts.drift = sum_.norm() / seconds_;
  const double variance = (squares_ / count_ - (sum_ / count_).squaredNorm()) / 3;
  facts.random = std::sqrt(std::max(0.0, variance) * count_ / seconds_);
  return facts;
}

}  // namespace foucault::diagnosis
