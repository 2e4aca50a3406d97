#include "consistency_section.h"

#include <gtest/gtest.h>

#include "demo_run.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

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
    RunReport report(kLabels, state::Mounting{});
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
    RunReport report(kLabels, state::Mounting{});
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
    RunReport report(kLabels, state::Mounting{});
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

}  // namespace
}  // namespace foucault::content
