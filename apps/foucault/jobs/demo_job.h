#pragma once

#include <filesystem>
#include <vector>

#include "console.h"
#include "foucault/laboratory/paper_experiment.h"
#include "jobs/evaluation_job.h"
#include "jobs/run_job.h"

/// The paper's experiment with this program's recordings and settings.
namespace foucault::app {

/// Simulates and writes IMU-LENGTHs.rawlog for every IMU and trip into `folder`.
void write_demo_recordings(const laboratory::PaperExperiment& experiment,
                           const std::filesystem::path& folder, Console& console);

/// The main job on the first trip with an ADIS16465, by `refined`.
RunJob demo_run(const laboratory::PaperExperiment& experiment, const std::filesystem::path& folder);

/// For evaluate().
std::vector<EvaluationCase> evaluation_cases(const std::vector<laboratory::PaperCase>& cases,
                                             const std::filesystem::path& folder);

}  // namespace foucault::app
