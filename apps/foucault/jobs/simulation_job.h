#pragma once

#include <string>

#include "console.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/laboratory/fault_cases.h"
#include "foucault/simulation/scenario.h"

namespace foucault::app {

/// Configuration of `simulate`: the IMU's noise and the scenario.
class SimulationSettings : public Configurable {
 public:
  imu::ImuOptions imu;
  simulation::ScenarioOptions scenario;

  void fields(ConfigFields& f) override;
};

struct SimulationCounts {
  int64_t imu_samples = 0;
  int64_t fixes = 0;
  int64_t wheel_speeds = 0;
  int64_t reference_poses = 0;
};

/// Writes a simulated recording, with its truth as the reference trajectory.
/// Throws UsageError for settings that make no sense, DataError if `path` cannot be written.
SimulationCounts write_simulation(const SimulationSettings& settings, const std::string& path,
                                  Console& console);

/// The same with a fault: also with values that a writer refuses, and with the file damaged.
SimulationCounts write_simulation(const SimulationSettings& settings,
                                  const laboratory::FaultCase& fault, const std::string& path,
                                  Console& console);

}  // namespace foucault::app
