#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/content/evaluation_report.h"
#include "foucault/evaluation/ablation.h"
#include "foucault/evaluation/summary.h"
#include "foucault/export/evaluation_files.h"

namespace foucault::app {

struct EvaluationLabels {
  std::string title = "Outage evaluation";
  std::vector<std::string> remarks;  ///< paragraphs at the top of the report
  exports::Provenance origin;
  std::vector<page::Link> links = {};  ///< pages beside the report
  /// What the methods of the summary are cases of, if parts of the configuration were switched off.
  std::vector<evaluation::AblationCase> ablation = {};
};

/// Of which runs the report draws errors over time and maps: the first shift of each recording (of
/// each IMU's first recording, if there are several IMUs), of the first few recordings.
class ShownRuns {
 public:
  explicit ShownRuns(bool several_imus) : by_imu_(several_imus) {}

  /// The number of the figure that a run is drawn in, if any; to be asked in the order of the runs.
  std::optional<std::size_t> place(const evaluation::ExperimentResult& run);

 private:
  struct First {
    std::string recording;
    std::string imu;
    double shift_s;
  };

  bool by_imu_;
  std::vector<First> firsts_;
};

/// The report of an evaluation as plain data. Of an ablation: a table of all cases, and all else of
/// the methods with the configuration as it is.
content::EvaluationReport evaluation_report(const evaluation::EvaluationSummary& summary,
                                            const EvaluationLabels& labels);

page::Table report_table(const evaluation::TextTable& table, const std::string& note = "");

}  // namespace foucault::app
