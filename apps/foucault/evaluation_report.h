#pragma once

#include "evaluation_output.h"
#include "foucault/reports/evaluation_report.h"

namespace foucault::app {

/// The report of an evaluation as plain data.
reports::EvaluationReport evaluation_report(const EvaluationSummary& summary,
                                            const EvaluationLabels& labels);

reports::Table report_table(const TextTable& table, const std::string& note = "");

}  // namespace foucault::app
