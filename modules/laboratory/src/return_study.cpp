#include "foucault/laboratory/return_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault::laboratory {
namespace {

constexpr double kBetween = 60;  // [s] of fixes between outages

simulation::ScenarioOptions trip() {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = 900;
  return scenario;
}

evaluation::OutageOptions outages_of(const ReturnCase& what, evaluation::OutageOptions outages) {
  if (what.log.empty()) outages.first_s = 200;
  outages.length_s = what.length_s;
  const bool too_short = outages.period_s <= what.length_s;
  if (what.log.empty() || too_short) outages.period_s = what.length_s + kBetween;
  return outages;
}

std::unique_ptr<state::Source> open(const ReturnCase& what, const ReturnProgram& program) {
  if (what.log.empty()) return std::make_unique<simulation::SimulatedSource>(trip(), program.noise);
  return program.open(what.log);
}

/// Fixes that the method did not use, and for how long at a time.
class LeftOut : public evaluation::OutageRunObserver {
 public:
  explicit LeftOut(ReturnOutcome& outcome) : outcome_(outcome) {}

  void fix(const state::FixResult& fix) override {
    if (fix.verdict == state::FixVerdict::gated || fix.verdict == state::FixVerdict::corrected) {
      ++outcome_.left_out;
      if (!since_ns_) since_ns_ = fix.t_ns;
    } else if (fix.verdict == state::FixVerdict::used) {
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

/// The largest horizontal drift of each outage.
std::vector<double> largest_drifts(const ReturnCase& what, const ReturnProgram& program, bool gate,
                                   ReturnOutcome& outcome) {
  const ReturnMethod method = program.method(what, gate);
  const evaluation::OutageOptions outages = outages_of(what, program.outages);
  std::vector<double> largest;
  for (const double shift_s : outages.shifts_s) {
    evaluation::OutageRunOptions options;
    options.reference.keep_s = method.keep_references_s;
    LeftOut left_out(outcome);
    const evaluation::OutageRunResult run = evaluation::run_with_outages(
        open(what, program), evaluation::OutageSchedule(outages, shift_s), method.make, options,
        &left_out);
    for (const evaluation::OutageDrift& drift : run.drifts)
      largest.push_back(drift.maximum.horizontal);
    left_out.end();
  }
  return largest;
}

std::string name_of(const std::string& log) {
  return log.empty() ? "simulated" : std::filesystem::path(log).stem().string();
}

}  // namespace

ReturnOutcome study_return(const ReturnCase& what, const ReturnProgram& program) {
  ReturnOutcome outcome;
  outcome.what = what;
  try {
    const std::vector<double> drifts = largest_drifts(what, program, true, outcome);
    outcome.outages = static_cast<int64_t>(drifts.size());
    outcome.drift_m = evaluation::root_mean_square(drifts);
    ReturnOutcome of_control;
    outcome.control_m =
        evaluation::root_mean_square(largest_drifts(what, program, false, of_control));
  } catch (const DataError& error) {
    outcome.error = error.what();
  }
  return outcome;
}

evaluation::TextTable return_table(const std::vector<ReturnOutcome>& outcomes) {
  evaluation::TextTable table;
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

evaluation::TextTable return_summary(const std::vector<ReturnOutcome>& outcomes) {
  evaluation::TextTable table;
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

}  // namespace foucault::laboratory
