#include "foucault/laboratory/fault_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/time.h"

namespace foucault::laboratory {
namespace {

constexpr double kDuration = 460;
constexpr double kSettled = 60;  // [s] after the alignment

double end_of(const FaultCase& fault) {
  double end = 0;
  for (const simulation::Fault& f : fault.faults) {
    end = std::max(end, std::isfinite(f.length_s) ? f.start_s + f.length_s : f.start_s);
  }
  return end;
}

void add_errors(const FaultCase& fault, const std::vector<FaultObserver::Error>& errors,
                const simulation::ScenarioOptions& scenario, FaultOutcome& outcome) {
  if (errors.empty()) return;
  const int64_t settled_ns = errors.front().t_ns + nanoseconds(kSettled);
  double squares = 0;
  const int64_t fault_end_ns = scenario.start_ns() + nanoseconds(end_of(fault));
  const double recovered = kRecoveredSigmas * fault.sigma_m.value_or(scenario.gnss_sigma_m.x());
  int64_t count = 0, last_bad_ns = fault_end_ns;
  for (const FaultObserver::Error& error : errors) {
    if (!(error.horizontal < recovered)) last_bad_ns = std::max(last_bad_ns, error.t_ns);
    if (error.t_ns < settled_ns) continue;
    squares += error.horizontal * error.horizontal;
    outcome.largest_m = std::max(outcome.largest_m, error.horizontal);
    ++count;
  }
  outcome.errors = count;
  if (count > 0) outcome.rms_m = std::sqrt(squares / static_cast<double>(count));
  if (errors.back().horizontal < recovered) {
    outcome.recovery_s = seconds_between(fault_end_ns, last_bad_ns);
  }
}

std::string message_of(const std::vector<std::string>& notices) {
  if (notices.empty()) return "";
  if (notices.size() == 1) return notices.front();
  return fmt::format("{} (and {} more)", notices.front(), notices.size() - 1);
}

/// Without the folder of a log.
std::string shortened(const std::string& message, const std::string& log) {
  std::string out = message;
  const std::string name = std::filesystem::path(log).filename().string();
  for (std::size_t at = out.find(log); at != std::string::npos; at = out.find(log)) {
    out.replace(at, log.size(), name);
  }
  return out;
}

FaultOutcome run_method(const FaultCase& fault, const std::string& method, int64_t seed,
                        const std::string& log, const FaultProgram& program) {
  FaultObserver observer;
  FaultOutcome outcome;
  outcome.fault = fault.name;
  outcome.method = method;
  outcome.seed = seed;
  try {
    const std::optional<std::string> damage = program.process(log, method, observer);
    outcome.exit_code = damage ? 1 : 0;
    outcome.message = damage ? shortened(*damage, log) : message_of(observer.notices);
  } catch (const DataError& error) {  // nothing comes out
    outcome.exit_code = 1;
    outcome.message = shortened(error.what(), log);
    return outcome;
  }
  outcome.used = observer.metrics.gnss.used;
  outcome.rejected = observer.metrics.gnss.rejected;
  outcome.trust = observer.metrics.trust;
  add_errors(fault, observer.errors, fault_scenario(seed), outcome);
  return outcome;
}

/// A value of each method; one if they agree.
template <class Text>
std::string beside(const std::vector<const FaultOutcome*>& outcomes, const Text& text) {
  std::vector<std::string> values;
  for (const FaultOutcome* outcome : outcomes) values.push_back(text(*outcome));
  const bool same =
      std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end();
  return same ? values.front() : fmt::format("{}", fmt::join(values, " / "));
}

std::string error_text(const FaultOutcome& outcome) {
  return outcome.errors > 0 ? fmt::format("{:.2f}", outcome.largest_m) : "-";
}

std::string recovery_text(const FaultOutcome& outcome) {
  if (outcome.errors == 0 || outcome.exit_code != 0) return "-";
  return outcome.recovery_s ? fmt::format("{:.0f}", *outcome.recovery_s) : "never";
}

std::string trust_text(const FaultOutcome& outcome) {
  if (!outcome.trust) return "-";
  return outcome.trust->trustworthy ? "yes" : "no";
}

/// Stamps differ from method to method and say nothing beside a fault.
std::string without_stamps(const std::string& message) {
  static const std::regex stamp(R"(\d{10}\.\d+( s)?)");
  return std::regex_replace(message, stamp, "t");
}

std::vector<const FaultOutcome*> methods_of(const std::vector<FaultOutcome>& outcomes,
                                            const FaultOutcome& first) {
  std::vector<const FaultOutcome*> methods;
  for (const FaultOutcome& outcome : outcomes) {
    if (outcome.fault == first.fault && outcome.seed == first.seed) methods.push_back(&outcome);
  }
  return methods;
}

}  // namespace

simulation::ScenarioOptions fault_scenario(int64_t seed) {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = kDuration;
  scenario.seed = seed;
  return scenario;
}

void FaultObserver::place(const state::Mounting& mounting) {
  metrics_.emplace(mounting);
  comparison_.emplace(mounting,
                      [this](const state::Epoch& epoch, const state::ReferenceError& error) {
                        errors.push_back({epoch.t_ns, error.position_n.head<2>().norm()});
                      });
}

void FaultObserver::epoch(const state::Epoch& epoch) {
  comparison_->add(epoch);
  metrics_->epoch(epoch);
}

void FaultObserver::notice(const state::Notice& notice) {
  if (notice.kind != state::NoticeKind::aligned) notices.push_back(notice.text);
}

void FaultObserver::judge() {
  metrics = metrics_->metrics();
  const std::vector<std::string>& reasons = metrics.trust.reasons;
  if (!metrics.trust.trustworthy) notices.insert(notices.end(), reasons.begin(), reasons.end());
  notices.insert(notices.end(), warnings_.begin(), warnings_.end());
}

std::vector<FaultOutcome> run_fault(const FaultCase& fault, const std::vector<std::string>& methods,
                                    int64_t seed, const std::string& log,
                                    const FaultProgram& program) {
  program.write(fault, seed, log);
  std::vector<FaultOutcome> outcomes;
  for (const std::string& method : methods) {
    outcomes.push_back(run_method(fault, method, seed, log, program));
  }
  std::filesystem::remove(log);
  return outcomes;
}

evaluation::TextTable fault_table(const std::vector<FaultOutcome>& outcomes) {
  evaluation::TextTable table;
  table.title = "Faults";
  table.header = {"fault",     "injected",   "method",     "seed",     "exit_code", "rms_m",
                  "largest_m", "recovery_s", "fixes_used", "rejected", "message",   "trustworthy"};
  for (const FaultOutcome& o : outcomes) {
    table.rows.push_back(
        {o.fault, find_fault_case(o.fault).title, o.method, fmt::format("{}", o.seed),
         fmt::format("{}", o.exit_code), o.errors > 0 ? fmt::format("{:.4f}", o.rms_m) : "",
         o.errors > 0 ? fmt::format("{:.4f}", o.largest_m) : "",
         o.recovery_s ? fmt::format("{:.1f}", *o.recovery_s) : "", fmt::format("{}", o.used),
         fmt::format("{}", o.rejected), o.message, o.trust ? trust_text(o) : ""});
  }
  return table;
}

evaluation::TextTable fault_summary(const std::vector<FaultOutcome>& outcomes) {
  evaluation::TextTable table;
  table.title = "Faults";
  table.header = {"injected",    "exit code", "largest error [m]", "recovery [s]", "fixes left out",
                  "trustworthy", "said"};
  table.ends_in_words = true;
  std::string last;
  for (const FaultOutcome& first : outcomes) {
    if (first.fault == last) continue;
    last = first.fault;
    const std::vector<const FaultOutcome*> methods = methods_of(outcomes, first);
    table.rows.push_back(
        {find_fault_case(first.fault).title,
         beside(methods, [](const FaultOutcome& o) { return fmt::format("{}", o.exit_code); }),
         beside(methods, error_text), beside(methods, recovery_text),
         beside(methods, [](const FaultOutcome& o) { return fmt::format("{}", o.rejected); }),
         beside(methods, trust_text), without_stamps(first.message)});
  }
  return table;
}

}  // namespace foucault::laboratory
