#pragma once

#include <memory>

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/measurement/navigator.h"
#include "foucault/state/blocks.h"

namespace foucault::diagnosis {

/// A filter whose increments are changes of velocity north, east, down, so that its truth is known
/// exactly. Position follows velocity; velocity walks at random.
class StraightNavigator : public measurement::Navigator {
 public:
  StraightNavigator() = default;
  explicit StraightNavigator(const state::Epoch& epoch) : epoch_(epoch) {}

  void start(const state::Epoch& initial) override { epoch_ = initial; }

  void propagate(const ImuIncrement& increment) override {
    const double dt = increment.dt();
    const Eigen::Vector3d way = (epoch_.velocity_n + 0.5 * increment.dvel_b) * dt;
    epoch_.position = geodesy::LocalFrame(epoch_.position).to_geodetic(way);
    epoch_.velocity_n += increment.dvel_b;
    epoch_.t_ns = increment.t_end_ns;
    state::NodeMatrix F = state::NodeMatrix::Identity();
    state::part(F, state::block::position, state::block::velocity) =
        dt * Eigen::Matrix3d::Identity();
    epoch_.covariance = (F * epoch_.covariance * F.transpose()).eval();
    state::part(epoch_.covariance, state::block::velocity, state::block::velocity) +=
        kWalk * kWalk * dt * Eigen::Matrix3d::Identity();
  }

  state::Innovation innovation(const measurement::Observation& observation) const override {
    return state::innovation_of(linearize(observation), epoch_.covariance);
  }
  void update(const measurement::ObservationPtr& observation) override {
    state::kalman_update(linearize(*observation), epoch_, epoch_.covariance);
  }
  void loosen(const state::NodeMatrix& added) override { epoch_.covariance += added; }
  std::unique_ptr<measurement::Navigator> ahead(double scale) const override {
    auto copy = std::make_unique<StraightNavigator>(*this);
    copy->epoch_.covariance *= scale * scale;
    return copy;
  }
  void hold() override {}
  state::Epoch epoch() const override { return epoch_; }

 private:
  static constexpr double kWalk = 0.003;  // [m/s/sqrt(s)]

  state::Linearized linearize(const measurement::Observation& observation) const {
    return observation.linearize(epoch_, {}, state::Layout());
  }

  state::Epoch epoch_;
};

constexpr int64_t kBegin = 1'600'000'000 * kNanosecondsPerSecond;
inline const Geodetic kPlace{0.7, 0.2, 100};

/// A state at rest at kPlace, at kBegin, with these sigmas of position and velocity.
inline state::Epoch rest(double position_sigma, double velocity_sigma) {
  using namespace state;
  state::Epoch epoch;
  epoch.t_ns = kBegin;
  epoch.position = kPlace;
  auto variance = epoch.covariance.diagonal();
  state::part(variance, state::block::position).setConstant(position_sigma * position_sigma);
  state::part(variance, state::block::velocity).setConstant(velocity_sigma * velocity_sigma);
  state::part(variance, state::block::attitude).setConstant(1e-8);
  state::part(variance, state::block::gyro_bias).setConstant(1e-10);
  state::part(variance, state::block::accel_bias).setConstant(1e-8);
  return epoch;
}

/// Off kPlace by `error_n`, so many seconds after kBegin.
inline GnssFix fix_at(double seconds, const Eigen::Vector3d& error_n, double sigma = 0.1) {
  GnssFix fix;
  fix.t_ns = kBegin + nanoseconds(seconds);
  fix.antenna = geodesy::LocalFrame(kPlace).to_geodetic(error_n);
  fix.position_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
  return fix;
}

/// At rest.
inline ImuIncrement increment_between(double begin_s, double end_s) {
  ImuIncrement increment;
  increment.t_begin_ns = kBegin + nanoseconds(begin_s);
  increment.t_end_ns = kBegin + nanoseconds(end_s);
  return increment;
}

}  // namespace foucault::diagnosis
