#pragma once

#include <string>
#include <vector>

#include "foucault/content/evaluation_report.h"
#include "foucault/evaluation/summary.h"
#include "foucault/export/evaluation_files.h"

namespace foucault::app {

struct EvaluationLabels {
  std::string title = "Outage evaluation";
  std::vector<std::string> remarks;  ///< paragraphs at the top of the report
  exports::Provenance origin;
};

/// The report of an evaluation as plain data.
content::EvaluationReport evaluation_report(const evaluation::EvaluationSummary& summary,
                                            const EvaluationLabels& labels);

page::Table report_table(const evaluation::TextTable& table, const std::string& note = "");

}  // namespace foucault::app
