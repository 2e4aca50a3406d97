#pragma once

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

/// The report of an evaluation as plain data.
content::EvaluationReport evaluation_report(const evaluation::EvaluationSummary& summary,
                                            const EvaluationLabels& labels);

/// Of an ablation: a table of all its cases, and all else of those as configured.
content::EvaluationReport ablation_report(const evaluation::EvaluationSummary& summary,
                                          const evaluation::EvaluationSummary& as_configured,
                                          const EvaluationLabels& labels);

page::Table report_table(const evaluation::TextTable& table, const std::string& note = "");

}  // namespace foucault::app
