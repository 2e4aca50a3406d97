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

const RunLabels kLabels{"trip.rawlog", "refined", "foucault 0.1.0",
                        "foucault run trip.rawlog --out trip", "imu:\n  preset: ADIS16465\n"};

ReportPage demo_page(const DemoRun& run) {
  RunReport report(kLabels, Mounting{});
  fill_demo(run, report);
  return report.page();
}

const Figure* find_figure(const ReportPage& page, const std::string& name) {
  for (const Section& section : page.sections) {
    for (const Figure& figure : section.figures) {
      if (figure.name == name) return &figure;
    }
  }
  return nullptr;
}

const Figure& figure_of(const ReportPage& page, const std::string& name) {
  const Figure* const figure = find_figure(page, name);
  if (figure == nullptr) throw std::runtime_error("no figure " + name);
  return *figure;
}

std::set<std::string> figure_names(const ReportPage& page) {
  std::set<std::string> names;
  for (const Section& section : page.sections) {
    for (const Figure& figure : section.figures) names.insert(figure.name);
  }
  return names;
}

const Series& series_of(const Panel& panel, const std::string& label) {
  for (const Series& series : panel.series) {
    if (series.label == label) return series;
  }
  throw std::runtime_error("no series " + label);
}

TEST(RunReport, ShowsEverythingThatWasGiven) {
  const ReportPage page = demo_page({120, true, false});
  EXPECT_EQ(
      figure_names(page),
      (std::set<std::string>{"ground_track", "position", "velocity", "attitude", "uncertainty",
                             "position_error", "velocity_error", "attitude_error", "gyro_bias",
                             "accel_bias", "gnss_innovations", "gnss_residuals", "data_health",
                             "timeline", "nis", "innovation_whiteness", "nees"}));
  EXPECT_EQ(page.key_numbers.size(), 4U);
  EXPECT_EQ(page.listings.size(), 2U) << "command and configuration";
  EXPECT_NE(page.subtitle.find("trip.rawlog"), std::string::npos);
  EXPECT_NE(page.subtitle.find("2025-07-08 19:34:18 UTC"), std::string::npos) << page.subtitle;
}

TEST(RunReport, ShowsNoErrorsWithoutReference) {
  const std::set<std::string> names = figure_names(demo_page({60, false, false}));
  EXPECT_EQ(names.count("nees"), 0U);
  EXPECT_EQ(names.count("nis"), 1U);
  EXPECT_EQ(names.count("position_error"), 0U);
  EXPECT_EQ(names.count("position"), 1U);
}

TEST(RunReport, EmptyRunHasAPage) {
  const RunReport report(kLabels, Mounting{});
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

TEST(RunReport, PositionIsInMetresFromTheStart) {
  RunReport report(kLabels, Mounting{});
  Epoch epoch;
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

TEST(RunReport, HeadingIsTheVehiclesAndHasNoJumps) {
  Mounting mounting;
  mounting.q_v_b = so3::from_euler({0, 0, 0.5});
  RunReport report(kLabels, mounting);
  for (int i = 0; i < 100; ++i) {
    Epoch epoch;
    epoch.t_ns = nanoseconds(i);
    const Eigen::Quaterniond q_n_v = so3::from_euler({0.1, 0.05, 6.0 + 0.1 * i});
    epoch.q_n_b = q_n_v * mounting.q_v_b;
    report.epoch(epoch);
  }
  const Figure figure = figure_of(report.page(), "attitude");
  const Series heading = series_of(figure.panels[2], "estimate");
  for (size_t i = 0; i < 100; ++i) {
    EXPECT_NEAR(heading.y[i], (6.0 + 0.1 * static_cast<double>(i)) * 180 / M_PI, 1e-9);
  }
  EXPECT_NEAR(series_of(figure.panels[0], "estimate").y[50], 0.1 * 180 / M_PI, 1e-9);
}

TEST(RunReport, BiasesHaveUnitsOfDataSheets) {
  RunReport report(kLabels, Mounting{});
  Epoch epoch;
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

  RunReport report(kLabels, Mounting{});
  for (const int t : {0, 1, 2, 3, 4, 30, 31, 32}) {
    Epoch epoch;
    epoch.t_ns = nanoseconds(t);
    report.epoch(epoch);
  }
  const Figure velocity = figure_of(report.page(), "velocity");
  const std::vector<double>& y = series_of(velocity.panels[0], "estimate").y;
  EXPECT_EQ(y.size(), 9U);
  EXPECT_TRUE(std::isnan(y[5]));
}

TEST(RunReport, StatisticsLeaveOutTheSettlingTime) {
  RunLabels labels = kLabels;
  labels.statistics_from_s = 50;
  RunReport report(labels, Mounting{});
  for (int t = 0; t < 100; ++t) {
    Epoch epoch;
    epoch.t_ns = nanoseconds(t);
    report.epoch(epoch);
    ReferenceError error;
    error.t_ns = epoch.t_ns;
    error.position_n = Eigen::Vector3d::Constant(t < 50 ? 10 : 0.02);
    report.reference_error(epoch, error);
  }
  const std::string note = figure_of(report.page(), "position_error").panels[0].note;
  EXPECT_NE(note.find("RMS 0.0200 m"), std::string::npos) << note;
  EXPECT_NE(note.find("from 50.0 s on"), std::string::npos) << note;
}

const Section& section_of(const ReportPage& page, const std::string& title) {
  for (const Section& section : page.sections) {
    if (section.title == title) return section;
  }
  throw std::runtime_error("no section " + title);
}

TEST(Consistency, FigureHasBoundsAndTellsRejectedFixes) {
  const ReportPage page = demo_page({600, true, true});
  const Panel& nis = figure_of(page, "nis").panels.at(0);
  EXPECT_EQ(nis.y.kind, AxisKind::log);
  EXPECT_EQ(series_of(nis, "rejected").x.size(), 39U);
  EXPECT_EQ(series_of(nis, "95 % for one fix").y, (std::vector<double>{0.2158, 0.2158}));
  EXPECT_EQ(series_of(nis, "95 % for the mean of 30").upper, (std::vector<double>{3.94, 3.94}));
  EXPECT_EQ(figure_of(page, "nees").panels.size(), 1U) << "of the position alone";
}

TEST(Consistency, HistogramIsADensity) {
  const ReportPage page = demo_page({60, false, false});
  const Figure& figure = figure_of(page, "innovation_whiteness");
  ASSERT_EQ(figure.panels.size(), 6U);
  const Series& bins = series_of(figure.panels[1], "whitened innovations");
  double area = 0;
  for (size_t i = 0; i + 1 < bins.x.size(); i += 2) {
    EXPECT_EQ(bins.upper[i], bins.upper[i + 1]);
    area += bins.upper[i] * (bins.x[i + 1] - bins.x[i]);
  }
  EXPECT_NEAR(area, 1, 1e-3);  // counts of the demo are rounded
  EXPECT_NE(figure.panels[5].note.find("2.5 % outside"), std::string::npos)
      << figure.panels[5].note;  // one lag of 40
}

TEST(Consistency, WordsFollowTheNumbers) {
  const auto words = [](double mean, double kurtosis, double outside) {
    RunReport report(kLabels, Mounting{});
    Consistency c;
    c.nis = {100, 50, mean, {2.3, 3.7}, 0.95};
    c.innovations[2].excess_kurtosis = kurtosis;
    c.autocorrelation.lag.resize(20);
    c.autocorrelation.outside_share = outside;
    report.consistency(c);
    return section_of(report.page(), "Consistency").paragraphs.at(0);
  };
  EXPECT_NE(words(3, 0, 0.05).find("within the band"), std::string::npos);
  EXPECT_NE(words(3, 0, 0.05).find("they are white"), std::string::npos);
  EXPECT_EQ(words(3, 0, 0.05).find("tails"), std::string::npos);
  EXPECT_NE(words(3.8, 4, 0.05).find("above the band"), std::string::npos);
  EXPECT_NE(words(3.8, 4, 0.05).find("tails are heavier"), std::string::npos);
  EXPECT_NE(words(2.2, 0, 0.2).find("below the band"), std::string::npos);
  EXPECT_NE(words(2.2, 0, 0.2).find("coloured"), std::string::npos);
}

TEST(Consistency, WordsOnPredictionsNameTheLongestHorizonOutsideItsBand) {
  const auto section = [](double after_15, double after_30) {
    RunReport report(kLabels, Mounting{});
    Consistency c;
    c.predictions = {
        {5, 10, 3, {1.7, 4.7}}, {15, 10, after_15, {1.7, 4.7}}, {30, 10, after_30, {1.7, 4.7}}};
    report.consistency(c);
    return section_of(report.page(), "Consistency");
  };
  const auto words = [&](double after_15, double after_30) {
    return section(after_15, after_30).paragraphs.at(0);
  };
  EXPECT_NE(words(3, 3).find("up to 30 s ahead"), std::string::npos);
  EXPECT_NE(words(9, 3).find("15 s ahead without those in between err more"), std::string::npos);
  EXPECT_NE(words(9, 40).find("30 s ahead without those in between err more"), std::string::npos);
  EXPECT_NE(words(3, 1).find("30 s ahead without those in between err less"), std::string::npos);
  EXPECT_EQ(section(3, 3).tables.at(0).rows.size(), 3U);
}

TEST(Consistency, WordsOnTheReference) {
  const auto words = [](double position, double velocity) {
    RunReport report(kLabels, Mounting{});
    Consistency c;
    c.position_nees = SquareConsistency{100, 50, position, {2.3, 3.7}, 0.95};
    c.velocity_nees = SquareConsistency{100, 50, velocity, {2.3, 3.7}, 0.95};
    report.consistency(c);
    return section_of(report.page(), "Consistency").paragraphs.at(0);
  };
  EXPECT_NE(words(3, 3).find("within"), std::string::npos);
  EXPECT_NE(words(9, 9).find("of position and velocity lies above"), std::string::npos);
  EXPECT_NE(words(9, 1).find("of position lies above"), std::string::npos);
  EXPECT_NE(words(9, 1).find("of velocity lies below"), std::string::npos);
}

TEST(Timeline, NoticesHaveTheirOwnLane) {
  RunReport report(kLabels, Mounting{});
  for (int t = 0; t < 50; ++t) report.imu_stamp(nanoseconds(t));
  report.notice({nanoseconds(1), NoticeKind::aligned, "aligned"});
  report.notice({nanoseconds(-3600), NoticeKind::skipped, "from another time"});
  const ReportPage page = report.page();
  const Panel& panel = figure_of(page, "timeline").panels.at(0);
  EXPECT_EQ(panel.y.categories, (std::vector<std::string>{"notices", "alignment", "IMU"}));
  EXPECT_EQ(series_of(panel, "notice").x, std::vector<double>{0}) << "at the border";
  EXPECT_EQ(section_of(page, "Timeline").details.at(0).rows.at(0).at(2), "from another time");
  EXPECT_NE(section_of(page, "Timeline").paragraphs.at(0).find("1 notice."), std::string::npos);
}

TEST(Timeline, IsCalmWhenNothingHappens) {
  RunReport report(kLabels, Mounting{});
  for (int t = 0; t < 50; ++t) {
    report.imu_stamp(nanoseconds(t));
    FixResult fix;
    fix.t_ns = nanoseconds(t);
    report.fix(fix);
  }
  report.notice({nanoseconds(1), NoticeKind::aligned, "aligned"});
  const ReportPage page = report.page();
  EXPECT_EQ(section_of(page, "Timeline").paragraphs.at(0).rfind("Nothing happened", 0), 0U);
  const Panel& panel = figure_of(page, "timeline").panels.at(0);
  EXPECT_EQ(panel.y.categories, (std::vector<std::string>{"alignment", "fixes used (50)", "IMU"}));
  for (const Series& series : panel.series) EXPECT_NE(series.ink, Ink::vermillion);
}

TEST(Timeline, ShowsStretchesHolesAndEvents) {
  const ReportPage page = demo_page({600, false, true});
  const Panel& panel = figure_of(page, "timeline").panels.at(0);
  EXPECT_EQ(panel.y.categories,
            (std::vector<std::string>{"alignment", "gated (39)", "fixes used (2122)", "IMU"}));
  const auto bars = [&panel](const std::string& column) {
    for (const Series& series : panel.series) {
      if (series.column == column) return series;
    }
    throw std::runtime_error("no column " + column);
  };
  // 39 fixes every 0.25 s after 480 s are one bar: begin, end, gap.
  const std::vector<double> gated = bars("gated").x;
  ASSERT_EQ(gated.size(), 3U);
  EXPECT_NEAR(gated[0], 480.25, 0.01);
  EXPECT_NEAR(gated[1], 489.75, 0.01);
  EXPECT_EQ(bars("used").x.size(), 9U) << "before the outage, after it, after the rejected ones";
  const Series imu = bars("IMU");
  ASSERT_EQ(imu.x.size(), 6U);
  EXPECT_NEAR(imu.x[1], 430, 0.02);
  EXPECT_NEAR(imu.x[3], 430.8, 0.02);
  EXPECT_EQ(series_of(panel, "aligned").x.size(), 1U);
  const Section& section = section_of(page, "Timeline");
  EXPECT_NE(section.paragraphs.at(0).find("39 of 2161 fixes rejected (39 gated)"),
            std::string::npos)
      << section.paragraphs.at(0);
  EXPECT_NE(section.paragraphs.at(0).find("in 1 hole"), std::string::npos);
  EXPECT_EQ(section.details.at(0).rows.size(), 1U);
}

TEST(Timeline, TakesBoundedRoom) {
  RunReport report(kLabels, Mounting{});
  for (int i = 0; i < 30'000; ++i) {
    FixResult fix;
    fix.t_ns = nanoseconds(0.1 * i);
    fix.verdict = i % 5 == 0 ? FixVerdict::gated : FixVerdict::used;
    report.fix(fix);
  }
  const ReportPage page = report.page();
  const Panel& panel = figure_of(page, "timeline").panels.at(0);
  EXPECT_EQ(panel.y.categories.front(), "gated (6000)");
  for (const Series& series : panel.series) {
    EXPECT_LE(series.x.size(), 3000U);
    EXPECT_GT(*std::max_element(series.x.begin(), series.x.end()), 2900) << "to the end";
  }
}

TEST(RunReport, LongRunsTakeBoundedRoom) {
  RunReport report(kLabels, Mounting{});
  for (int i = 0; i < 60000; ++i) {
    Epoch epoch;
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
  RunReport report(kLabels, Mounting{});
  for (int t = 0; t < 20; ++t) {
    Epoch epoch;
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
  RunReport report(kLabels, Mounting{});
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
