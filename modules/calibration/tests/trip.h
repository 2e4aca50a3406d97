#pragma once

#include "foucault/calibration/recorded_way.h"
#include "foucault/imu/increments.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault::calibration {

/// A simulated trip that a filter goes with a noise it is told, from the truth on, within what an
/// alignment tells of it.
struct Trip {
  simulation::ScenarioOptions scenario;
  imu::ImuNoise noise = imu::imu_preset("ADIS16465");  ///< true
  imu::ImuNoise told = noise;
  double told_sigma_factor = 1;  ///< of fixes

  Trip() {
    scenario.duration_s = 900;
    scenario.imu_rate_hz = 50;
    scenario.reference_rate_hz = 0;
  }

  state::Epoch start(const simulation::SimulatedSource& source) const {
    state::Epoch start = source.truth(scenario.start_ns());
    start.bias = {};
    start.covariance = state::NodeMatrix::Zero();
    start.covariance.diagonal() << Eigen::Vector3d::Constant(1e-4), Eigen::Vector3d::Constant(1e-4),
        Eigen::Vector3d::Constant(1e-6),
        Eigen::Vector3d::Constant(std::pow(told.gyro_turn_on_sigma, 2)),
        Eigen::Vector3d::Constant(std::pow(told.accel_turn_on_sigma, 2));
    return start;
  }

  /// Calls each(measurement) in order; a fix at a stamp comes after the increment that ends there.
  template <class Take>
  void drive(ekf::EkfNavigator& filter, Take met_fix) const {
    simulation::SimulatedSource source(scenario, noise);
    std::optional<GnssFix> waiting;
    filter.start(start(source));
    while (const std::optional<Measurement> measurement = source.next()) {
      if (const auto* fix = std::get_if<GnssFix>(&*measurement)) {
        waiting = *fix;
        waiting->position_covariance *= told_sigma_factor * told_sigma_factor;
      }
      const auto* increment = std::get_if<ImuIncrement>(&*measurement);
      if (!increment) continue;
      ImuIncrement rest = *increment;
      if (waiting && waiting->t_ns <= rest.t_end_ns) {
        if (waiting->t_ns > rest.t_begin_ns && waiting->t_ns < rest.t_end_ns) {
          const auto [until, after] = imu::split(rest, waiting->t_ns);
          filter.propagate(until);
          rest = after;
        } else if (waiting->t_ns == rest.t_end_ns) {
          filter.propagate(rest);
          rest.t_begin_ns = rest.t_end_ns;
        }
        met_fix(measurement::gnss_position(*waiting));
        waiting.reset();
      }
      if (rest.dt() > 0) filter.propagate(rest);
    }
  }

  RecordedWay way(const state::Layout& layout = {}) const {
    UnfoldedWay way;
    ekf::EkfOptions options;
    options.cov_interval_s = 0.5;
    WayRecorder recorder(told, layout, options, way);
    drive(recorder, [&](const measurement::ObservationPtr& fix) { recorder.update(fix); });
    return folded(way, recorder.state().slow);
  }
};

}  // namespace foucault::calibration
