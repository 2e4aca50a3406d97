#include "jobs/demo_job.h"

#include "jobs/simulation_job.h"

namespace foucault::app {
namespace {

std::string path_of(const std::filesystem::path& folder, const std::string& recording) {
  return (folder / (recording + ".rawlog")).string();
}

}  // namespace

void write_demo_recordings(const laboratory::PaperExperiment& experiment,
                           const std::filesystem::path& folder, Console& console) {
  std::filesystem::create_directories(folder);
  for (const laboratory::PaperRecording& recording : laboratory::recordings(experiment)) {
    SimulationSettings settings;
    settings.imu.preset = recording.imu;
    settings.scenario.duration_s = recording.length_s;
    settings.scenario.seed = recording.seed;
    write_simulation(settings, path_of(folder, recording.name), console);
  }
}

RunJob demo_run(const laboratory::PaperExperiment& experiment,
                const std::filesystem::path& folder) {
  RunJob job;
  job.settings = Settings::of_paper();
  job.settings.imu.preset = "ADIS16465";
  job.log = path_of(
      folder, laboratory::recording_name(job.settings.imu.preset, experiment.trips_s.front()));
  return job;
}

std::vector<EvaluationCase> evaluation_cases(const std::vector<laboratory::PaperCase>& cases,
                                             const std::filesystem::path& folder) {
  std::vector<EvaluationCase> all;
  for (const laboratory::PaperCase& what : cases) {
    Settings settings = Settings::of_paper();
    settings.imu.preset = what.imu;
    settings.gnss.gate_false_alarm = 0;  // nor has the paper a gate; there are no outliers here
    if (what.noise) {
      settings.imu.gyro_bias_deg_h = what.noise->gyro_bias_deg_h;
      settings.imu.arw_deg_sqrt_h = what.noise->arw_deg_sqrt_h;
    }
    all.push_back({path_of(folder, what.recording), what.recording, what.imu, what.method, "",
                   std::make_shared<const Settings>(settings)});
  }
  return all;
}

}  // namespace foucault::app
