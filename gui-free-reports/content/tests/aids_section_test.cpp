#include "aids_section.h"

#include <gtest/gtest.h>

#include "demo_run.h"
#include "foucault/core/so3.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

constexpr Band kBand{0.0506, 7.378};  // of chi-square with two degrees

state::Epoch epoch_at(int i) {
  state::Epoch epoch = state::with_slow_blocks({}, {});
  epoch.t_ns = nanoseconds(i);
  return epoch;
}

ReportPage page_of(const state::Told& told, bool with_aids) {
  RunReport report(kLabels, state::Mounting{}, told);
  for (int i = 0; i < 100; ++i) {
    state::Epoch epoch = state::with_slow_blocks({}, told.layout);
    epoch.t_ns = nanoseconds(i);
    epoch.q_n_b = so3::from_euler({0, 0, 1.0});
    epoch.velocity_n = epoch.q_n_b * Eigen::Vector3d(10, 0.5, 0);
    if (told.layout.slow_size() == 2) epoch.slow << 0, -0.05;
    report.epoch(epoch);
    if (!with_aids) continue;
    report.observation({epoch.t_ns, "nonholonomic", 2, i % 10 == 0 ? 30.0 : 1.5, i % 10 != 0});
  }
  if (with_aids) report.aid({"nonholonomic", 2, 90, 10, 1.5, kBand});
  return report.page();
}

TEST(AidsSection, UsedAndRejectedOverTheDimension) {
  const ReportPage page = page_of({}, true);
  const Panel& panel = figure_of(page, "aid_innovations").panels.at(0);
  EXPECT_EQ(panel.title, "Nonholonomic");
  EXPECT_EQ(panel.y.label, "NIS / 2");
  EXPECT_EQ(panel.note, "mean 0.750 · 90 used, 10 rejected");
  EXPECT_EQ(series_of(panel, "used").y, std::vector<double>(90, 0.75));
  EXPECT_EQ(series_of(panel, "rejected").y, std::vector<double>(10, 15.0));
  EXPECT_DOUBLE_EQ(series_of(panel, "95 % for one measurement").y[0], kBand.low / 2);
  EXPECT_EQ(section_of(page, "Aids").tables.at(0).rows.at(0),
            (std::vector<std::string>{"Nonholonomic", "90", "10", "2", "0.750"}));
}

/// Where all are far below their bounds, too: a panel of arrowheads tells nothing.
TEST(AidsSection, TheAxisShowsWhatThereIs) {
  RunReport report(kLabels, state::Mounting{});
  for (int i = 0; i < 100; ++i) {
    report.epoch(epoch_at(i));
    report.observation({nanoseconds(i), "zero_velocity", 3, 0.003, true});
  }
  report.aid({"zero_velocity", 3, 100, 0, 0.003, {0.216, 9.35}});
  const Panel panel = figure_of(report.page(), "aid_innovations").panels.at(0);
  EXPECT_LE(*panel.y.min, 0.001);
}

TEST(AidsSection, VelocityIsAlongTheEstimatedAxes) {
  const auto right = [](const state::Told& told) {
    const Figure figure = figure_of(page_of(told, true), "vehicle_velocity");
    return series_of(figure.panels.at(1), "estimate").y.back();
  };
  EXPECT_NEAR(right({}), 0.5, 1e-12);
  state::Told told;
  told.layout.add(state::block::mounting, 0.2);
  EXPECT_NEAR(right(told), 0.5 * std::cos(0.05) - 10 * std::sin(0.05), 1e-12);
}

TEST(AidsSection, NoneWithoutAids) {
  const ReportPage page = page_of({}, false);
  EXPECT_EQ(find_figure(page, "aid_innovations"), nullptr);
  EXPECT_THROW(section_of(page, "Aids"), std::runtime_error);
}

}  // namespace
}  // namespace foucault::content
