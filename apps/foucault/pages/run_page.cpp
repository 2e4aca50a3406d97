#include "pages/run_page.h"

#include <fmt/format.h>

#include <utility>

#include "foucault/core/units.h"
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

}  // namespace

page::Banner verdict_banner(const RunResult& result) {
  const Trust& trust = result.metrics.trust;
  if (!trust.trustworthy) return {true, "This run cannot be believed", trust.reasons};
  std::vector<std::string> lines = trust.reasons;
  if (lines.empty()) lines.push_back(size_text(result));
  return {false, "This run is trustworthy", lines};
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
  return tables;
}

}  // namespace foucault::app
