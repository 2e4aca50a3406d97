#include "foucault/content/run_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "demo_run.h"
#include "foucault/plot/figure_store.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

std::set<std::string> figure_names(const ReportPage& page) {
  std::set<std::string> names;
  for (const Section& section : page.sections) {
    for (const Figure& figure : section.figures) names.insert(figure.name);
  }
  return names;
}

TEST(RunReport, ShowsEverythingThatWasGiven) {
  const ReportPage page = demo_page({120, true, false});
  EXPECT_EQ(figure_names(page),
            (std::set<std::string>{
                "ground_track", "position", "velocity", "attitude", "uncertainty", "position_error",
                "velocity_error", "attitude_error", "gyro_bias", "accel_bias", "gnss_innovations",
                "gnss_residuals", "data_health", "timeline", "nis", "innovation_whiteness", "nees",
                "vehicle_velocity", "speed_height"}));
  EXPECT_EQ(page.key_numbers.size(), 4U);
  EXPECT_EQ(page.listings.size(), 2U) << "command and configuration";
  EXPECT_NE(page.subtitle.find("trip.rawlog"), std::string::npos);
  EXPECT_NE(page.subtitle.find("2025-07-08T19:34:17.999Z"), std::string::npos) << page.subtitle;
}

TEST(RunReport, ShowsNoErrorsWithoutReference) {
  const std::set<std::string> names = figure_names(demo_page({60, false, false}));
  EXPECT_EQ(names.count("nees"), 0U);
  EXPECT_EQ(names.count("nis"), 1U);
  EXPECT_EQ(names.count("position_error"), 0U);
  EXPECT_EQ(names.count("position"), 1U);
}

TEST(RunReport, EmptyRunHasAPage) {
  const RunReport report(kLabels, state::Mounting{});
  EXPECT_TRUE(figure_names(report.page()).empty());
  EXPECT_EQ(report.page().title, "Navigation report");
}

TEST(RunReport, FixesAreColouredByTypeAndRejectedOnesMarked) {
  const ReportPage page = demo_page({500, false, false});
  const Panel& track = figure_of(page, "ground_track").panels.at(0);
  const Series& fixes = series_of(track, "fix");
  std::set<std::string> types;
  for (const double category : fixes.category) {
    types.insert(fixes.categories.at(static_cast<size_t>(category)).label);
  }
  EXPECT_EQ(types, (std::set<std::string>{"RTK fixed", "RTK float"}));
  EXPECT_EQ(series_of(track, "rejected fix").x.size(), 39U);
  EXPECT_TRUE(track.equal_aspect);

  const Panel& innovation = figure_of(page, "gnss_innovations").panels.at(0);
  EXPECT_EQ(series_of(innovation, "rejected").x.size(), 39U);
  EXPECT_EQ(series_of(innovation, "rejected").range_role, RangeRole::none);
}

TEST(RunReport, BoundsAreThreeSigma) {
  const ReportPage page = demo_page({60, true, false});
  const Panel& north = figure_of(page, "position_error").panels.at(0);
  const Series& band = series_of(north, "±3σ");
  const double sigma_at_start = 0.012 + 0.5;  // as the demo makes it
  EXPECT_NEAR(band.upper.front(), 3 * sigma_at_start, 1e-12);
  EXPECT_NEAR(band.lower.front(), -3 * sigma_at_start, 1e-12);
}

TEST(RunReport, SmoothedAgainstForwardIsDrawnWithWhatItMayChange) {
  RunReport report(kLabels, state::Mounting{});
  for (int t = 0; t < 3; ++t) {
    state::Separation separation;
    separation.t_ns = nanoseconds(t);
    separation.position_n = {0.3, 0, -0.1};
    separation.position_sigma = {0.2, 0.1, 0.1};
    separation.euler.z() = 0.01;
    report.separation(separation);
  }
  const ReportPage page = report.page();
  const Panel& north = figure_of(page, "position_separation").panels.at(0);
  EXPECT_NEAR(series_of(north, "±3σ").upper.front(), 0.6, 1e-12);
  const Section& section = section_of(page, "Smoothed against forward");
  EXPECT_EQ(section.figures.size(), 3U);
  EXPECT_EQ(section.tables.at(0).rows.at(0).at(2), "0.300") << "RMS along north";
  EXPECT_EQ(section.tables.at(2).rows.at(2).at(2), "0.573") << "of the heading, in degrees";
  // Sigmas of the attitude and the velocity are zero here; those of the position hold it.
  ASSERT_EQ(section.paragraphs.size(), 1U);
  EXPECT_NE(section.paragraphs[0].find("attitude, Heading (0 %)"), std::string::npos);
  EXPECT_EQ(section.paragraphs[0].find("position"), std::string::npos) << section.paragraphs[0];
}

TEST(RunReport, PositionIsInMetresFromTheStart) {
  RunReport report(kLabels, state::Mounting{});
  state::Epoch epoch;
  epoch.position = {0.7, 0.1, 100};
  report.epoch(epoch);
  epoch.t_ns += nanoseconds(1);
  epoch.position = {0.7 + 1e-4, 0.1 + 1e-4, 120};
  report.epoch(epoch);
  const Figure figure = figure_of(report.page(), "position");
  // WGS-84 at 0.7 rad: meridian radius 6 361 991 m, transverse radius 6 387 016 m, computed apart.
  EXPECT_NEAR(series_of(figure.panels[0], "estimate").y.back(), 636.209, 0.01);
  EXPECT_NEAR(series_of(figure.panels[1], "estimate").y.back(), 488.48, 0.05);
  EXPECT_NEAR(series_of(figure.panels[2], "estimate").y.back(), 20, 1e-9);
}

TEST(RunReport, HeadingIsTheVehiclesAndIsBrokenAtNorth) {
  state::Mounting mounting;
  mounting.q_v_b = so3::from_euler({0, 0, 0.5});
  RunReport report(kLabels, mounting);
  for (int i = 0; i < 100; ++i) {
    state::Epoch epoch;
    epoch.t_ns = nanoseconds(i);
    const Eigen::Quaterniond q_n_v = so3::from_euler({0.1, 0.05, 6.0 + 0.1 * i});
    epoch.q_n_b = q_n_v * mounting.q_v_b;
    report.epoch(epoch);
  }
  const Figure figure = figure_of(report.page(), "attitude");
  const Series heading = series_of(figure.panels[2], "estimate");
  // 6.0 to 15.9 rad pass north twice, each time by 360, a gap, and 0.
  EXPECT_EQ(heading.y.size(), 100U + 2 * 3);
  EXPECT_NEAR(heading.y[0], 6.0 * 180 / M_PI, 1e-9);
  EXPECT_EQ(heading.y[3], 360);
  EXPECT_TRUE(std::isnan(heading.y[4]));
  EXPECT_EQ(heading.y[5], 0);
  EXPECT_NEAR(heading.x[5], (2 * M_PI - 6.0) / 0.1, 1e-9);
  EXPECT_NEAR(heading.y[6], 6.3 * 180 / M_PI - 360, 1e-9);
  EXPECT_EQ(figure.panels[2].y.max, 360);
  EXPECT_NEAR(series_of(figure.panels[0], "estimate").y[50], 0.1 * 180 / M_PI, 1e-9);
}

/// A roll that passes half a turn is drawn over a whole one; one that does not, as large as it is.
TEST(RunReport, RollHasTheAxisItNeeds) {
  const auto roll_axis = [](double turns) {
    RunReport report(kLabels, state::Mounting{});
    for (int i = 0; i < 200; ++i) {
      state::Epoch epoch;
      epoch.t_ns = nanoseconds(0.1 * i);
      epoch.q_n_b = so3::from_euler({2 * M_PI * turns * std::sin(0.1 * i), 0, 1});
      report.epoch(epoch);
    }
    return figure_of(report.page(), "attitude").panels.at(0).y;
  };
  const Axis rolling = roll_axis(0.6);
  EXPECT_EQ(rolling.kind, AxisKind::bearing);
  EXPECT_EQ(*rolling.min, -180);
  EXPECT_EQ(*rolling.max, 180);
  const Axis leaning = roll_axis(0.1);
  EXPECT_EQ(leaning.kind, AxisKind::linear);
  EXPECT_FALSE(leaning.max);
}

/// Sigmas that jump from epoch to epoch, as between standstills, are not a block of ink.
TEST(RunReport, OfSigmasThatJumpTheLargestOfASecondIsDrawn) {
  const auto drawn = [](double step) {
    RunReport report(kLabels, state::Mounting{});
    for (int i = 0; i < 100; ++i) {
      state::Epoch epoch;
      epoch.t_ns = nanoseconds(step * i);
      epoch.covariance.diagonal().setConstant(i % 5 == 0 ? 4e-4 : 0.04);
      report.epoch(epoch);
    }
    const Figure figure = figure_of(report.page(), "uncertainty");
    const bool says = figure.caption.find("largest of every 1.0 s") != std::string::npos;
    return std::pair(figure.panels.at(1).series.at(0).y, says);
  };
  const auto [close, says_of_close] = drawn(0.2);
  EXPECT_EQ(close, std::vector<double>(20, 0.2));
  EXPECT_TRUE(says_of_close);
  const auto [apart, says_of_apart] = drawn(1);
  EXPECT_EQ(apart.size(), 100u);
  EXPECT_FALSE(says_of_apart);
}

TEST(RunReport, BiasesHaveUnitsOfDataSheets) {
  RunReport report(kLabels, state::Mounting{});
  state::Epoch epoch;
  epoch.bias.gyro.x() = 1.0 / 206264.80624709636;  // 1 deg/h in rad/s
  epoch.bias.accel.z() = 1e-5;                     // 1 mGal
  report.epoch(epoch);
  const ReportPage page = report.page();
  EXPECT_NEAR(series_of(figure_of(page, "gyro_bias").panels[0], "estimate").y[0], 1, 1e-9);
  EXPECT_EQ(figure_of(page, "gyro_bias").panels[0].y.unit, "°/h");
  EXPECT_NEAR(series_of(figure_of(page, "accel_bias").panels[2], "estimate").y[0], 1, 1e-9);
  EXPECT_EQ(figure_of(page, "accel_bias").panels[2].y.unit, "mGal");
}

TEST(RunReport, GapsAreShadedAndNotJoined) {
  const ReportPage page = demo_page({600, false, true});
  std::set<std::string> shades;
  for (const Shade& shade : figure_of(page, "position").panels[0].shades) {
    shades.insert(shade.label);
  }
  EXPECT_EQ(shades, (std::set<std::string>{"GNSS withheld", "no usable GNSS", "IMU gap"}));

  RunReport report(kLabels, state::Mounting{});
  for (const int t : {0, 1, 2, 3, 4, 30, 31, 32}) {
    state::Epoch epoch;
    epoch.t_ns = nanoseconds(t);
    report.epoch(epoch);
  }
  const Figure velocity = figure_of(report.page(), "velocity");
  const std::vector<double>& y = series_of(velocity.panels[0], "estimate").y;
  EXPECT_EQ(y.size(), 9U);
  EXPECT_TRUE(std::isnan(y[5]));
}

TEST(RunReport, BandsTooNarrowToBeSeenAreNumbers) {
  RunReport report(kLabels, state::Mounting{});
  for (int t = 0; t < 100; ++t) {
    state::Epoch epoch;
    epoch.t_ns = nanoseconds(t);
    epoch.position.height = 10.0 * t;
    epoch.covariance.diagonal().setConstant(1e-4);
    report.epoch(epoch);
  }
  const Figure figure = figure_of(report.page(), "position");
  EXPECT_EQ(figure.panels[2].note, "3σ: median 0.030 m, largest 0.030 m");
  EXPECT_FALSE(figure.panels[2].series[0].in_legend);
  EXPECT_TRUE(figure.panels[0].series[0].in_legend) << "it fills the axis of a metre";
}

TEST(RunReport, FiguresOverTimeShareTheTimeOfTheRun) {
  const ReportPage page = demo_page({120, true, true});
  std::set<double> begins, ends;
  for (const Section& section : page.sections) {
    for (const Figure& figure : section.figures) {
      for (const Panel& panel : figure.panels) {
        if (panel.x.kind != AxisKind::duration) continue;
        begins.insert(panel.x.min.value());
        ends.insert(panel.x.max.value());
      }
    }
  }
  EXPECT_EQ(begins.size(), 1U);
  EXPECT_EQ(ends.size(), 1U);
}

TEST(RunReport, SaysWhatIsNotShownAndWhy) {
  const ReportPage page = demo_page({60, false, false});
  const Table& table = section_of(page, "Not shown").tables.at(0);
  const auto names = [&](const std::string& what) {
    return std::any_of(table.rows.begin(), table.rows.end(),
                       [&](const auto& row) { return row.at(0) == what; });
  };
  EXPECT_TRUE(names("Errors of position, velocity, attitude"));
  EXPECT_TRUE(names("Smoothed against forward"));
  EXPECT_FALSE(names("Innovations"));
  EXPECT_FALSE(find_figure(page, "raw_imu")) << "the demo hands over stamps alone";
  EXPECT_TRUE(names("IMU as recorded"));
}

TEST(RunReport, RawSamplesAndWhatTheReceiverSaysAreShown) {
  RunReport report(kLabels, state::Mounting{});
  GnssFix fix;
  fix.position_covariance = Eigen::Matrix3d::Identity() * 0.04;
  fix.details.satellites = 12;
  report.measurement(fix);
  ImuIncrement increment;
  increment.dvel_b = Eigen::Vector3d(0, 0, -0.0981);
  for (int i = 1; i <= 2000; ++i) {
    increment.t_begin_ns = increment.t_end_ns;
    increment.t_end_ns = nanoseconds(0.01 * i);
    report.measurement(increment);
  }
  const ReportPage page = report.page();
  EXPECT_NEAR(figure_of(page, "raw_imu").panels.at(5).series[0].y[7], -9.81, 1e-6);
  EXPECT_EQ(figure_of(page, "imu_spectrum").panels.size(), 2U);
  const Figure& receiver = figure_of(page, "receiver");
  ASSERT_EQ(receiver.panels.size(), 2U) << "no HDOP, no age";
  EXPECT_NEAR(receiver.panels[0].series[0].y[0], 0.2, 1e-12);
  EXPECT_EQ(receiver.panels[1].series[0].y[0], 12);
}

std::string reason_not_shown(const ReportPage& page, const std::string& what) {
  for (const std::vector<std::string>& row : section_of(page, "Not shown").tables.at(0).rows) {
    if (row.at(0) == what) return row.at(1);
  }
  return {};
}

TEST(RunReport, TheSolverIsShownWhereItSolvesForEachEpoch) {
  constexpr const char* kWhat = "Time and iterations of the solver, an epoch";
  RunReport report(kLabels, state::Mounting{});
  state::Epoch epoch;
  report.epoch(epoch);
  EXPECT_EQ(reason_not_shown(report.page(), kWhat), "the method does not iterate");

  report.solve({nanoseconds(1), 1617, 4, 0.2});
  const ReportPage whole = report.page();
  EXPECT_NE(reason_not_shown(whole, kWhat).find("at once"), std::string::npos);
  const Table& once = section_of(whole, "Processing").tables.at(0);
  EXPECT_EQ(once.rows.at(0), (std::vector<std::string>{"Nodes", "1617", "1617", ""}));
  EXPECT_EQ(once.rows.at(1).at(1), "4.00");

  for (int t = 2; t < 60; ++t) report.solve({nanoseconds(t), 20, t == 30 ? 8 : 1, 0.001});
  EXPECT_TRUE(reason_not_shown(report.page(), kWhat).empty());
  const Figure solver = figure_of(report.page(), "solver");
  const std::vector<double>& iterations = solver.panels[0].series[0].y;
  EXPECT_EQ(*std::max_element(iterations.begin(), iterations.end()), 8);
  EXPECT_NEAR(solver.panels[1].series[0].y.back(), 1, 1e-9) << "ms";
}

TEST(RunReport, TheTimeOfStagesIsShown) {
  RunReport report(kLabels, state::Mounting{});
  report.stages({{Stage::read, 0.25, 1}, {Stage::solve, 0.75, 1}});
  const ReportPage page = report.page();
  const Table& table = section_of(page, "Processing").tables.at(0);
  EXPECT_EQ(table.rows.at(1), (std::vector<std::string>{"solve", "0.750 s", "75.0 %"}));
}

TEST(RunReport, GapsOfSamplesThatWereLeftOutCount) {
  RunReport report(kLabels, state::Mounting{});
  for (int i = 0; i < 2000; ++i) report.imu_stamp(nanoseconds(0.01 * i));
  report.notice(
      {nanoseconds(12), state::NoticeKind::imu_gap, "no IMU data for 1.500 s up to then; bridged"});
  const ReportPage page = report.page();
  const std::vector<std::string>& row = section_of(page, "Data health").tables.at(0).rows.at(0);
  EXPECT_EQ(row.at(4), "1");
  EXPECT_EQ(row.at(5), "1.50 s");
  EXPECT_NE(figure_of(page, "data_health").panels.at(0).note.find("longest 1.50 s · 1 gap of "),
            std::string::npos)
      << "as the table says";
  EXPECT_NE(section_of(page, "Timeline").paragraphs.at(0).find("1.50 s without IMU in 1 hole"),
            std::string::npos);
}

TEST(RunReport, IntervalsThatAreAllAlikeAreOneNarrowColumn) {
  RunReport report(kLabels, state::Mounting{});
  for (int i = 1; i < 100; ++i) {
    ImuIncrement increment;
    increment.t_begin_ns = nanoseconds(0.01 * (i - 1));
    increment.t_end_ns = nanoseconds(0.01 * i);
    report.measurement(increment);
  }
  const Panel panel = figure_of(report.page(), "imu_intervals").panels.at(0);
  EXPECT_NEAR(*panel.x.max / *panel.x.min, 2, 1e-9);
  EXPECT_NEAR(std::sqrt(*panel.x.max * *panel.x.min), 10, 0.2) << "in the middle";
}

/// Stretches, not a stroke a fix: fixes a second apart are no gaps.
TEST(RunReport, FixTypesAreBarsWhereNoneIsMissing) {
  RunReport report(kLabels, state::Mounting{});
  for (int i = 0; i < 300; ++i) {
    state::FixResult fix;
    fix.t_ns = nanoseconds(i);
    fix.quality = i < 200 ? FixQuality::fixed_rtk : FixQuality::single;
    if (i == 50) fix.verdict = state::FixVerdict::gated;
    report.fix(fix);
  }
  const Panel types = figure_of(report.page(), "data_health").panels.back();
  EXPECT_EQ(types.y.categories,
            (std::vector<std::string>{"rejected", "single point", "RTK fixed"}));
  ASSERT_EQ(types.series.size(), 3U);
  EXPECT_EQ(types.series[0].x.at(0), 50) << "a stroke, too short for a bar";
  EXPECT_EQ(types.series[1].x.size(), 3U) << "one bar and the break behind it";
  EXPECT_EQ(types.series[1].x.at(0), 200);
  EXPECT_EQ(types.series[1].x.at(1), 299);
}

/// A separation is read from its line; bounds of a forward run that did not yet know are cut, and
/// said.
TEST(RunReport, WideBoundsLeaveTheSeparationRoom) {
  RunReport report(kLabels, state::Mounting{});
  for (int t = 0; t < 100; ++t) {
    state::Separation separation;
    separation.t_ns = nanoseconds(t);
    separation.velocity_n.x() = 0.1 * std::sin(t);
    separation.velocity_sigma.setConstant(t < 50 ? 5 : 0.05);
    report.separation(separation);
  }
  const Figure figure = figure_of(report.page(), "velocity_separation");
  EXPECT_NEAR(*figure.panels[0].y.max, 0.4, 1e-3);
  EXPECT_NE(figure.panels[0].note.find("largest 15 m/s"), std::string::npos)
      << figure.panels[0].note;
  EXPECT_NE(figure.caption.find("are cut"), std::string::npos);
}

TEST(RunReport, StatisticsLeaveOutTheSettlingTime) {
  RunReport report(kLabels, state::Mounting{});
  report.start(0);
  report.start_statistics(nanoseconds(50));
  for (int t = 0; t < 100; ++t) {
    state::Epoch epoch;
    epoch.t_ns = nanoseconds(t);
    report.epoch(epoch);
    state::ReferenceError error;
    error.t_ns = epoch.t_ns;
    error.position_n = Eigen::Vector3d::Constant(t < 50 ? 10 : 0.02);
    report.reference_error(epoch, error);
  }
  const std::string note = figure_of(report.page(), "position_error").panels[0].note;
  EXPECT_NE(note.find("RMS 0.0200 m"), std::string::npos) << note;
  EXPECT_NE(note.find("from 50.0 s on"), std::string::npos) << note;
}

TEST(RunReport, LongRunsTakeBoundedRoom) {
  RunReport report(kLabels, state::Mounting{});
  for (int i = 0; i < 60000; ++i) {
    state::Epoch epoch;
    epoch.t_ns = nanoseconds(0.1 * i);
    epoch.velocity_n.x() = i == 45678 ? 99 : std::sin(0.01 * i);
    report.epoch(epoch);
  }
  const Figure velocity = figure_of(report.page(), "velocity");
  const std::vector<double>& north = series_of(velocity.panels[0], "estimate").y;
  EXPECT_LE(north.size(), 6000U);
  EXPECT_EQ(*std::max_element(north.begin(), north.end()), 99) << "no peak is lost";
}

TEST(RunReport, SurvivesNumbersThatAreNotFinite) {
  RunReport report(kLabels, state::Mounting{});
  for (int t = 0; t < 20; ++t) {
    state::Epoch epoch;
    epoch.t_ns = nanoseconds(t);
    if (t == 10) {
      epoch.velocity_n.setConstant(std::numeric_limits<double>::quiet_NaN());
      epoch.covariance.setConstant(std::numeric_limits<double>::infinity());
    }
    report.epoch(epoch);
  }
  const ReportPage page = report.page();
  Renderer renderer;
  for (const Section& section : page.sections) {
    for (const Figure& figure : section.figures) {
      EXPECT_GT(renderer.png(from_text(to_text(figure), figure.name)).size(), 1000U);
    }
  }
}

TEST(RunReport, WritesAWholeFolderThatRedrawsToTheSameBytes) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(::testing::TempDir()) / "foucault_run_report_test";
  fs::remove_all(folder);
  RunReport report(kLabels, state::Mounting{});
  fill_demo({}, report);
  report.write(folder);
  const auto content = [&](const char* name) {
    std::ifstream file(folder / name, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  };
  const std::string html = content("index.html");
  EXPECT_EQ(html.find("://"), std::string::npos);
  EXPECT_NE(html.find("Figure 17."), std::string::npos);
  const std::string header = content("position_error.csv").substr(0, 200);
  EXPECT_EQ(header.rfind("time_since_start_s,north_error_3_sigma_lower_m,"
                         "north_error_3_sigma_upper_m,north_error_m,",
                         0),
            0U)
      << header;
  const std::string png = content("position_error.png");
  redraw_report(folder);
  EXPECT_EQ(content("position_error.png"), png);
  EXPECT_EQ(content("index.html"), html);
  if (std::getenv("FOUCAULT_KEEP_REPORT") == nullptr) fs::remove_all(folder);
}

}  // namespace
}  // namespace foucault::content
