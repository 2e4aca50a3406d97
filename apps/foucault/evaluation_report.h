#pragma once

#include "evaluation_output.h"
#include "foucault/content/evaluation_report.h"

namespace foucault::app {

/// The report of an evaluation as plain data.
content::EvaluationReport evaluation_report(const EvaluationSummary& summary,
                                            const EvaluationLabels& labels);

page::Table report_table(const TextTable& table, const std::string& note = "");

}  // namespace foucault::app
