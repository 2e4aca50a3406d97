#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "console.h"
#include "evaluation_job.h"
#include "run_job.h"

namespace foucault::app {

/// The paper's experiment on simulated recordings: four IMUs on the same trips, each trip with
/// outages of 60 s every 150 s after 500 s and again with shifted starts.
struct DemoExperiment {
  std::vector<double> trips_s;  ///< lengths of the trips; the paper's are 2325, 1617 and 2333 s
};

/// The IMUs of Table I, by their presets.
const std::vector<std::string>& demo_imus();

/// Simulates and writes IMU-LENGTHs.rawlog for every IMU and trip into `folder`.
void write_demo_recordings(const DemoExperiment& experiment, const std::filesystem::path& folder,
                           Console& console);

/// The main job on the first trip with an ADIS16465, by `refined`.
RunJob demo_run(const DemoExperiment& experiment, const std::filesystem::path& recordings);

/// ekf, refined, rough and full on every recording with the noise that was simulated.
std::vector<EvaluationCase> cases_as_simulated(const DemoExperiment& experiment,
                                               const std::filesystem::path& recordings);

/// The paper's three with the noise parameters tuned for each IMU and method, as it did.
std::vector<EvaluationCase> cases_tuned(const DemoExperiment& experiment,
                                        const std::filesystem::path& recordings);

/// What the reports say of the data.
std::vector<std::string> remarks_as_simulated();
std::vector<std::string> remarks_tuned();

}  // namespace foucault::app
