#include "timeline_section.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "demo_run.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

TEST(Timeline, NoticesHaveTheirOwnLane) {
  RunReport report(kLabels, state::Mounting{});
  for (int t = 0; t < 50; ++t) report.imu_stamp(nanoseconds(t));
  report.notice({nanoseconds(1), state::NoticeKind::aligned, "aligned"});
  report.notice({nanoseconds(-3600), state::NoticeKind::skipped, "from another time"});
  const ReportPage page = report.page();
  const Panel& panel = figure_of(page, "timeline").panels.at(0);
  EXPECT_EQ(panel.y.categories, (std::vector<std::string>{"notices", "alignment", "IMU"}));
  EXPECT_EQ(series_of(panel, "notice").x, std::vector<double>{0}) << "at the border";
  EXPECT_EQ(section_of(page, "Timeline").details.at(0).rows.at(0).at(2), "from another time");
  EXPECT_NE(section_of(page, "Timeline").paragraphs.at(0).find("1 notice."), std::string::npos);
}

TEST(Timeline, IsCalmWhenNothingHappens) {
  RunReport report(kLabels, state::Mounting{});
  for (int t = 0; t < 50; ++t) {
    report.imu_stamp(nanoseconds(t));
    state::FixResult fix;
    fix.t_ns = nanoseconds(t);
    report.fix(fix);
  }
  report.notice({nanoseconds(1), state::NoticeKind::aligned, "aligned"});
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
  RunReport report(kLabels, state::Mounting{});
  for (int i = 0; i < 30'000; ++i) {
    state::FixResult fix;
    fix.t_ns = nanoseconds(0.1 * i);
    fix.verdict = i % 5 == 0 ? state::FixVerdict::gated : state::FixVerdict::used;
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

}  // namespace
}  // namespace foucault::content
