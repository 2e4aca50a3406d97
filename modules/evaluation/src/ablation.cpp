#include "foucault/evaluation/ablation.h"

#include <fmt/format.h>

#include <algorithm>

namespace foucault::evaluation {
namespace {

/// Null if it has no outages.
const MethodOutages* outages_of(const std::vector<MethodOutages>& outages,
                                const std::string& label) {
  const auto found = std::find_if(outages.begin(), outages.end(), [&](const MethodOutages& o) {
    return o.method == label && !o.empty();
  });
  return found == outages.end() ? nullptr : &*found;
}

/// To the last bit: what is off was never used, as the wheels' speed of a vehicle without.
bool drifts_alike(const MethodOutages& a, const MethodOutages& b) {
  return a.horizontal_max() == b.horizontal_max() && a.vertical_max() == b.vertical_max();
}

std::string percentage(const std::optional<Estimate>& relative) {
  return relative ? fmt::format("{:+.1f}", 100 * relative->value) : "";
}

std::string percentages(const std::optional<Estimate>& relative) {
  return relative ? fmt::format("[{:+.1f}, {:+.1f}]", 100 * relative->low, 100 * relative->high)
                  : "";
}

}  // namespace

std::string AblationCase::label() const {
  return without.empty() ? method : fmt::format("{} without {}", method, without);
}

std::vector<AblationRow> ablation_rows(const std::vector<MethodOutages>& outages,
                                       const std::vector<AblationCase>& cases) {
  std::vector<AblationRow> rows;
  for (const AblationCase& what : cases) {
    const MethodOutages* of = outages_of(outages, what.label());
    if (!of) continue;
    const std::vector<double>&horizontal = of->horizontal_max(), &vertical = of->vertical_max();
    AblationRow row{what, root_mean_square(horizontal), root_mean_square(vertical), {}, {}};
    const MethodOutages* whole = outages_of(outages, what.method);
    if (whole && !what.without.empty()) {
      if (drifts_alike(*whole, *of)) continue;
      row.horizontal_relative = compare_paired(whole->horizontal_max(), horizontal).relative;
      row.vertical_relative = compare_paired(whole->vertical_max(), vertical).relative;
    }
    rows.push_back(row);
  }
  return rows;
}

TextTable ablation_table(const std::vector<AblationRow>& rows) {
  TextTable table{"RMS of the maximum drift with parts of the configuration off",
                  {"", "Hor [m]", "Ver [m]", "Hor [%]", "95 % interval", "Ver [%]"},
                  {}};
  for (const AblationRow& row : rows) {
    table.rows.push_back({row.what.label(), fmt::format("{:.3f}", row.horizontal_rms_m),
                          fmt::format("{:.3f}", row.vertical_rms_m),
                          percentage(row.horizontal_relative), percentages(row.horizontal_relative),
                          percentage(row.vertical_relative)});
  }
  return table;
}

std::vector<std::string> ablation_lines(const EvaluationSummary& summary,
                                        const std::vector<AblationCase>& cases) {
  std::vector<std::string> lines{"outages    " + outages_text(summary), ""};
  const TextTable table = ablation_table(ablation_rows(summary.overall(), cases));
  for (const std::string& line : text_lines(to_plain_text(table))) lines.push_back(line);
  return lines;
}

}  // namespace foucault::evaluation
