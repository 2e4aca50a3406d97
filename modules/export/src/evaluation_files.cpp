#include "foucault/export/evaluation_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "foucault/evaluation/csv_line.h"
#include "foucault/export/json_object.h"
#include "foucault/export/text_file.h"

namespace foucault::exports {
namespace {

Json estimate_json(const evaluation::Estimate& e) {
  return Object().with("value", e.value).with("low", e.low).with("high", e.high);
}

Json statistics_json(const std::vector<double>& values) {
  const evaluation::Summary s = evaluation::summarize(values);
  return Object()
      .with("rms", estimate_json(s.rms))
      .with("mean", estimate_json(s.mean))
      .with("median", estimate_json(s.median))
      .with("p68", estimate_json(s.p68))
      .with("p95", estimate_json(s.p95))
      .with("max", estimate_json(s.max));
}

/// RMS over the outages at each mark that all of them reach.
Json mark_json(const evaluation::MethodOutages& outages,
               evaluation::Sum evaluation::MethodOutages::SquaredDrift::*component) {
  Json json = Json::object();
  const std::vector<double>& marks_s = evaluation::default_drift_marks_s();
  for (std::size_t i = 0; i < std::min(marks_s.size(), outages.at_marks.size()); ++i) {
    const evaluation::Sum& squares = outages.at_marks[i].*component;
    if (squares.count != static_cast<int64_t>(outages.size())) continue;
    json[fmt::format("{}", marks_s[i])] = std::sqrt(squares.mean());
  }
  return json;
}

Json method_json(const evaluation::MethodOutages& outages) {
  using Squares = evaluation::MethodOutages::SquaredDrift;
  const std::vector<double>& horizontal = outages.horizontal_max();
  const std::vector<double>& vertical = outages.vertical_max();
  return Object()
      .with("outages", outages.size())
      .with("horizontal_rmse_m", evaluation::root_mean_square(horizontal))
      .with("vertical_rmse_m", evaluation::root_mean_square(vertical))
      .with("cpu_s", outages.cpu_s)
      .with("missing_outages", outages.missing)
      .with("horizontal_m", statistics_json(horizontal))
      .with("vertical_m", statistics_json(vertical))
      .with("horizontal_rms_m_after_s", mark_json(outages, &Squares::horizontal))
      .with("vertical_rms_m_after_s", mark_json(outages, &Squares::vertical));
}

Json methods_json(const std::vector<evaluation::MethodOutages>& outages, const std::string& group) {
  Json json = Json::object();
  for (const evaluation::MethodOutages& o : outages) {
    if (o.group == group && !o.empty()) json[o.method] = method_json(o);
  }
  return json;
}

Json paired_json(const std::vector<double>& base, const std::vector<double>& other) {
  const evaluation::PairedComparison c = evaluation::compare_paired(base, other);
  return Object()
      .with("base_rms_m", c.base_rms)
      .with("other_rms_m", c.other_rms)
      .with("difference_m", estimate_json(c.rms_difference))
      .with("relative", estimate_json(c.relative))
      .with("share_larger", c.share_larger)
      .with("p_value", c.p_value);
}

/// Each method against the first one of its group.
Json comparisons_json(const std::vector<evaluation::MethodOutages>& outages) {
  Json json = Json::array();
  for (const evaluation::MethodOutages& other : outages) {
    const auto base =
        std::find_if(outages.begin(), outages.end(),
                     [&](const evaluation::MethodOutages& o) { return o.group == other.group; });
    if (&*base == &other || other.empty()) continue;
    json.push_back(
        Object()
            .with("group", other.group)
            .with("base", base->method)
            .with("other", other.method)
            .with("outages", other.size())
            .with("horizontal", paired_json(base->horizontal_max(), other.horizontal_max()))
            .with("vertical", paired_json(base->vertical_max(), other.vertical_max())));
  }
  return json;
}

Json bin_json(const evaluation::ProfileBin& bin) {
  Json methods = Json::object();
  for (const evaluation::BinDrift& drift : bin.methods) {
    methods[drift.method] =
        Object()
            .with("horizontal_rmse_m", estimate_json(drift.horizontal_m))
            .with("vertical_rmse_m", estimate_json(drift.vertical_m))
            .with("horizontal_relative", estimate_json(drift.horizontal_relative))
            .with("vertical_relative", estimate_json(drift.vertical_relative));
  }
  return Object()
      .with("from_km", bin.bin.from_km)
      .with("to_km", bin.bin.to_km)
      .with("mean_km", bin.mean_km)
      .with("outages", bin.bin.outages.size())
      .with("methods", methods);
}

/// Relative differences are from the first method.
Json distances_json(const std::vector<evaluation::DistanceProfile>& profiles) {
  Json json = Json::array();
  for (const evaluation::DistanceProfile& profile : profiles) {
    Json bins = Json::array();
    for (const evaluation::ProfileBin& bin : profile.bins) bins.push_back(bin_json(bin));
    json.push_back(Object().with("group", profile.group).with("bins", bins));
  }
  return json;
}

Json squares_json(const evaluation::MethodNormalizedDrifts& method,
                  const evaluation::NormalizedDrift& drift, const char* axis,
                  const evaluation::PooledSquares& squares) {
  return Object()
      .with("group", method.group)
      .with("method", method.method)
      .with("after_s", drift.after_s)
      .with("middle", drift.middle)
      .with("axis", axis)
      .with("mean_square", squares.mean)
      .with("band_low", squares.band.low)
      .with("band_high", squares.band.high)
      .with("outages", squares.outages);
}

/// An entry a group, method, time and axis; mean squares per degree of freedom.
Json normalized_json(const std::vector<evaluation::MethodNormalizedDrifts>& methods) {
  Json json = Json::array();
  for (const evaluation::MethodNormalizedDrifts& method : methods) {
    for (const evaluation::NormalizedDrift& drift : method.times) {
      if (drift.horizontal.outages > 0) {
        json.push_back(squares_json(method, drift, "horizontal", drift.horizontal));
      }
      if (drift.vertical.outages > 0) {
        json.push_back(squares_json(method, drift, "vertical", drift.vertical));
      }
    }
  }
  return json;
}

Json returns_json(const std::vector<evaluation::PooledReturns>& returns) {
  Json json = Json::array();
  for (const evaluation::PooledReturns& r : returns) {
    json.push_back(Object()
                       .with("group", r.group)
                       .with("method", r.method)
                       .with("window_s", evaluation::kReturnWindowS)
                       .with("outages", r.outages)
                       .with("horizontal_rms_m", r.rms_horizontal)
                       .with("horizontal_max_m", r.max_horizontal)
                       .with("median_settled_s", number_or_null(r.median_settled_s))
                       .with("max_settled_s", number_or_null(r.max_settled_s))
                       .with("never_settled", r.never_settled));
  }
  return json;
}

const char* truth_name(evaluation::DriftTruth truth) {
  return truth == evaluation::DriftTruth::reference ? "reference" : "withheld_fixes";
}

Json run_json(const evaluation::RunName& name, const evaluation::RunFacts& run) {
  return Object()
      .with("recording", name.recording)
      .with("imu", name.imu)
      .with("method", name.method)
      .with("shift_s", name.shift_s)
      .with("truth", truth_name(run.truth))
      .with("fixes_span_s", run.fixes_span_s)
      .with("outages", run.outages)
      .with("scheduled_outages", run.scheduled)
      .with("cpu_s", run.cpu_s);
}

Json relative_json(const std::optional<evaluation::Estimate>& relative) {
  return relative ? estimate_json(*relative) : Json();
}

Json ablation_json(const std::vector<evaluation::AblationRow>& rows) {
  Json json = Json::array();
  for (const evaluation::AblationRow& row : rows) {
    json.push_back(Object()
                       .with("method", row.what.method)
                       .with("without", row.what.without)
                       .with("horizontal_rmse_m", row.horizontal_rms_m)
                       .with("vertical_rmse_m", row.vertical_rms_m)
                       .with("horizontal_relative", relative_json(row.horizontal_relative))
                       .with("vertical_relative", relative_json(row.vertical_relative)));
  }
  return json;
}

std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

/// Stands where the runs come, which may be a million: they are written one by one.
constexpr const char* kRuns = "the runs";

Json metrics_json(const evaluation::EvaluationSummary& summary, const Provenance& origin,
                  const std::vector<evaluation::AblationRow>& ablation) {
  Json json;
  json["methods"] = methods_json(summary.overall(), summary.overall().front().group);
  Json rows = Json::object();
  for (const evaluation::MethodOutages& row : summary.rows()) {
    if (!rows.contains(row.group)) rows[row.group] = methods_json(summary.rows(), row.group);
  }
  json[summary.row_header() == "IMU" ? "imus" : "recordings"] = rows;
  json["comparisons"] = comparisons_json(summary.rows());
  if (!ablation.empty()) json["ablation"] = ablation_json(ablation);
  json["distances"] = distances_json(summary.distances());
  json["normalized_drift"] = normalized_json(summary.normalized());
  json["after_return"] = returns_json(summary.returns());
  json["runs"] = kRuns;
  json["interval"] = "95 % bootstrap over outages";
  json["command"] = origin.command_line;
  json["version"] = origin.version;
  json["config"] = origin.config;
  return json;
}

void write_runs(const evaluation::EvaluationSummary& summary, TextFile& file) {
  for (std::size_t i = 0; i < summary.runs().size(); ++i) {
    file.write(i == 0 ? "[" : ",");
    const std::string run = text_of(run_json(summary.names().at(i), summary.runs()[i]));
    for (const std::string& line : evaluation::text_lines(run)) file.write("\n    " + line);
  }
  file.write("\n  ]");
}

void write_metrics(const Json& json, const evaluation::EvaluationSummary& summary,
                   const std::filesystem::path& path) {
  const std::string text = text_of(json) + "\n";
  const std::string place = fmt::format("\n  \"runs\": \"{}\"", kRuns);
  const std::size_t end = text.find(place) + place.size();
  TextFile file(path);
  file.write(std::string_view(text).substr(0, end - std::string_view(kRuns).size() - 2));
  write_runs(summary, file);
  file.write(std::string_view(text).substr(end));
  file.close();
}

void write_table(const evaluation::TextTable& table, const std::filesystem::path& folder,
                 const std::string& name) {
  write_text_file(folder / (name + ".csv"), evaluation::to_csv(table));
  write_text_file(folder / (name + ".md"), evaluation::to_markdown(table));
}

}  // namespace

DriftFile::DriftFile(const std::filesystem::path& path) : file_(path) {
  file_.write(
      evaluation::to_csv(evaluation::drift_record_table({}, evaluation::default_drift_marks_s())));
}

void DriftFile::add(const evaluation::ExperimentResult& result) {
  const evaluation::TextTable table = evaluation::drift_record_table(
      evaluation::drift_records(result), evaluation::default_drift_marks_s());
  for (const std::vector<std::string>& row : table.rows) {
    file_.write(evaluation::csv_line(row) + "\n");
  }
}

void write_evaluation(const evaluation::EvaluationSummary& summary, const Provenance& origin,
                      const std::filesystem::path& folder,
                      const std::vector<evaluation::AblationRow>& ablation) {
  write_metrics(metrics_json(summary, origin, ablation), summary, folder / "metrics.json");
  if (!origin.config.empty()) write_text_file(folder / "config.yaml", origin.config);
  std::filesystem::create_directories(folder / "tables");
  write_table(summary.rms_table(), folder / "tables", "table_iii");
  write_table(summary.difference_table(), folder / "tables", "table_iv");
  write_table(summary.statistics_table(), folder / "tables", "statistics");
  write_table(summary.normalized_table(), folder / "tables", "normalized_drift");
  write_table(summary.return_table(), folder / "tables", "after_return");
  if (!ablation.empty()) {
    write_table(evaluation::ablation_table(ablation), folder / "tables", "ablation");
  }
  if (summary.distances().empty()) return;
  write_table(evaluation::distance_table(summary.distances(), summary.row_header()),
              folder / "tables", "distance");
  write_table(evaluation::distance_difference_table(summary.distances(), summary.row_header()),
              folder / "tables", "distance_difference");
}

}  // namespace foucault::exports
