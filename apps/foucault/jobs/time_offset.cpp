#include "jobs/time_offset.h"

#include <cmath>
#include <optional>

#include "foucault/core/error.h"
#include "foucault/rawlog/rawlog_source.h"
#include "methods.h"

namespace foucault::app {
namespace {

class LastEpoch : public state::Sink {
 public:
  void epoch(const state::Epoch& epoch) override { last = epoch; }
  std::optional<state::Epoch> last;
};

/// What is left of the offset at the end of the log, and its sigma.
struct Rest {
  double value = 0, sigma = 0;
};

std::optional<Rest> rest_of_offset(const std::string& log, const Settings& settings,
                                   Console& console) {
  LastEpoch sink;
  try {
    rawlog::RawlogSource source(log, settings.imu.sample_kind(), settings.rawlog);
    const std::unique_ptr<state::Estimator> estimator =
        find_method("ekf").make(settings, source.mounting(), sink);
    while (const std::optional<Measurement> measurement = source.next()) {
      estimator->process(*measurement);
      console.progress("time offset", source.progress());
    }
    estimator->finish();
  } catch (const DataError&) {  // told by the run itself
    return std::nullopt;
  }
  console.clear_progress();
  if (!sink.last) return std::nullopt;
  const state::Layout layout = settings.calibrate.layout();
  const state::SlowBlock& offset = *layout.find(state::block::time_offset);
  return Rest{sink.last->slow[offset.index],
              std::sqrt(state::part(sink.last->covariance, offset, offset)(0, 0))};
}

}  // namespace

Settings with_time_offset(const std::string& log, const Settings& settings, Console& console) {
  constexpr int kMostPasses = 3;
  constexpr double kSmall = 0.002;  // [s]; at 3 m/s^2 the second order is 6 micrometres
  constexpr double kMost = 1;       // [s]; as the key
  if (!settings.calibrate.layout().find(state::block::time_offset)) return settings;
  Settings found = settings;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::optional<Rest> rest = rest_of_offset(log, found, console);
    if (!rest || std::abs(rest->value) < std::max(kSmall, rest->sigma)) break;
    double& offset_s = found.calibrate.time_offset_s;
    if (std::abs(offset_s + rest->value) > kMost) break;
    offset_s += rest->value;
    found.rawlog.fix_delay_s = offset_s;
  }
  return found;
}

}  // namespace foucault::app
