#pragma once

#include <string>
#include <vector>

#include "foucault/page/report_page.h"
#include "run_data.h"

namespace foucault::content {

/// Mean, RMS, median, 95 % and maximum by axis of the errors against a reference; empty without.
std::vector<page::Table> error_statistics(const RunData& data);
/// The same of a smoother less its forward run.
std::vector<page::Table> separation_statistics(const RunData& data);
/// Names the axes in which smoothing changed more than it may.
std::vector<std::string> separation_words(const RunData& data);
/// Names angles that differ from the reference by a constant far above their sigmas: axes that are
/// not the same.
std::vector<std::string> error_words(const RunData& data);
/// Statistics of innovations and of residuals after use.
std::vector<page::Table> innovation_statistics(const RunData& data);

}  // namespace foucault::content
