#include "legend.h"

#include <gtest/gtest.h>

namespace foucault::plot {
namespace {

Series series_named(const std::string& label, Mark mark, Ink ink) {
  Series series{label, {}, mark, ink};
  series.x = {0};
  series.y = {0};
  return series;
}

std::vector<std::string> labels(const std::vector<LegendEntry>& entries) {
  std::vector<std::string> result;
  for (const LegendEntry& entry : entries) result.push_back(entry.label);
  return result;
}

TEST(LegendEntries, NameEverythingOnce) {
  Panel panel;
  Series hidden = series_named("hidden", Mark::line, Ink::blue);
  hidden.in_legend = false;
  Series fixes = series_named("fix", Mark::points, Ink::blue);
  fixes.categories = {{"fixed", Ink::green}, {"float", Ink::orange}, {"single", Ink::purple}};
  fixes.x = fixes.y = {0, 1, 2};
  fixes.category = {2, 0, 2};
  panel.series = {series_named("error", Mark::line, Ink::blue),
                  series_named("error", Mark::line, Ink::blue),
                  series_named("error", Mark::band, Ink::blue),
                  Series{"no data"},
                  hidden,
                  fixes,
                  series_named("", Mark::line, Ink::blue)};
  panel.shades = {{0, 1, "outage", Ink::gray}, {2, 3, "outage", Ink::gray}, {4, 5, "", Ink::gray}};
  const std::vector<LegendEntry> entries = legend_entries(panel);
  EXPECT_EQ(labels(entries),
            (std::vector<std::string>{"error", "error", "fixed", "single", "outage"}))
      << "a line and a band differ; only types that occur";
  EXPECT_EQ(entries[0].sample, LegendEntry::Sample::line);
  EXPECT_EQ(entries[1].sample, LegendEntry::Sample::patch);
  EXPECT_EQ(entries[2].sample, LegendEntry::Sample::marker);
  EXPECT_EQ(entries[3].ink, Ink::purple);
}

TEST(LegendEntries, NameOnlyWhatIsSeen) {
  Panel panel;
  panel.y.min = 0;
  panel.y.max = 1;
  Series inside = series_named("inside", Mark::line, Ink::blue);
  inside.x = {0, 1, 2};
  inside.y = {0.5, 0.6, 7};
  Series outside = series_named("outside", Mark::band, Ink::sky);
  outside.x = {0, 1};
  outside.y.clear();
  outside.lower = {5, 5};
  outside.upper = {6, 6};
  panel.series = {inside, outside};
  panel.shades = {{100, 110, "much later", Ink::gray}};
  EXPECT_EQ(labels(legend_entries(panel)), (std::vector<std::string>{"inside", "beyond the axis"}));
  panel.series[0].y[2] = 0.7;
  EXPECT_EQ(labels(legend_entries(panel)), (std::vector<std::string>{"inside"}));
}

class LegendOnPage : public ::testing::Test {
 protected:
  /// Pixels that are not white.
  static int ink(const Canvas& canvas) {
    int count = 0;
    for (int y = 0; y < canvas.image().rows; ++y) {
      for (int x = 0; x < canvas.image().cols; ++x) {
        const cv::Vec3b& p = canvas.image().at<cv::Vec3b>(y, x);
        count += p[0] < 250 || p[1] < 250 || p[2] < 250 ? 1 : 0;
      }
    }
    return count;
  }

  Typesetter typesetter_{find_fonts()};
};

TEST_F(LegendOnPage, NoEntriesTakeNoRoom) {
  EXPECT_EQ(Legend({}, 100, typesetter_).height(), 0);
  EXPECT_EQ(Legend({}, 100, typesetter_).width(), 0);
}

TEST_F(LegendOnPage, BreaksIntoRowsThatFit) {
  const std::vector<LegendEntry> three{{"one"}, {"two"}, {"three"}};
  const Legend wide(three, 2000, typesetter_);
  const Legend narrow(three, wide.width() - 1, typesetter_);
  EXPECT_DOUBLE_EQ(narrow.height(), 2 * wide.height());
  EXPECT_LT(narrow.width(), wide.width());
  EXPECT_DOUBLE_EQ(Legend(three, 1, typesetter_).height(), 3 * wide.height());
}

TEST_F(LegendOnPage, DrawsASampleBesideEachName) {
  for (const auto sample :
       {LegendEntry::Sample::line, LegendEntry::Sample::marker, LegendEntry::Sample::patch}) {
    Canvas canvas({200, 80}, typesetter_);
    Legend({{"", sample, Ink::blue}}, 200, typesetter_).draw(canvas, {10, 10});
    EXPECT_GT(ink(canvas), 80) << int(sample);
  }
  LegendEntry dashed{"", LegendEntry::Sample::line, Ink::blue};
  Canvas whole({200, 80}, typesetter_);
  Legend({dashed}, 200, typesetter_).draw(whole, {10, 10});
  dashed.dash = Dash::dashes;
  Canvas parted({200, 80}, typesetter_);
  Legend({dashed}, 200, typesetter_).draw(parted, {10, 10});
  EXPECT_LT(ink(parted), 1.2 * ink(whole)) << "two strokes and what is between them, longer";
}

}  // namespace
}  // namespace foucault::plot
