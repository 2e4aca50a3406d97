#include "pages/run_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "foucault/core/fix_quality.h"
#include "foucault/core/time.h"
#include "foucault/core/units.h"
#include "foucault/state/told_blocks.h"
#include "texts/run_text.h"

namespace foucault::app {
namespace {

std::string percent(double fraction) { return fmt::format("{:.1f} %", 100 * fraction); }

std::string degrees_or_dash(const std::optional<double>& angle) {
  return angle ? fmt::format("{:.4f} deg", *angle * units::kDegrees) : "-";
}

page::Table gnss_table(const evaluation::GnssMetrics& gnss) {
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

page::Table reference_table(const evaluation::ReferenceMetrics& r) {
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

// ---- what a surveyor reads first

std::string moment_text(const std::optional<int64_t>& t_ns) {
  return t_ns ? clock_text(*t_ns) : "-";
}

std::string level_text(const Level& level, double factor, int decimals, const char* unit) {
  if (level.empty()) return "-";
  return fmt::format("mean {:.{}f}{}, largest {:.{}f}{}", level.mean() * factor, decimals, unit,
                     level.largest() * factor, decimals, unit);
}

std::string fix_types_text(const RunFacts& facts) {
  int64_t sum = 0;
  for (const auto& [quality, count] : facts.fixes) sum += count;
  std::vector<std::string> parts;
  for (auto it = facts.fixes.rbegin(); it != facts.fixes.rend(); ++it) {
    const double share = static_cast<double>(it->second) / static_cast<double>(sum);
    parts.push_back(fmt::format("{} {}", words_of(it->first), percent(share)));
  }
  return parts.empty() ? "-" : fmt::format("{}", fmt::join(parts, ", "));
}

const evaluation::CalibratedBlock* find_block(
    const std::vector<evaluation::CalibratedBlock>& blocks, std::string_view name) {
  for (const evaluation::CalibratedBlock& block : blocks) {
    if (block.block.name == name) return &block;
  }
  return nullptr;
}

/// Of what hardly came from the recording, so.
std::string estimated_arm_text(const evaluation::CalibratedBlock& found,
                               const evaluation::CalibratedBlock& told) {
  constexpr std::array<const char*, 3> kAxes{"forward", "right", "down"};
  std::vector<std::string> parts;
  for (size_t i = 0; i < kAxes.size(); ++i) {
    const bool tells = found.sigma[i] <= state::kLeftWhereTold * told.sigma[i];
    parts.push_back(fmt::format("{} {:.3f} ± {:.3f} m{}", kAxes[i], found.value[i], found.sigma[i],
                                tells ? "" : " (hardly told by the recording)"));
  }
  return fmt::format("estimated: {}", fmt::join(parts, ", "));
}

std::string lever_arm_text(const RunResult& result) {
  const evaluation::CalibratedBlock* found = find_block(result.calibration, "lever_arm");
  const evaluation::CalibratedBlock* told = find_block(result.told, "lever_arm");
  if (found && told) return estimated_arm_text(*found, *told);
  if (!result.facts.lever_arm_b) return "-";
  if (!result.facts.lever_arm_known) return "not known, zero was taken";
  const Eigen::Vector3d& arm = *result.facts.lever_arm_b;
  return fmt::format("as recorded: {:.3f}, {:.3f}, {:.3f} m along the axes of the IMU", arm.x(),
                     arm.y(), arm.z());
}

std::string smoothing_text(const RunResult& result) {
  if (result.forward) {
    return fmt::format("{} forward; {}", result.forward->method,
                       separation_text(result.forward->separation));
  }
  return fmt::format("none: {} runs forward only; batch and rts smooth", result.method);
}

std::string warnings_text(const RunFacts& facts) {
  const auto news = [](const state::Notice& n) { return n.kind != state::NoticeKind::aligned; };
  const auto count = std::count_if(facts.notices.begin(), facts.notices.end(), news);
  const int64_t more = facts.notices_seen - static_cast<int64_t>(facts.notices.size());
  if (count + more == 0) return "none";
  const auto is_gap = [](const state::Notice& n) { return n.kind == state::NoticeKind::imu_gap; };
  const auto gaps = std::count_if(facts.notices.begin(), facts.notices.end(), is_gap);
  const std::string holes =
      gaps > 0 ? fmt::format(" ({} of holes of the IMU)", gaps) : std::string();
  return fmt::format("{}{}, listed under Timeline", count + more, holes);
}

/// Reasons tell times from the first epoch, figures from the first stamp of the recording.
std::string reasons_clock(const RunResult& result) {
  const RunFacts& f = result.facts;
  if (!f.begin_ns || !f.recording_begin_ns) return {};
  const double later = seconds_between(*f.recording_begin_ns, *f.begin_ns);
  if (later < 0.5) return {};
  return fmt::format(
      "Times here count from the start of the solution; in the figures, {:.1f} s more.", later);
}

page::Table summary_table(const RunResult& result) {
  const RunFacts& f = result.facts;
  const double moving = f.moving_s > 0 ? f.distance_m / f.moving_s : 0;
  page::Table table;
  table.title = "Run";
  table.of_words = true;
  table.rows = {
      {"Start of the solution", moment_text(f.begin_ns)},
      {"End", moment_text(f.end_ns)},
      {"Duration, distance",
       fmt::format("{:.1f} s, {:.1f} m", result.metrics.duration_s, f.distance_m)},
      {"Speed", fmt::format("mean {:.2f} m/s while moving ({:.0f} s), largest {:.2f} m/s", moving,
                            f.moving_s, f.speed_m_s.largest())},
      {"Fix types", fix_types_text(f)},
      {"Fixes",
       fmt::format("{} used, {} rejected", result.metrics.gnss.used, result.metrics.gnss.rejected)},
      {"Sigma, horizontal (2D)", level_text(f.horizontal_sigma_m, 1, 4, " m")},
      {"Sigma, vertical", level_text(f.vertical_sigma_m, 1, 4, " m")},
      {"Sigma, roll and pitch", level_text(f.tilt_sigma_rad, units::kDegrees, 4, "°")},
      {"Sigma, heading", level_text(f.heading_sigma_rad, units::kDegrees, 4, "°")},
      {"Smoothed against forward", smoothing_text(result)},
      {"Noise taken", result.noise},
      {"Lever arm, IMU to antenna", lever_arm_text(result)},
      {"Frame, height", "of the receiver, taken as WGS-84; heights above its ellipsoid"},
      {"Warnings", warnings_text(f)},
  };
  return table;
}

}  // namespace

page::Banner verdict_banner(const RunResult& result) {
  const Trust& trust = result.metrics.trust;
  page::Banner banner{!trust.trustworthy, "This run is trustworthy", trust.reasons};
  if (!trust.trustworthy) {
    banner.title = "This run cannot be believed";
  } else if (!trust.reasons.empty()) {
    banner.title += ", with reservations";
  } else {
    banner.lines = {size_text(result)};
  }
  const std::string clock = reasons_clock(result);
  if (!trust.reasons.empty() && !clock.empty()) banner.lines.push_back(clock);
  if (const std::optional<std::string> reference = against_reference(result)) {
    banner.lines.push_back("This is judged from the fixes: " + *reference);
  }
  return banner;
}

std::vector<page::KeyNumber> key_numbers(const RunResult& result) {
  const evaluation::RunMetrics& m = result.metrics;
  std::vector<page::KeyNumber> numbers;
  if (m.reference) {
    numbers.push_back({"Horizontal error, RMS", fmt::format("{:.3f}", m.reference->horizontal_rmse),
                       "m", "against the reference"});
    numbers.push_back({"Vertical error, RMS", fmt::format("{:.3f}", m.reference->vertical_rmse),
                       "m", "against the reference"});
  }
  if (m.gnss.samples > 0) {
    const double horizontal = m.gnss.innovation_rms_n.head<2>().norm();
    numbers.push_back({"Innovation, horizontal RMS", fmt::format("{:.4f}", horizontal), "m",
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
  std::vector<page::Table> tables{summary_table(result)};
  if (result.metrics.reference) tables.push_back(reference_table(*result.metrics.reference));
  if (result.metrics.gnss.samples > 0) tables.push_back(gnss_table(result.metrics.gnss));
  return tables;
}

}  // namespace foucault::app
