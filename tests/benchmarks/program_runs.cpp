#include "program_runs.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "process.h"

namespace foucault::benchmarks {
namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  TemporaryFolder()
      : path_(fs::temp_directory_path() / ("foucault-benchmark-" + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

std::map<std::string, double> stages_of(const fs::path& metrics) {
  const nlohmann::json profile = nlohmann::json::parse(std::ifstream(metrics)).at("profile");
  std::map<std::string, double> stages;
  for (const auto& [key, seconds] : profile.items()) {
    stages[key.substr(0, key.size() - 2)] = seconds.get<double>();  // without _s
  }
  return stages;
}

/// Of the run with the least CPU time.
std::map<std::string, double> best_stages(const std::vector<std::string>& command,
                                          const fs::path& metrics, int times) {
  std::map<std::string, double> best;
  for (int i = 0; i < times; ++i) {
    cpu_seconds(command);
    const std::map<std::string, double> stages = stages_of(metrics);
    if (best.empty() || stages.at("total") < best.at("total")) best = stages;
  }
  return best;
}

}  // namespace

ProgramRuns measure_program(const std::string& program, const std::string& log, int times) {
  const TemporaryFolder folder;
  const std::string recording = log.empty() ? (folder / "trip.rawlog").string() : log;
  if (log.empty()) {
    cpu_seconds({program, "simulate", "--imu", "ADIS16465", "--duration", "1617", "--seed", "7",
                 "--out", recording});
  }
  ProgramRuns result;
  result.gzip_s = best_cpu_seconds({"gzip", "-dc", recording}, times);
  result.start_s = best_cpu_seconds({program, "--version"}, times);
  for (const std::string method : {"ekf", "refined", "full", "rts", "batch"}) {
    const fs::path out = folder / method;
    std::vector<std::string> command{program, "run",   recording,   "--method",
                                     method,  "--out", out.string()};
    ProgramRun run;
    run.method = method;
    command.push_back("--no-report");
    run.cpu_s = best_cpu_seconds(command, times);
    command.back() = "--profile";
    run.stages = best_stages(command, out / "metrics.json", times);
    result.runs.push_back(run);
  }
  return result;
}

}  // namespace foucault::benchmarks
