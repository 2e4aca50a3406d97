#include "return_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/evaluation/outage_run.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/simulation/simulated_source.h"
#include "methods.h"

namespace foucault::app {
namespace {

constexpr double kBetween = 60;  // [s] of fixes between outages

ScenarioOptions trip() {
  ScenarioOptions scenario;
  scenario.duration_s = 900;
  return scenario;
}

OutageOptions outages_of(const ReturnCase& what, const Settings& settings) {
  OutageOptions outages = settings.outages;
  if (what.log.empty()) outages.first_s = 200;
  outages.length_s = what.length_s;
  outages.period_s = std::max(outages.period_s, what.length_s + kBetween);
  if (what.log.empty()) outages.period_s = what.length_s + kBetween;
  return outages;
}

std::unique_ptr<Source> open(const ReturnCase& what, const Settings& settings) {
  if (what.log.empty()) return std::make_unique<SimulatedSource>(trip(), settings.imu.noise());
  return std::make_unique<RawlogSource>(what.log, settings.imu.sample_kind(), settings.rawlog);
}

class LeftOut : public OutageRunObserver {
 public:
  void fix(const FixResult& fix) override {
    if (fix.verdict == FixVerdict::gated || fix.verdict == FixVerdict::corrected) {
      stamps_ns.push_back(fix.t_ns);
    }
  }
  std::vector<int64_t> stamps_ns;
};

void add_left_out(const OutageRunResult& run, const LeftOut& left_out, ReturnOutcome& outcome) {
  for (const int64_t t_ns : left_out.stamps_ns) {
    const auto next = std::find_if(run.withheld.begin(), run.withheld.end(),
                                   [t_ns](const Outage& o) { return o.end_ns > t_ns; });
    if (next == run.withheld.begin()) continue;
    ++outcome.left_out;
    outcome.latest_s = std::max(outcome.latest_s, seconds_between((next - 1)->end_ns, t_ns));
  }
}

/// Squares of the largest horizontal drifts.
std::vector<double> squares_of(const ReturnCase& what, const Settings& configured,
                               const Settings& truth, ReturnOutcome* outcome) {
  const Method& method = find_method(what.method);
  const OutageOptions outages = outages_of(what, truth);
  std::vector<double> squares;
  for (const double shift_s : outages.shifts_s) {
    OutageRunOptions options;
    options.reference.keep_s = method.keep_references_s;
    LeftOut left_out;
    const OutageRunResult run = run_with_outages(
        open(what, truth), OutageSchedule(outages, shift_s),
        [&](const Mounting& mounting, Sink& sink) {
          return method.make(configured, mounting, sink);
        },
        options, &left_out);
    for (const OutageDrift& drift : run.drifts) {
      squares.push_back(drift.maximum.horizontal * drift.maximum.horizontal);
    }
    if (outcome) add_left_out(run, left_out, *outcome);
  }
  return squares;
}

double root_mean(const std::vector<double>& squares) {
  double sum = 0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

std::string name_of(const std::string& log) {
  return log.empty() ? "simulated" : std::filesystem::path(log).stem().string();
}

}  // namespace

ReturnOutcome study_return(const ReturnCase& what, const Settings& settings) {
  ReturnOutcome outcome;
  outcome.what = what;
  Settings configured = settings;
  configured.imu = settings.imu.scaled(what.noise);
  Settings control = configured;
  control.gnss.gate_false_alarm = 0;
  try {
    const std::vector<double> squares = squares_of(what, configured, settings, &outcome);
    outcome.outages = static_cast<int64_t>(squares.size());
    outcome.drift_m = root_mean(squares);
    outcome.control_m = root_mean(squares_of(what, control, settings, nullptr));
  } catch (const DataError& error) {
    outcome.error = error.what();
  }
  return outcome;
}

TextTable return_table(const std::vector<ReturnOutcome>& outcomes) {
  TextTable table;
  table.title = "Returns";
  table.header = {"recording", "noise",     "outage_s", "method",   "outages",
                  "drift_m",   "control_m", "ratio",    "left_out", "latest_left_out_s",
                  "error"};
  for (const ReturnOutcome& o : outcomes) {
    table.rows.push_back({name_of(o.what.log), fmt::format("{:g}", o.what.noise),
                          fmt::format("{:g}", o.what.length_s), o.what.method,
                          fmt::format("{}", o.outages), fmt::format("{:.4f}", o.drift_m),
                          fmt::format("{:.4f}", o.control_m), fmt::format("{:.4f}", o.ratio()),
                          fmt::format("{}", o.left_out), fmt::format("{:.1f}", o.latest_s),
                          o.error});
  }
  return table;
}

TextTable return_summary(const std::vector<ReturnOutcome>& outcomes) {
  TextTable table;
  table.title = "Returns after an outage: the worst of the methods";
  table.header = {"recording", "noise", "outage [s]", "drift / gate off",
                  "last left out after [s]"};
  std::map<std::tuple<std::string, double, double>, std::pair<double, double>> worst;
  for (const ReturnOutcome& o : outcomes) {
    auto& [ratio, latest] = worst[{name_of(o.what.log), o.what.noise, o.what.length_s}];
    if (o.error.empty()) ratio = std::max(ratio, o.ratio());
    latest = std::max(latest, o.latest_s);
  }
  for (const auto& [key, value] : worst) {
    const auto& [recording, noise, length_s] = key;
    table.rows.push_back({recording, fmt::format("{:g}", noise), fmt::format("{:g}", length_s),
                          fmt::format("{:.3f}", value.first), fmt::format("{:.0f}", value.second)});
  }
  return table;
}

}  // namespace foucault::app
