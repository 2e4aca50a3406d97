#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "foucault/page/report_page.h"
#include "tune_job.h"

/// What a search writes and says.
namespace foucault::app {

/// best.yaml (best-METHOD.yaml for several methods), results.csv, metrics.json and
/// heatmaps/METHOD_X_Y.csv for each pair of parameters.
void write_tuning(const TuneJob& job, const std::vector<MethodTuning>& tunings,
                  const std::filesystem::path& folder);

/// The name of the file with the best configuration of a method.
std::string best_file(const TuneJob& job, const std::string& method);

std::vector<std::string> tuning_lines(const TuneJob& job, const std::vector<MethodTuning>& tunings);

/// A map for each pair of parameters in order, a curve for a parameter by itself.
page::ReportPage tuning_page(const TuneJob& job, const std::vector<MethodTuning>& tunings);

}  // namespace foucault::app
