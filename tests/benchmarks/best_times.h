#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <utility>

namespace foucault::benchmarks {

/// Every benchmark counts here how many things an iteration does.
constexpr const char* kThings = "things";

/// Registers a benchmark with its repetitions.
template <class... Arguments>
benchmark::internal::Benchmark* add(const std::string& name, Arguments&&... arguments) {
  return benchmark::RegisterBenchmark(name.c_str(), std::forward<Arguments>(arguments)...)
      ->Repetitions(5)
      ->MinTime(0.1);
}

/// Keeps the shortest time a thing [ns] of each benchmark over its repetitions: what else runs on a
/// machine can only add. CPU time, or what the benchmark itself has measured.
class BestTimes : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override;

  /// By the name it was registered with. Throws std::out_of_range for one that did not run.
  double ns(const std::string& name) const { return best_ns_.at(name); }
  bool has(const std::string& name) const { return best_ns_.count(name) > 0; }

 private:
  std::map<std::string, double> best_ns_;
};

}  // namespace foucault::benchmarks
