#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/consistency.h"
#include "foucault/evaluation/drift_table.h"
#include "foucault/evaluation/reference_error.h"
#include "foucault/evaluation/run_metrics.h"
#include "foucault/laboratory/fault_cases.h"
#include "foucault/simulation/scenario.h"

/// What faults of recordings do to the methods, on simulated trips with exact truth.
namespace foucault::laboratory {

/// The trip, common to all cases: city, ADIS16465 at 200 Hz, RTK at 1 Hz, 460 s, of which the first
/// 40 at rest.
simulation::ScenarioOptions fault_scenario(int64_t seed);

struct FaultOutcome {
  std::string fault;
  std::string method;
  int64_t seed = 0;
  int exit_code = 0;           ///< the program's
  std::string message;         ///< the error, or what the notices say
  int64_t used = 0;            ///< fixes
  int64_t rejected = 0;        ///< fixes
  std::optional<Trust> trust;  ///< none if nothing came out
  int64_t errors = 0;          ///< epochs compared with the truth
  double rms_m = 0;            ///< horizontal error, from 60 s after the alignment on
  double largest_m = 0;        ///< its largest
  /// From the end of the fault (or its start, if it does not end) until the error stays below
  /// kRecoveredSigmas of a fix; none if it does not before the end, or nothing came out.
  std::optional<double> recovery_s;
};

constexpr double kRecoveredSigmas = 10;

/// Errors and messages of one run.
class FaultObserver : public state::Sink {
 public:
  /// Before anything else.
  void place(const state::Mounting& mounting);
  void reference(const ReferencePose& reference) { comparison_->add(reference); }
  void epoch(const state::Epoch& epoch) override;
  void fix(const state::FixResult& fix) override { metrics_->fix(fix); }
  void notice(const state::Notice& notice) override;
  void warning(const state::Notice& notice) override { warnings_.push_back(notice.text); }
  /// At the end; what condemns the run is said like a notice.
  void judge();

  struct Error {
    int64_t t_ns;
    double horizontal;
  };
  std::vector<Error> errors;
  std::vector<std::string> notices;
  evaluation::RunMetrics metrics;  ///< from judge() on

 private:
  std::optional<evaluation::RunMetricsCollector> metrics_;
  std::optional<evaluation::ReferenceComparison> comparison_;
  std::vector<std::string> warnings_;
};

/// What the study does not know: rawlogs and estimators.
struct FaultProgram {
  /// Writes the trip with its fault as a log.
  std::function<void(const FaultCase& fault, int64_t seed, const std::string& log)> write;
  /// Processes a log as `foucault run` does. Returns why it broke off, if it did.
  std::function<std::optional<std::string>(const std::string& log, const std::string& method,
                                           FaultObserver& observer)>
      process;
};

/// Writes the trip with its fault to `log`, processes it with each method, and removes it.
std::vector<FaultOutcome> run_fault(const FaultCase& fault, const std::vector<std::string>& methods,
                                    int64_t seed, const std::string& log,
                                    const FaultProgram& program);

/// A row a case, method and seed.
evaluation::TextTable fault_table(const std::vector<FaultOutcome>& outcomes);

/// A row a case, methods side by side, of the first seed.
evaluation::TextTable fault_summary(const std::vector<FaultOutcome>& outcomes);

}  // namespace foucault::laboratory
