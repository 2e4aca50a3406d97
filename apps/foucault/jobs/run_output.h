#pragma once

#include <filesystem>
#include <optional>

#include "console.h"
#include "foucault/content/run_report.h"
#include "foucault/evaluation/reference_error.h"
#include "foucault/evaluation/run_metrics.h"
#include "foucault/export/reference_tum.h"
#include "foucault/export/solution_writer.h"
#include "foucault/state/forward_sink.h"
#include "jobs/forward_run.h"
#include "jobs/run_facts.h"
#include "settings.h"

namespace foucault::app {

/// Where everything that comes out of a run goes: solution files, metrics, report, console.
class RunOutput : public state::ForwardSink {
 public:
  /// `keep_references_s`: how far epochs may lag behind references. `report` may be null; it and
  /// the console must outlive this.
  RunOutput(const std::filesystem::path& folder, const state::Mounting& mounting,
            const OutputOptions& options, double keep_references_s, content::RunReport* report,
            Console& console);

  /// Every measurement, before the estimator gets it: references and stamps are taken from it.
  void measurement(const Measurement& measurement);

  void epoch(const state::Epoch& epoch) override;
  void forward_epoch(const state::Epoch& epoch) override;
  void fix(const state::FixResult& fix) override;
  void observation(const state::ObservationResult& result) override;
  void notice(const state::Notice& notice) override;
  bool wants_predictions() const override { return true; }
  void catching_up(std::size_t left) override;
  void warning(const state::Notice& n) override { notice(n); }
  void prediction(const state::PredictionResult& prediction) override;
  /// What was found before, for files and report; it has been said.
  void remark(const std::string& text);
  /// Why the log broke off, for the report; the command says it at its end.
  void damage(const std::string& text);

  /// Completes the files, and what the report needs.
  evaluation::RunMetrics finish();
  /// None if there was no forward run.
  std::optional<ForwardResult> forward(const std::string& method) const {
    return forward_.result(method);
  }
  const state::Epoch& last_epoch() const { return last_epoch_; }
  const RunFacts& facts() const { return facts_; }

 private:
  void start(int64_t t_ns);
  void start_metrics(int64_t first_fix_ns);
  void write(const state::Epoch& epoch);
  void collect(const state::Epoch& epoch);
  void reference_error(const state::Epoch& epoch, const state::ReferenceError& error);

  state::Mounting mounting_;
  double statistics_from_s_;
  std::optional<int64_t> start_ns_;  ///< first stamp of the recording
  exports::SolutionWriter solution_;
  exports::ReferenceTum reference_;
  evaluation::ReferenceComparison comparison_;
  std::optional<evaluation::RunMetricsCollector> metrics_;  ///< from the first fix on
  ForwardRun forward_;
  state::Epoch last_epoch_;
  RunFacts facts_;
  content::RunReport* report_;
  Console& console_;
  std::size_t most_left_ = 0;  ///< to catch up with
};

}  // namespace foucault::app
