#include "foucault/content/compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "foucault/core/time.h"
#include "foucault/plot/text.h"
#include "map_unit.h"
#include "method_look.h"
#include "run_data.h"
#include "run_panels.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

using Six = Eigen::Matrix<double, 6, 1>;  // north, east, down [m], roll, pitch, heading [deg]

/// Names of runs in the order of their looks.
std::vector<std::string> names_of_runs(const std::vector<ComparedRun>& runs) {
  std::vector<std::string> names;
  for (const ComparedRun& run : runs) names.push_back(run.name);
  return names;
}

/// By its method if no other run is of it, else by its place.
MethodLook look_of_run(const std::vector<ComparedRun>& runs, const ComparedRun& run) {
  const auto alike = std::count_if(runs.begin(), runs.end(), [&](const ComparedRun& other) {
    return other.method == run.method;
  });
  return look_of(alike == 1 ? run.method : run.name, names_of_runs(runs));
}

Six numbers_of(const ComparedEpoch& epoch, const StartPlane& plane) {
  const Eigen::Vector3d neu = plane.north_east_up(epoch.position);
  Six numbers;
  numbers << neu.x(), neu.y(), -neu.z(), epoch.roll_deg, epoch.pitch_deg, epoch.heading_deg;
  return numbers;
}

double half_circle(double degrees) { return std::remainder(degrees, 360.0); }

/// `to` minus `from`, angles within half a circle.
Six difference(const Six& to, const Six& from) {
  Six result = to - from;
  for (Eigen::Index i = 3; i < 6; ++i) result[i] = half_circle(result[i]);
  return result;
}

/// At a stamp, linear between the epochs on both sides.
std::optional<Six> numbers_at(const ComparedRun& run, const StartPlane& plane, int64_t t_ns) {
  constexpr double kLongest = 5;  // [s]
  const auto after =
      std::lower_bound(run.epochs.begin(), run.epochs.end(), t_ns,
                       [](const ComparedEpoch& epoch, int64_t t) { return epoch.t_ns < t; });
  if (after == run.epochs.end()) return std::nullopt;
  const Six right = numbers_of(*after, plane);
  if (after->t_ns == t_ns) return right;
  if (after == run.epochs.begin()) return std::nullopt;
  const ComparedEpoch& before = *(after - 1);
  const double step = seconds_between(before.t_ns, after->t_ns);
  if (step > kLongest) return std::nullopt;
  const Six left = numbers_of(before, plane);
  return left + seconds_between(before.t_ns, t_ns) / step * difference(right, left);
}

/// The differences of a run from the first one, at the epochs of the first.
struct Differences {
  std::string name;
  MethodLook look;
  Triad position, attitude;
};

Differences differences(const std::vector<ComparedRun>& runs, const ComparedRun& run,
                        const StartPlane& plane, int64_t start_ns) {
  Differences result;
  result.name = run.name;
  result.look = look_of_run(runs, run);
  for (const ComparedEpoch& epoch : runs.front().epochs) {
    const std::optional<Six> other = numbers_at(run, plane, epoch.t_ns);
    if (!other) continue;
    const Six d = difference(*other, numbers_of(epoch, plane));
    const double t = seconds_between(start_ns, epoch.t_ns);
    const Eigen::Vector3d sigma(epoch.sigma_north_m, epoch.sigma_east_m, epoch.sigma_down_m);
    result.position.add(t, d.head<3>(), sigma);
    result.attitude.add(t, d.tail<3>(), Eigen::Vector3d::Zero());
  }
  return result;
}

Series run_line(const std::string& name, const MethodLook& look, std::vector<double> x,
                std::vector<double> y, const std::string& column) {
  Series series = line(name, look.ink, std::move(x), std::move(y));
  series.dash = look.dash;
  series.size = look.dash == Dash::none ? 1.8 : 1.5;
  series.column = column + " " + name;
  return series;
}

Figure tracks_figure(const std::vector<ComparedRun>& runs, const StartPlane& plane,
                     int64_t start_ns) {
  Panel panel;
  panel.x = {"East of the first epoch", "m"};
  panel.y = {"North of the first epoch", "m"};
  panel.x.least_span = panel.y.least_span = 1;
  panel.equal_aspect = true;
  panel.scale_bar = true;
  for (const ComparedRun& run : runs) {
    DecimatedTable places(2);
    for (const ComparedEpoch& epoch : run.epochs) {
      const Six n = numbers_of(epoch, plane);
      places.add(seconds_between(start_ns, epoch.t_ns), {n[1], n[0]});
    }
    const DecimatedTable::Rows rows = places.rows();
    panel.series.push_back(
        run_line(run.name, look_of_run(runs, run), rows.columns[0], rows.columns[1], "north"));
    panel.series.back().time = rows.x;
  }
  choose_map_unit(panel);
  Figure figure{"compare_track",
                "Ground tracks",
                {},
                "The paths of the IMU. Where only one line is seen they lie on each other: the "
                "differences are in the next figures."};
  figure.height_mm = 190;
  figure.panels = {std::move(panel)};
  return figure;
}

/// A panel an axis with the differences of every run from the first.
Figure difference_figure(const std::vector<Differences>& all, Triad Differences::*triad,
                         const Names& axes, const std::string& unit, Figure figure) {
  figure.height_mm = 172;
  figure.share_x = true;
  for (size_t axis = 0; axis < 3; ++axis) {
    Panel panel;
    panel.x = time_axis();
    panel.y = {axes[axis], unit};
    panel.y.zero_centred = true;
    for (const Differences& each : all) {
      const DecimatedTable::Rows rows = (each.*triad).rows.rows();
      panel.series.push_back(run_line(each.name, each.look, rows.x, rows.columns[axis],
                                      std::string(axes[axis]) + " difference"));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure sigmas_figure(const std::vector<ComparedRun>& runs, int64_t start_ns) {
  Panel panel;
  panel.x = time_axis();
  panel.y = {"Horizontal sigma", "m", AxisKind::log};
  for (const ComparedRun& run : runs) {
    DecimatedTable sigmas(1);
    for (const ComparedEpoch& epoch : run.epochs) {
      sigmas.add(seconds_between(start_ns, epoch.t_ns),
                 {std::hypot(epoch.sigma_north_m, epoch.sigma_east_m)});
    }
    const DecimatedTable::Rows rows = sigmas.rows();
    panel.series.push_back(
        run_line(run.name, look_of_run(runs, run), rows.x, rows.columns[0], "sigma"));
  }
  Figure figure{"compare_sigma",
                "How sure each run is",
                {},
                "Root of the sum of the variances along north and east that each run gives itself. "
                "Differences far above the larger one contradict it."};
  figure.height_mm = 100;
  figure.panels = {std::move(panel)};
  return figure;
}

void add_difference_rows(const std::string& run, const Triad& triad, const Names& axes,
                         const std::string& unit, Table& table) {
  const AxisStatistics& s = triad.statistics;
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    table.rows.push_back({fmt::format("{}, {} ({})", run, axes[axis], unit),
                          significant_text(s.mean()[i]), significant_text(s.rms()[i]),
                          significant_text(s.quantile(0.5)[i]),
                          significant_text(s.quantile(0.95)[i]), significant_text(s.largest()[i])});
  }
}

constexpr Names kAngles{"Roll", "Pitch", "Heading"};

Table difference_table(const std::vector<Differences>& all, const std::string& first) {
  Table table;
  table.title = "Differences from " + first;
  table.header = {"", "Mean", "RMS", "Median", "95 %", "Maximum"};
  for (const Differences& each : all) {
    if (each.position.empty()) {
      table.rows.push_back({each.name + ": no common time", "–", "–", "–", "–", "–"});
      continue;
    }
    add_difference_rows(each.name, each.position, kNed, "m", table);
    add_difference_rows(each.name, each.attitude, kAngles, "°", table);
  }
  table.note = "At the epochs of the first run; median, 95 % and maximum are of magnitudes.";
  return table;
}

Table facts_table(const std::vector<ComparedRun>& runs) {
  Table table;
  table.title = "Runs";
  table.of_words = true;
  table.header = {""};
  for (const ComparedRun& run : runs) table.header.push_back(run.name);
  for (size_t i = 0; i < runs.front().facts.size(); ++i) {
    std::vector<std::string> row{runs.front().facts[i].first};
    for (const ComparedRun& run : runs) {
      row.push_back(i < run.facts.size() ? run.facts[i].second : "–");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

ReportPage compare_page(const std::vector<ComparedRun>& runs, const std::string& footer) {
  int64_t start_ns = runs.front().epochs.front().t_ns;
  for (const ComparedRun& run : runs) start_ns = std::min(start_ns, run.epochs.front().t_ns);
  const StartPlane plane(runs.front().epochs.front().position);
  std::vector<Differences> all;
  for (size_t i = 1; i < runs.size(); ++i) {
    all.push_back(differences(runs, runs[i], plane, start_ns));
  }
  ReportPage page;
  page.title = "Comparison";
  page.start_ns = start_ns;
  page.subtitle = joined(names_of_runs(runs), " · ") + " · start " + clock_text(start_ns);
  page.footer = footer;
  const std::string& first = runs.front().name;
  Section section{"Overview", {}, {facts_table(runs), difference_table(all, first)}};
  section.figures = {
      tracks_figure(runs, plane, start_ns),
      difference_figure(all, &Differences::position, kNed, "m",
                        {"compare_position",
                         "Differences of position from " + first,
                         {},
                         "The other runs minus the first one, at the epochs of the first."}),
      difference_figure(all, &Differences::attitude, kAngles, "°",
                        {"compare_attitude",
                         "Differences of attitude from " + first,
                         {},
                         "The other runs minus the first one, at the epochs of the first."}),
      sigmas_figure(runs, start_ns)};
  for (Figure& figure : section.figures) figure.subtitle = page.subtitle;
  page.sections = {std::move(section)};
  return page;
}

}  // namespace foucault::content
