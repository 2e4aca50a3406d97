#include "layout.h"

#include <gtest/gtest.h>

#include "style.h"

namespace foucault::plot {
namespace {

Panel panel_with(const std::vector<double>& x, const std::vector<double>& y) {
  Panel panel;
  panel.series = {{"curve"}};
  panel.series[0].x = x;
  panel.series[0].y = y;
  return panel;
}

Figure figure_of(size_t panels, int columns) {
  Figure figure{"f", "Title"};
  figure.columns = columns;
  figure.panels.assign(panels, panel_with({0, 10}, {0, 1}));
  return figure;
}

size_t labelled(const Ticks& ticks) {
  size_t count = 0;
  for (const Tick& tick : ticks.ticks) count += tick.label.empty() ? 0 : 1;
  return count;
}

class LaidOut : public ::testing::Test {
 protected:
  Typesetter typesetter_{find_fonts()};
};

TEST_F(LaidOut, PanelsLieOnThePageAndApart) {
  const Layout layout = lay_out(figure_of(5, 2), typesetter_);
  EXPECT_EQ(layout.page, cv::Size(2000, 1200));
  ASSERT_EQ(layout.panels.size(), 5U);
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(layout.panels[i].plot & cv::Rect({}, layout.page), layout.panels[i].plot);
    for (size_t j = 0; j < i; ++j) {
      EXPECT_TRUE((layout.panels[i].plot & layout.panels[j].plot).empty()) << i << " " << j;
    }
  }
  EXPECT_EQ(layout.panels[0].plot.y, layout.panels[1].plot.y) << "row by row";
  EXPECT_EQ(layout.panels[0].plot.x, layout.panels[4].plot.x);
}

TEST_F(LaidOut, NotesThatDoNotFitBesideTheTitleGoOnBelow) {
  Figure figure = figure_of(1, 1);
  figure.panels[0].title = "Nonholonomic";
  figure.panels[0].note = "mean 0.48 · 1470 used, 0 rejected · from 60 s on";
  EXPECT_EQ(lay_out(figure, typesetter_).panels[0].notes.size(), 1U);
  const int top = lay_out(figure, typesetter_).panels[0].plot.y;
  figure.width_mm = 90;
  const PlacedPanel narrow = lay_out(figure, typesetter_).panels[0];
  EXPECT_EQ(narrow.notes,
            (std::vector<std::string>{"mean 0.48", "1470 used, 0 rejected · from 60 s on"}));
  EXPECT_GT(narrow.plot.y, top);
}

/// Long labels of ticks make the plot narrower, and with it what is above it.
TEST_F(LaidOut, TitleAndNoteDoNotOverlapAboveANarrowPlot) {
  Figure figure = figure_of(3, 3);
  for (Panel& panel : figure.panels) {
    panel.y = {"ppm of the wheels", ""};
    panel.series[0].y = {-1.4912, -1.4673};
    panel.title = "Wheel scale";
  }
  for (const char* note : {"−1.4767 ± 0.0024 %", "−1.48 ± 0.24 %", "−1.476 ± 0.002 %"}) {
    for (Panel& panel : figure.panels) panel.note = note;
    for (const PlacedPanel& placed : lay_out(figure, typesetter_).panels) {
      if (placed.notes.size() > 1) continue;  // one below the other
      const double taken = typesetter_.width("Wheel scale", style::kAxisPoints, true) +
                           typesetter_.width(note, style::kNotePoints);
      EXPECT_LT(taken, placed.plot.width) << note;
    }
  }
}

TEST_F(LaidOut, OnlyTheLowestPanelsOfASharedAxisHaveLabels) {
  Figure figure = figure_of(5, 2);
  figure.share_x = true;
  const Layout layout = lay_out(figure, typesetter_);
  std::vector<bool> labels;
  for (const PlacedPanel& panel : layout.panels) labels.push_back(panel.has_x_labels);
  EXPECT_EQ(labels, (std::vector<bool>{false, false, false, true, true}));
}

TEST_F(LaidOut, PanelsThatShareAnAxisShowTheSameOfIt) {
  Figure figure = figure_of(2, 1);
  figure.panels[1] = panel_with({5, 40}, {0, 1});
  EXPECT_LT(lay_out(figure, typesetter_).panels[0].x.span().max, 20);
  figure.share_x = true;
  const Layout layout = lay_out(figure, typesetter_);
  for (const PlacedPanel& panel : layout.panels) {
    EXPECT_EQ(panel.x.span().min, layout.panels[0].x.span().min);
    EXPECT_EQ(panel.x.span().max, layout.panels[0].x.span().max);
    EXPECT_LE(panel.x.span().min, 0);
    EXPECT_GE(panel.x.span().max, 40);
  }
}

TEST_F(LaidOut, HeightsFollowTheShares) {
  Figure figure = figure_of(2, 1);
  figure.panels[1].height_share = 3;
  const Layout layout = lay_out(figure, typesetter_);
  EXPECT_NEAR(layout.panels[1].plot.height, 3 * layout.panels[0].plot.height, 2);
}

TEST_F(LaidOut, EqualAspectGivesBothAxesOneScale) {
  Figure figure = figure_of(1, 1);
  figure.panels[0].equal_aspect = true;
  const PlacedPanel panel = lay_out(figure, typesetter_).panels[0];
  EXPECT_NEAR(panel.x.pixel(1) - panel.x.pixel(0), panel.y.pixel(0) - panel.y.pixel(1), 1e-9);
}

TEST_F(LaidOut, AxesHaveThreeLabelsAtLeastThoughPanelsAreSmall) {
  Figure figure = figure_of(4, 4);
  figure.width_mm = 160;
  figure.height_mm = 40;
  for (const PlacedPanel& panel : lay_out(figure, typesetter_).panels) {
    EXPECT_GE(labelled(panel.x_ticks), 3U);
    EXPECT_GE(labelled(panel.y_ticks), 3U);
  }
}

TEST_F(LaidOut, ColoursHaveAScaleAndRoom) {
  Figure figure = figure_of(1, 1);
  const PlacedPanel plain = lay_out(figure, typesetter_).panels[0];
  EXPECT_FALSE(plain.colour);
  figure.panels[0].series[0].value = {3, 7};
  const PlacedPanel coloured = lay_out(figure, typesetter_).panels[0];
  ASSERT_TRUE(coloured.colour);
  EXPECT_LE(coloured.colour->span().min, 3);
  EXPECT_GE(coloured.colour->span().max, 7);
  EXPECT_LT(coloured.plot.width, plain.plot.width);
}

TEST_F(LaidOut, LegendsStandWhereTheyAreAskedFor) {
  Figure figure = figure_of(1, 1);
  const Layout above = lay_out(figure, typesetter_);
  EXPECT_GT(above.legend->height(), 0);
  EXPECT_FALSE(above.panels[0].legend);
  figure.panels[0].legend = LegendPlace::panel;
  const Layout beside = lay_out(figure, typesetter_);
  EXPECT_EQ(beside.legend->height(), 0);
  EXPECT_GT(beside.panels[0].legend->height(), 0);
  figure.panels[0].legend = LegendPlace::none;
  EXPECT_FALSE(lay_out(figure, typesetter_).panels[0].legend);
}

TEST_F(LaidOut, AFigureWithoutPanelsIsAPage) {
  const Layout layout = lay_out(Figure{}, typesetter_);
  EXPECT_TRUE(layout.panels.empty());
  EXPECT_EQ(layout.page, cv::Size(2000, 1200));
}

}  // namespace
}  // namespace foucault::plot
