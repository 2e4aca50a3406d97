#include "reading.h"

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>

#include "best_times.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "trip.h"

namespace foucault::benchmarks {
namespace {

/// A rawlog of a trip, for as long as it lives.
class TemporaryLog {
 public:
  explicit TemporaryLog(const Trip& trip)
      : path_(std::filesystem::temp_directory_path() /
              ("foucault-benchmark-" + std::to_string(getpid()) + ".rawlog")) {
    rawlog::RawlogWriter writer(path_.string(), trip.mounting);
    for (const Measurement& measurement : trip.measurements) writer.write(measurement);
    writer.finish();
  }
  ~TemporaryLog() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryLog(const TemporaryLog&) = delete;
  TemporaryLog& operator=(const TemporaryLog&) = delete;

  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

void read(benchmark::State& state) {
  const Trip trip = simulated_trip(400, 1);
  const TemporaryLog log(trip);
  int64_t records = 0;
  for ([[maybe_unused]] const auto _ : state) {
    rawlog::RawlogSource source(log.path());
    records = 0;
    while (source.next()) ++records;
  }
  state.counters[kThings] = static_cast<double>(records);
}

}  // namespace

void register_reading() { add("rawlog", read); }

}  // namespace foucault::benchmarks
