#include "best_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace foucault::benchmarks {
namespace {

bool measured_itself(const benchmark::BenchmarkReporter::Run& run) {
  return run.run_name.time_type.find("manual") != std::string::npos;
}

}  // namespace

void BestTimes::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.error_occurred || run.run_type != Run::RT_Iteration) continue;
    const double time = measured_itself(run) ? run.GetAdjustedRealTime() : run.GetAdjustedCPUTime();
    const double ns = time / run.counters.at(kThings).value;
    const std::string& name = run.run_name.function_name;
    const auto [best, first] = best_ns_.emplace(name, ns);
    if (!first) best->second = std::min(best->second, ns);
    fmt::print(stderr, "{:<44} {:12.1f} ns\n", name, ns);
  }
}

}  // namespace foucault::benchmarks
