#pragma once

#include <optional>

#include "foucault/imu/imu_noise.h"
#include "foucault/simulation/gnss_simulator.h"
#include "foucault/simulation/imu_simulator.h"
#include "foucault/simulation/scenario.h"
#include "foucault/simulation/wheel_simulator.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"

namespace foucault::simulation {

/// Stamps at a fixed rate, rounded to 100 ns (the resolution of MRPT's clock) without drift.
class StampSequence {
 public:
  /// rate_hz 0: no stamps. phase_s: of the first one after start.
  StampSequence(int64_t start_ns, double rate_hz, double phase_s);
  int64_t at(int64_t index) const;
  bool empty() const { return rate_hz_ == 0; }

 private:
  int64_t start_ns_;
  double rate_hz_;
  double phase_s_;
};

/// A simulated recording as a Source: GnssFix, WheelSpeed, ReferencePose (the truth) and
/// ImuIncrement in the order of Measurement, from the start to duration_s after it. Stamps are
/// multiples of 100 ns, so that a rawlog keeps them exactly. Fixes that a time offset puts before
/// the start or after the end are left out.
/// Memory: the control points of the trajectory, 100 bytes to 1 kB a second, and no more.
class SimulatedSource : public state::Source {
 public:
  /// Throws UsageError for options that make no sense together.
  SimulatedSource(const ScenarioOptions& options, const imu::ImuNoise& noise);

  std::optional<Measurement> next() override;
  /// As told; truth() knows the true one.
  const state::Mounting& mounting() const override { return mounting_; }
  double progress() const override;

  const Trajectory& trajectory() const { return trajectory_; }

  /// The true state at a stamp within the recording, for consistency tests: position, velocity,
  /// q_n_b, and the bias at the end of the last increment given out. Covariance zero.
  state::Epoch truth(int64_t t_ns) const;

  /// True biases at the end of the last increment given out.
  state::ImuBias true_bias() const { return errors_.bias(); }

 private:
  struct Stream {
    StampSequence stamps;
    int64_t index = 0;
    std::optional<int64_t> next_ns(int64_t end_ns) const;
  };

  Motion motion_at(int64_t t_ns) const;
  /// None where the time offset leads out of the recording.
  std::optional<GnssFix> next_fix();
  WheelSpeed next_wheel_speed();
  ReferencePose next_reference();
  /// None inside a gap, or when the recording is over.
  std::optional<ImuIncrement> next_increment();
  /// For the accelerometers' rectification [m/s]; 0 without it.
  double rectifying_speed(int64_t t_ns) const;
  bool in_gap(const ImuIncrement& increment) const;

  ScenarioOptions options_;
  int64_t start_ns_, end_ns_;
  state::Mounting mounting_;
  Eigen::Quaterniond true_q_v_b_;
  Trajectory trajectory_;
  GnssSimulator gnss_;
  WheelSimulator wheels_;
  ImuErrors errors_;
  Stream fixes_, wheel_speeds_, references_, increments_;
  int64_t now_ns_;
};

}  // namespace foucault::simulation
