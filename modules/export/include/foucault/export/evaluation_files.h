#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "foucault/evaluation/ablation.h"
#include "foucault/evaluation/summary.h"
#include "foucault/export/text_file.h"

namespace foucault::exports {

/// Where results come from, for the record.
struct Provenance {
  std::string command_line;
  std::string config;  ///< the effective configuration, YAML; may be empty
  std::string version;
};

/// drift.csv: a row an outage and method, written as the results come.
class DriftFile {
 public:
  explicit DriftFile(const std::filesystem::path& path);
  void add(const evaluation::ExperimentResult& result);
  /// Nothing may be added afterwards.
  void close() { file_.close(); }

 private:
  TextFile file_;
};

/// metrics.json, config.yaml and tables/table_iii, table_iv, statistics,
/// normalized_drift, after_return (.csv, .md); for recordings that go far, also tables/distance and
/// distance_difference; if parts of the configuration were switched off, tables/ablation.
void write_evaluation(const evaluation::EvaluationSummary& summary, const Provenance& origin,
                      const std::filesystem::path& folder,
                      const std::vector<evaluation::AblationRow>& ablation = {});

}  // namespace foucault::exports
