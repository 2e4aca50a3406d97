#pragma once

#include <map>
#include <string>
#include <vector>

namespace foucault::benchmarks {

/// `foucault run` on a recording, the best of some.
struct ProgramRun {
  std::string method;
  double cpu_s = 0;                      ///< whole process, no figures
  std::map<std::string, double> stages;  ///< of run --profile, figures included [s]
};

struct ProgramRuns {
  double gzip_s = 0;   ///< gzip -d of the recording, to compare machines
  double start_s = 0;  ///< foucault --version
  std::vector<ProgramRun> runs;
};

/// `log` empty: simulates a trip of 1617 s at 200 Hz. Throws std::runtime_error if a program fails.
ProgramRuns measure_program(const std::string& program, const std::string& log, int times);

}  // namespace foucault::benchmarks
