#include "texts/run_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "foucault/core/time.h"
#include "foucault/core/units.h"
#include "foucault/export/json_object.h"
#include "foucault/export/run_metrics_json.h"
#include "libraries.h"
#include "texts/profile_text.h"
#include "version.h"

namespace foucault::app {
namespace {

using exports::Json;
using exports::Object;

Json profile_json(const std::vector<StageTime>& profile) {
  Json json = Json::object();
  for (const StageTime& time : profile) {
    json[fmt::format("{}_s", stage_name(time.stage))] = time.seconds;
  }
  json["total_s"] = total_seconds(profile);
  return json;
}

/// Raised whenever a key goes or changes its meaning; new keys leave it.
constexpr int kSchemaVersion = 1;

Json moment_json(const std::optional<int64_t>& t_ns) {
  if (!t_ns) return nullptr;
  const GpsTime gps = unix_to_gps(*t_ns);
  return Object()
      .with("utc", utc_text(*t_ns))
      .with("gps_week", gps.week)
      .with("gps_second", static_cast<double>(gps.tow_ns) * 1e-9);
}

std::string kind_text(state::NoticeKind kind) {
  switch (kind) {
    case state::NoticeKind::aligned:
      return "aligned";
    case state::NoticeKind::imu_gap:
      return "imu_gap";
    case state::NoticeKind::realigned:
      return "realigned";
    case state::NoticeKind::fix_rejected:
      return "fix_rejected";
    case state::NoticeKind::skipped:
      break;
  }
  return "notice";
}

/// When, how far, what was said on the way.
Json facts_json(const RunFacts& facts) {
  Json notices = Json::array();
  for (const state::Notice& notice : facts.notices) {
    notices.push_back(Object()
                          .with("utc", utc_text(notice.t_ns))
                          .with("kind", kind_text(notice.kind))
                          .with("text", notice.text));
  }
  return Object()
      .with("start", moment_json(facts.begin_ns))
      .with("end", moment_json(facts.end_ns))
      .with("distance_m", facts.distance_m)
      .with("notices", notices)
      .with("notices_seen", facts.notices_seen);
}

/// What a reader needs to compare the two.
Json forward_json(const ForwardResult& forward) {
  const Json all = exports::run_metrics_json(forward.metrics, {});
  Json json = Object().with("method", forward.method).with("epochs", forward.metrics.epochs);
  for (const char* key : {"reference", "reference_elsewhere_m"}) {
    if (all.contains(key)) json[key] = all[key];
  }
  for (const auto& [key, value] : all["consistency"].items()) {
    if (key == "nis" || key.find("nees") != std::string::npos) json["consistency"][key] = value;
  }
  json["separation"] = exports::separation_json(forward.separation);
  return json;
}

Json libraries_json() {
  return Object()
      .with("mrpt", kMrptVersion)
      .with("ceres", kCeresVersion)
      .with("eigen", kEigenVersion)
      .with("opencv", kOpenCvVersion);
}

/// "-" if no fix counts for the statistics.
std::string innovation_text(const evaluation::GnssMetrics& gnss) {
  if (gnss.samples == 0) return "-";
  const Eigen::Vector3d& v = gnss.innovation_rms_n;
  return fmt::format("{:.2f} / {:.2f} / {:.2f} cm", 100 * v.x(), 100 * v.y(), 100 * v.z());
}

std::string attitude_text(const evaluation::ReferenceMetrics& r) {
  if (!r.roll_rmse || !r.pitch_rmse || !r.heading_rmse) return "";
  return fmt::format("; roll {:.3f}, pitch {:.3f}, heading {:.3f} deg",
                     *r.roll_rmse * units::kDegrees, *r.pitch_rmse * units::kDegrees,
                     *r.heading_rmse * units::kDegrees);
}

std::string reference_text(const evaluation::ReferenceMetrics& r) {
  return fmt::format("RMS error horizontal {:.3f} m, vertical {:.3f} m{}", r.horizontal_rmse,
                     r.vertical_rmse, attitude_text(r));
}

std::string forward_text(const ForwardResult& forward) {
  const std::string apart = separation_text(forward.separation);
  if (!forward.metrics.reference) return fmt::format("{}; {}", forward.method, apart);
  return fmt::format("{}: {}; {}", forward.method, reference_text(*forward.metrics.reference),
                     apart);
}

}  // namespace

std::string separation_text(const evaluation::SeparationMetrics& separation) {
  return fmt::format(
      "smoothed less forward, RMS: horizontal {:.3f} m, vertical {:.3f} m, "
      "heading {:.3f} deg",
      separation.position_rms_n.head<2>().norm(), separation.position_rms_n.z(),
      separation.euler_rms.z() * units::kDegrees);
}

std::string size_text(const RunResult& result) {
  const SquareConsistency& nis = result.metrics.consistency.nis;
  return fmt::format("innovations of {} fixes are {:.2f} times as large as their sigmas",
                     nis.samples, std::sqrt(nis.mean / 3));
}

std::optional<std::string> against_reference(const RunResult& result) {
  constexpr double kExpected = 0.95;  // 0.997, of errors that last
  const std::optional<evaluation::ReferenceMetrics>& reference = result.metrics.reference;
  if (!reference || reference->position_inside.samples == 0) return std::nullopt;
  const double inside = reference->position_inside.fraction.col(2).mean();
  if (inside >= kExpected) return std::nullopt;
  return fmt::format(
      "against the reference only {:.1f} % of the position errors lie within 3 sigma (99.7 % if "
      "the sigmas are right): the solution is worse than its sigmas say",
      100 * inside);
}

std::string metrics_json(const RunResult& result) {
  Json json = Object().with("method", result.method).with("schema_version", kSchemaVersion);
  json.update(exports::run_metrics_json(result.metrics, result.calibration));
  if (result.forward) json["forward"] = forward_json(*result.forward);
  if (const std::optional<std::string> warning = against_reference(result)) {
    json["against_reference"] = *warning;
  }
  json.update(facts_json(result.facts));
  json["statistics_from_s"] = result.statistics_from_s;
  json["cpu_s"] = result.resources.cpu_s;
  json["wall_s"] = result.resources.wall_s;
  json["peak_rss_mb"] = result.resources.peak_rss_mb;
  json["log"] = result.log;
  if (!result.profile.empty()) json["profile"] = profile_json(result.profile);
  if (result.damage) json["damage"] = *result.damage;
  json["version"] = kVersion;
  json["libraries"] = libraries_json();
  json["command"] = result.command_line;
  return json.dump(2) + "\n";
}

std::vector<std::string> metrics_lines(const RunResult& result) {
  const evaluation::RunMetrics& m = result.metrics;
  std::vector<std::string> lines{
      fmt::format("method     {}, {} epochs over {:.1f} s", result.method, m.epochs, m.duration_s),
      fmt::format("GNSS       {} fixes used, {} rejected; innovation RMS north / east / down {}",
                  m.gnss.used, m.gnss.rejected, innovation_text(m.gnss))};
  for (const auto& [name, aid] : m.aids) {
    lines.push_back(fmt::format("aid        {}: {} used, {} rejected; mean NIS {:.2f}", name,
                                aid.used, aid.rejected, aid.mean_nis()));
  }
  for (const evaluation::CalibratedBlock& b : result.calibration) {
    lines.push_back(fmt::format("calibrated {} [{}]: {:.3g} +- {:.2g}", b.block.name, b.block.unit,
                                fmt::join(b.value, " "), fmt::join(b.sigma, " ")));
  }
  if (m.reference) {
    lines.push_back("reference  " + reference_text(*m.reference));
  } else if (m.reference_elsewhere_m) {
    lines.push_back(fmt::format("reference  of another place, {:.4g} km away (RMS); not compared",
                                *m.reference_elsewhere_m / 1000));
  }
  if (result.forward) lines.push_back("forward    " + forward_text(*result.forward));
  lines.push_back(fmt::format("resources  {:.1f} s wall, {:.1f} s CPU, {:.0f} MB",
                              result.resources.wall_s, result.resources.cpu_s,
                              result.resources.peak_rss_mb));
  return lines;
}

std::string verdict_line(const RunResult& result) {
  const Trust& trust = result.metrics.trust;
  std::vector<std::string> reasons = trust.reasons;
  if (trust.trustworthy && reasons.empty()) reasons = {size_text(result)};
  if (const std::optional<std::string> warning = against_reference(result)) {
    reasons.push_back("yet " + *warning);
  }
  return fmt::format("verdict    {} {}", trust.trustworthy ? "trustworthy;" : "NOT TRUSTWORTHY:",
                     fmt::join(reasons, "; "));
}

}  // namespace foucault::app
