#include "trial.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/median.h"
#include "foucault/core/time.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/measurement/gnss_velocity.h"
#include "motion_fit.h"

namespace foucault::alignment {
namespace {

constexpr double kStandsOut = 25;  // of a chi-square of three: 2e-5 by chance
constexpr double kMedian = 2.366;  // of a chi-square of three
constexpr std::size_t kRemembered = 301;
constexpr std::size_t kFewest = 5;  // squares of which a median tells something

}  // namespace

Trial::Trial(const imu::ImuNoise& noise, const state::Layout& layout, const state::Epoch& start)
    : navigator_(noise, layout, ekf::EkfOptions()) {
  navigator_.start(start);
}

void Trial::propagate(const ImuIncrement& increment) {
  navigator_.propagate(increment);
  rates_.add(increment);
}

void Trial::update(const GnssFix& fix) {
  use(measurement::gnss_position(fix));
  if (!velocity_is_better(fix)) return;
  GnssFix delayed =
      fix;  // late by up to kVelocityLatency: as much as the vehicle accelerates in it
  const Eigen::Vector3d acceleration_n =
      navigator_.state().q_n_b * rates_.accel_b + Eigen::Vector3d(0, 0, kStandardGravity);
  delayed.velocity_covariance +=
      kVelocityLatency * kVelocityLatency * acceleration_n * acceleration_n.transpose();
  use(measurement::gnss_velocity(delayed));
}

void Trial::use(const measurement::ObservationPtr& observation) {
  const state::Innovation innovation = navigator_.innovation(*observation);
  const Eigen::LLT<Eigen::Matrix3d> llt(innovation.covariance);
  const double square = innovation.value.dot(llt.solve(innovation.value));
  const double limit = kStandsOut * level();
  agreement_.squares += std::min(square, limit);
  agreement_.log_determinants += 2 * Eigen::Matrix3d(llt.matrixL()).diagonal().array().log().sum();
  if (recent_.size() < kRemembered) {
    recent_.push_back(square);
  } else {
    recent_[next_++ % kRemembered] = square;
  }
  left_out_ = square > limit && !left_out_;
  if (!left_out_) navigator_.update(observation);
}

namespace {

double level_of(const std::vector<double>& squares) {
  return squares.size() < kFewest ? 1.0 : std::max(1.0, median(squares) / kMedian);
}

}  // namespace

double Trial::level() const { return level_of(recent_); }

double Trial::settling() const {
  std::vector<double> first = recent_;
  std::rotate(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(next_ % kRemembered),
              first.end());
  const auto middle = first.begin() + static_cast<std::ptrdiff_t>(first.size() / 2);
  const std::vector<double> second(middle, first.end());
  first.erase(middle, first.end());
  return level_of(first) / level_of(second);
}

}  // namespace foucault::alignment
