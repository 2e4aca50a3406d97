#include "run_metrics_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "profile_text.h"
#include "units.h"
#include "version.h"

namespace foucault::app {
namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(const std::optional<double>& value, double factor = 1) {
  return value ? Json(*value * factor) : Json(nullptr);
}

Json north_east_down(const Eigen::Vector3d& v, bool exists) {
  if (!exists) return {{"north", nullptr}, {"east", nullptr}, {"down", nullptr}};
  return {{"north", v.x()}, {"east", v.y()}, {"down", v.z()}};
}

double ratio(int64_t part, int64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// Mean over the axes of the share inside 1, 2, 3 sigma; null if there is none.
Json inside_json(const InsideSigma& inside) {
  if (inside.samples == 0) return nullptr;
  const Eigen::RowVector3d mean = inside.fraction.colwise().mean();
  return {{"1_sigma", mean[0]}, {"2_sigma", mean[1]}, {"3_sigma", mean[2]}};
}

Json gnss_json(const GnssMetrics& gnss) {
  const bool exists = gnss.samples > 0;
  const int64_t fixes = gnss.used + gnss.rejected + gnss.corrected;
  const bool compared = gnss.rejected_samples > 0;
  return {{"used", gnss.used},
          {"rejected", gnss.rejected},
          {"corrected", gnss.corrected},
          {"rejected_share", fixes > 0 ? Json(ratio(gnss.rejected, fixes)) : Json(nullptr)},
          {"rejected_innovation_rms_m", north_east_down(gnss.rejected_innovation_rms_n, compared)},
          {"rejected_mean_nis", compared ? Json(gnss.rejected_mean_nis) : Json(nullptr)},
          {"innovation_rms_m", north_east_down(gnss.innovation_rms_n, exists)},
          {"postfit_rms_m", north_east_down(gnss.postfit_rms_n, exists)},
          {"mean_nis", exists ? Json(gnss.mean_nis) : Json(nullptr)},
          {"samples", gnss.samples}};
}

Json reference_json(const ReferenceMetrics& reference) {
  return {{"horizontal_rmse_m", reference.horizontal_rmse},
          {"vertical_rmse_m", reference.vertical_rmse},
          {"roll_rmse_deg", number_or_null(reference.roll_rmse, kDegrees)},
          {"pitch_rmse_deg", number_or_null(reference.pitch_rmse, kDegrees)},
          {"heading_rmse_deg", number_or_null(reference.heading_rmse, kDegrees)},
          {"velocity_rmse_m_s", number_or_null(reference.velocity_rmse)},
          {"position_inside", inside_json(reference.position_inside)},
          {"velocity_inside", inside_json(reference.velocity_inside)},
          {"attitude_inside", inside_json(reference.attitude_inside)},
          {"position_nees", number_or_null(reference.position_nees)},
          {"velocity_nees", number_or_null(reference.velocity_nees)},
          {"attitude_nees", number_or_null(reference.attitude_nees)},
          {"samples", reference.samples}};
}

Json square_json(const SquareConsistency& squares) {
  const bool exists = squares.samples > 0;
  const auto number = [exists](double value) { return exists ? Json(value) : Json(nullptr); };
  return {{"mean", number(squares.mean)},
          {"mean_low", number(squares.mean_band.low)},
          {"mean_high", number(squares.mean_band.high)},
          {"inside_95", number(squares.inside_share)},
          {"samples", squares.samples},
          {"effective_samples", number(squares.effective_samples)}};
}

Json stretches_json(const StretchConsistency& s) {
  return {{"fixes_each", kRunningMeanFixes},
          {"count", s.stretches},
          {"above_3_sigma", s.too_large},
          {"worst", s.stretches > 0 ? Json(s.worst) : Json(nullptr)}};
}

Json predictions_json(const std::vector<PredictionConsistency>& predictions) {
  Json json = Json::array();
  for (const PredictionConsistency& p : predictions) {
    json.push_back({{"after_s", p.ahead_s},
                    {"mean_nis", p.mean_nis},
                    {"mean_low", p.mean_band.low},
                    {"mean_high", p.mean_band.high},
                    {"samples", p.samples}});
  }
  return json;
}

Json residual_json(const ResidualStatistics& s) {
  if (s.samples == 0) return nullptr;
  return {{"mean", s.mean},
          {"sigma", s.sigma},
          {"excess_kurtosis", number_or_null(s.excess_kurtosis)},
          {"inside_1_sigma", s.inside[0]},
          {"inside_2_sigma", s.inside[1]},
          {"inside_3_sigma", s.inside[2]}};
}

Json autocorrelation_json(const ResidualAutocorrelation& a) {
  if (a.lag.empty()) return nullptr;
  return {{"lags", a.lag.size()},
          {"interval_s", a.interval_s},
          {"white_bound", a.white_bound},
          {"outside_share", a.outside_share},
          {"lag_1", north_east_down(a.lag.front(), true)}};
}

Json consistency_json(const Consistency& c) {
  Json json{{"bound_low", c.single_band.low},
            {"bound_high", c.single_band.high},
            {"nis", square_json(c.nis)},
            {"stretches", stretches_json(c.stretches)},
            {"horizons", predictions_json(c.predictions)},
            {"whitened_innovation",
             {{"north", residual_json(c.innovations[0])},
              {"east", residual_json(c.innovations[1])},
              {"down", residual_json(c.innovations[2])}}},
            {"autocorrelation", autocorrelation_json(c.autocorrelation)}};
  if (c.position_nees) json["position_nees"] = square_json(*c.position_nees);
  if (c.velocity_nees) json["velocity_nees"] = square_json(*c.velocity_nees);
  if (c.attitude_nees) json["attitude_nees"] = square_json(*c.attitude_nees);
  return json;
}

Json aids_json(const Aids& aids) {
  Json json = Json::object();
  for (const auto& [name, aid] : aids) {
    json[name] = {{"used", aid.used},
                  {"rejected", aid.rejected},
                  {"mean_nis", aid.used > 0 ? Json(aid.mean_nis()) : Json(nullptr)}};
  }
  return json;
}

Json calibration_json(const std::vector<CalibratedBlock>& blocks) {
  Json json = Json::object();
  for (const CalibratedBlock& b : blocks)
    json[std::string(b.block.name)] = {
        {"value", b.value}, {"sigma", b.sigma}, {"unit", std::string(b.block.unit)}};
  return json;
}

Json profile_json(const std::vector<StageTime>& profile) {
  Json json = Json::object();
  for (const StageTime& time : profile) {
    json[fmt::format("{}_s", stage_name(time.stage))] = time.seconds;
  }
  json["total_s"] = total_seconds(profile);
  return json;
}

/// "-" if no fix counts for the statistics.
std::string innovation_text(const GnssMetrics& gnss) {
  if (gnss.samples == 0) return "-";
  const Eigen::Vector3d& v = gnss.innovation_rms_n;
  return fmt::format("{:.2f} / {:.2f} / {:.2f} cm", 100 * v.x(), 100 * v.y(), 100 * v.z());
}

/// What speaks for a run.
std::string size_text(const RunResult& result) {
  const SquareConsistency& nis = result.metrics.consistency.nis;
  return fmt::format("innovations of {} fixes are {:.2f} times as large as their sigmas",
                     nis.samples, std::sqrt(nis.mean / 3));
}

std::string attitude_text(const ReferenceMetrics& r) {
  if (!r.roll_rmse || !r.pitch_rmse || !r.heading_rmse) return "";
  return fmt::format("; roll {:.3f}, pitch {:.3f}, heading {:.3f} deg", *r.roll_rmse * kDegrees,
                     *r.pitch_rmse * kDegrees, *r.heading_rmse * kDegrees);
}

std::string percent(double fraction) { return fmt::format("{:.1f} %", 100 * fraction); }

std::string degrees_or_dash(const std::optional<double>& angle) {
  return angle ? fmt::format("{:.4f} deg", *angle * kDegrees) : "-";
}

page::Table gnss_table(const GnssMetrics& gnss) {
  page::Table table;
  table.title = "GNSS";
  table.note =
      "Innovation: the fix minus its prediction before it is used. Root mean squares over " +
      fmt::format("{} fixes; mean NIS {:.2f} (3 if the covariances are right).", gnss.samples,
                  gnss.mean_nis);
  table.header = {"", "north [m]", "east [m]", "down [m]"};
  const auto row = [](const char* name, const Eigen::Vector3d& v) {
    return std::vector<std::string>{name, fmt::format("{:.4f}", v.x()),
                                    fmt::format("{:.4f}", v.y()), fmt::format("{:.4f}", v.z())};
  };
  table.rows = {row("innovation RMS", gnss.innovation_rms_n),
                row("post-fit RMS", gnss.postfit_rms_n)};
  return table;
}

page::Table reference_table(const ReferenceMetrics& r) {
  page::Table table;
  table.title = "Errors against the reference";
  table.note = fmt::format(
      "Over {} epochs. Of Gaussian errors with the right covariance 99.7 % lie inside 3 sigma.",
      r.samples);
  table.header = {"", "RMS"};
  table.rows = {{"horizontal", fmt::format("{:.4f} m", r.horizontal_rmse)},
                {"vertical", fmt::format("{:.4f} m", r.vertical_rmse)},
                {"roll", degrees_or_dash(r.roll_rmse)},
                {"pitch", degrees_or_dash(r.pitch_rmse)},
                {"heading", degrees_or_dash(r.heading_rmse)}};
  for (const auto& [name, inside] : {std::pair{"position inside 3 sigma", &r.position_inside},
                                     std::pair{"velocity inside 3 sigma", &r.velocity_inside},
                                     std::pair{"attitude inside 3 sigma", &r.attitude_inside}}) {
    if (inside->samples > 0) table.rows.push_back({name, percent(inside->fraction.col(2).mean())});
  }
  return table;
}

page::Table aids_table(const Aids& aids) {
  page::Table table;
  table.title = "Other measurements";
  table.note =
      "Mean NIS: innovations squared by their covariance; as many as components if it is right.";
  table.header = {"", "used", "rejected", "mean NIS"};
  for (const auto& [name, aid] : aids) {
    table.rows.push_back({name, fmt::format("{}", aid.used), fmt::format("{}", aid.rejected),
                          fmt::format("{:.2f}", aid.mean_nis())});
  }
  return table;
}

page::Table calibration_table(const std::vector<CalibratedBlock>& blocks) {
  page::Table table;
  table.title = "Calibration";
  table.note = "At the last epoch, with 1 sigma.";
  table.header = {"", "unit", "value", "sigma"};
  for (const CalibratedBlock& b : blocks) {
    table.rows.push_back({std::string(b.block.name), std::string(b.block.unit),
                          fmt::format("{:.4g}", fmt::join(b.value, ", ")),
                          fmt::format("{:.2g}", fmt::join(b.sigma, ", "))});
  }
  return table;
}

}  // namespace

std::string metrics_json(const RunResult& result) {
  const RunMetrics& m = result.metrics;
  Json json{{"method", result.method},    {"epochs", m.epochs},
            {"duration_s", m.duration_s}, {"trustworthy", m.trust.trustworthy},
            {"reasons", m.trust.reasons}, {"gnss", gnss_json(m.gnss)},
            {"aids", aids_json(m.aids)},  {"calibration", calibration_json(result.calibration)}};
  if (m.reference) json["reference"] = reference_json(*m.reference);
  json["consistency"] = consistency_json(m.consistency);
  json["statistics_from_s"] = result.statistics_from_s;
  json["cpu_s"] = result.resources.cpu_s;
  json["wall_s"] = result.resources.wall_s;
  json["peak_rss_mb"] = result.resources.peak_rss_mb;
  json["log"] = result.log;
  if (!result.profile.empty()) json["profile"] = profile_json(result.profile);
  if (result.damage) json["damage"] = *result.damage;
  json["version"] = kVersion;
  return json.dump(2) + "\n";
}

std::vector<std::string> metrics_lines(const RunResult& result) {
  const RunMetrics& m = result.metrics;
  std::vector<std::string> lines{
      fmt::format("method     {}, {} epochs over {:.1f} s", result.method, m.epochs, m.duration_s),
      fmt::format("GNSS       {} fixes used, {} rejected; innovation RMS north / east / down {}",
                  m.gnss.used, m.gnss.rejected, innovation_text(m.gnss))};
  for (const auto& [name, aid] : m.aids) {
    lines.push_back(fmt::format("aid        {}: {} used, {} rejected; mean NIS {:.2f}", name,
                                aid.used, aid.rejected, aid.mean_nis()));
  }
  for (const CalibratedBlock& b : result.calibration) {
    lines.push_back(fmt::format("calibrated {} [{}]: {:.3g} +- {:.2g}", b.block.name, b.block.unit,
                                fmt::join(b.value, " "), fmt::join(b.sigma, " ")));
  }
  if (m.reference) {
    lines.push_back(fmt::format("reference  RMS error horizontal {:.3f} m, vertical {:.3f} m{}",
                                m.reference->horizontal_rmse, m.reference->vertical_rmse,
                                attitude_text(*m.reference)));
  }
  lines.push_back(fmt::format("resources  {:.1f} s wall, {:.1f} s CPU, {:.0f} MB",
                              result.resources.wall_s, result.resources.cpu_s,
                              result.resources.peak_rss_mb));
  return lines;
}

std::string verdict_line(const RunResult& result) {
  const Trust& trust = result.metrics.trust;
  const std::string reasons = fmt::format("{}", fmt::join(trust.reasons, "; "));
  if (!trust.trustworthy) return fmt::format("verdict    NOT TRUSTWORTHY: {}", reasons);
  return fmt::format("verdict    trustworthy; {}", reasons.empty() ? size_text(result) : reasons);
}

page::Banner verdict_banner(const RunResult& result) {
  const Trust& trust = result.metrics.trust;
  if (!trust.trustworthy) return {true, "This run cannot be believed", trust.reasons};
  std::vector<std::string> lines = trust.reasons;
  if (lines.empty()) lines.push_back(size_text(result));
  return {false, "This run is trustworthy", lines};
}

std::vector<page::KeyNumber> key_numbers(const RunResult& result) {
  const RunMetrics& m = result.metrics;
  std::vector<page::KeyNumber> numbers;
  if (m.reference) {
    numbers.push_back({"Horizontal error, RMS", fmt::format("{:.3f}", m.reference->horizontal_rmse),
                       "m", "against the reference"});
    numbers.push_back({"Vertical error, RMS", fmt::format("{:.3f}", m.reference->vertical_rmse),
                       "m", "against the reference"});
  }
  if (m.gnss.samples > 0) {
    const double horizontal = m.gnss.innovation_rms_n.head<2>().norm();
    numbers.push_back({"Innovation, horizontal RMS", fmt::format("{:.2f}", 100 * horizontal), "cm",
                       "fix minus prediction"});
  }
  numbers.push_back({"Fixes used", fmt::format("{}", m.gnss.used), "",
                     fmt::format("{} rejected", m.gnss.rejected)});
  numbers.push_back(
      {"Duration", fmt::format("{:.0f}", m.duration_s), "s", fmt::format("{} epochs", m.epochs)});
  numbers.push_back(
      {"Processing", fmt::format("{:.1f}", result.resources.wall_s), "s",
       fmt::format("{:.0f} times faster than recorded", m.duration_s / result.resources.wall_s)});
  return numbers;
}

std::vector<page::Table> metrics_tables(const RunResult& result) {
  std::vector<page::Table> tables;
  if (result.metrics.reference) tables.push_back(reference_table(*result.metrics.reference));
  if (result.metrics.gnss.samples > 0) tables.push_back(gnss_table(result.metrics.gnss));
  if (!result.metrics.aids.empty()) tables.push_back(aids_table(result.metrics.aids));
  if (!result.calibration.empty()) tables.push_back(calibration_table(result.calibration));
  return tables;
}

}  // namespace foucault::app
