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
  const bool too_short = outages.period_s <= what.length_s;
  if (what.log.empty() || too_short) outages.period_s = what.length_s + kBetween;
  return outages;
}

std::unique_ptr<Source> open(const ReturnCase& what, const Settings& settings) {
  if (what.log.empty()) return std::make_unique<SimulatedSource>(trip(), settings.imu.noise());
  return std::make_unique<RawlogSource>(what.log, settings.imu.sample_kind(), settings.rawlog);
}

/// Fixes that the method did not use, and for how long at a time.
class LeftOut : public OutageRunObserver {
 public:
  explicit LeftOut(ReturnOutcome& outcome) : outcome_(outcome) {}

  void fix(const FixResult& fix) override {
    if (fix.verdict == FixVerdict::gated || fix.verdict == FixVerdict::corrected) {
      ++outcome_.left_out;
      if (!since_ns_) since_ns_ = fix.t_ns;
    } else if (fix.verdict == FixVerdict::used) {
      end(fix.t_ns);
    }
    last_ns_ = fix.t_ns;
  }
  void end() { end(last_ns_); }

 private:
  void end(int64_t t_ns) {
    if (since_ns_) {
      outcome_.longest_s = std::max(outcome_.longest_s, seconds_between(*since_ns_, t_ns));
    }
    since_ns_.reset();
  }

  ReturnOutcome& outcome_;
  std::optional<int64_t> since_ns_;
  int64_t last_ns_ = 0;
};

/// Squares of the largest horizontal drifts.
std::vector<double> squares_of(const ReturnCase& what, const Settings& configured,
                               const Settings& truth, ReturnOutcome& outcome) {
  const Method& method = find_method(what.method);
  const OutageOptions outages = outages_of(what, truth);
  std::vector<double> squares;
  for (const double shift_s : outages.shifts_s) {
    OutageRunOptions options;
    options.reference.keep_s = method.keep_references_s;
    LeftOut left_out(outcome);
    const OutageRunResult run = run_with_outages(
        open(what, truth), OutageSchedule(outages, shift_s),
        [&](const Mounting& mounting, Sink& sink) {
          return method.make(configured, mounting, sink);
        },
        options, &left_out);
    for (const OutageDrift& drift : run.drifts) {
      squares.push_back(drift.maximum.horizontal * drift.maximum.horizontal);
    }
    left_out.end();
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
    const std::vector<double> squares = squares_of(what, configured, settings, outcome);
    outcome.outages = static_cast<int64_t>(squares.size());
    outcome.drift_m = root_mean(squares);
    ReturnOutcome of_control;
    outcome.control_m = root_mean(squares_of(what, control, settings, of_control));
  } catch (const DataError& error) {
    outcome.error = error.what();
  }
  return outcome;
}

TextTable return_table(const std::vector<ReturnOutcome>& outcomes) {
  TextTable table;
  table.title = "Returns";
  table.header = {"recording", "noise",     "outage_s", "method",   "outages",
                  "drift_m",   "control_m", "ratio",    "left_out", "longest_left_out_s",
                  "error"};
  for (const ReturnOutcome& o : outcomes) {
    table.rows.push_back({name_of(o.what.log), fmt::format("{:g}", o.what.noise),
                          fmt::format("{:g}", o.what.length_s), o.what.method,
                          fmt::format("{}", o.outages), fmt::format("{:.4f}", o.drift_m),
                          fmt::format("{:.4f}", o.control_m), fmt::format("{:.4f}", o.ratio()),
                          fmt::format("{}", o.left_out), fmt::format("{:.1f}", o.longest_s),
                          o.error});
  }
  return table;
}

TextTable return_summary(const std::vector<ReturnOutcome>& outcomes) {
  TextTable table;
  table.title = "Returns after an outage: the worst of the methods";
  table.header = {"recording", "noise", "outage [s]", "drift / gate off", "longest left out [s]"};
  std::map<std::tuple<std::string, double, double>, std::pair<double, double>> worst;
  for (const ReturnOutcome& o : outcomes) {
    auto& [ratio, longest] = worst[{name_of(o.what.log), o.what.noise, o.what.length_s}];
    if (o.error.empty()) ratio = std::max(ratio, o.ratio());
    longest = std::max(longest, o.longest_s);
  }
  for (const auto& [key, value] : worst) {
    const auto& [recording, noise, length_s] = key;
    table.rows.push_back({recording, fmt::format("{:g}", noise), fmt::format("{:g}", length_s),
                          fmt::format("{:.3f}", value.first), fmt::format("{:.0f}", value.second)});
  }
  return table;
}

}  // namespace foucault::app
