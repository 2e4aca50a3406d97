#include "figure_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "foucault/core/error.h"

namespace foucault::plot {
namespace {

using Json = nlohmann::ordered_json;

Figure figure_with(const Panel& panel) {
  Figure figure;
  figure.name = "f";
  figure.panels = {panel};
  return figure;
}

Panel through_json(const Panel& panel) {
  return figure_from_json(figure_to_json(figure_with(panel))).panels.at(0);
}

TEST(FigureJson, EveryWordLeadsBackToItsEnumerator) {
  for (int i = 0; i <= static_cast<int>(Shape::frame); ++i) {
    Panel panel;
    panel.series.resize(1);
    panel.series[0].shape = static_cast<Shape>(i);
    panel.series[0].mark = static_cast<Mark>(i % 5);
    panel.series[0].range_role = static_cast<RangeRole>(i % 4);
    panel.series[0].ink = static_cast<Ink>(i);
    panel.x.kind = static_cast<AxisKind>(i % 4);
    panel.legend = static_cast<LegendPlace>(i % 3);
    panel.lines = {{static_cast<Direction>(i % 2), 1, "", Ink::gray, true}};
    panel.annotations = {{0, 0, "", static_cast<Side>(i % 5), Ink::black}};
    const Panel back = through_json(panel);
    EXPECT_EQ(back.series.at(0).shape, panel.series[0].shape) << i;
    EXPECT_EQ(back.series.at(0).mark, panel.series[0].mark) << i;
    EXPECT_EQ(back.series.at(0).range_role, panel.series[0].range_role) << i;
    EXPECT_EQ(back.series.at(0).ink, panel.series[0].ink) << i;
    EXPECT_EQ(back.x.kind, panel.x.kind) << i;
    EXPECT_EQ(back.legend, panel.legend) << i;
    EXPECT_EQ(back.lines.at(0).direction, panel.lines[0].direction) << i;
    EXPECT_EQ(back.annotations.at(0).side, panel.annotations[0].side) << i;
  }
}

TEST(FigureJson, EndsOfAxesAndHeatMapsMayBeMissing) {
  Panel panel;
  panel.y.max = 0.1;
  const Json json = figure_to_json(figure_with(panel));
  EXPECT_TRUE(json["panels"][0]["y"]["min"].is_null());
  EXPECT_EQ(json["panels"][0]["y"]["max"], 0.1);
  EXPECT_TRUE(json["panels"][0]["heat_map"].is_null());
  EXPECT_EQ(through_json(panel).y.max, 0.1);
  EXPECT_FALSE(through_json(panel).y.min);
  panel.heat_map = HeatMap{3, 2, {}};
  EXPECT_EQ(through_json(panel).heat_map->columns, 3U);
}

TEST(FigureJson, RefusesUnknownWordsAndMissingKeys) {
  Json json = figure_to_json(figure_with({}));
  json["panels"][0]["legend"] = "somewhere";
  EXPECT_THROW(figure_from_json(json), DataError);
  json["panels"][0]["legend"] = 3;
  EXPECT_THROW(figure_from_json(json), nlohmann::json::exception);
  json["panels"][0].erase("legend");
  EXPECT_THROW(figure_from_json(json), nlohmann::json::exception);
}

TEST(FigureJson, KeysKeepTheirOrder) {
  const Json json = figure_to_json({});
  std::string keys;
  for (const auto& [key, value] : json.items()) keys += key + " ";
  EXPECT_EQ(keys, "name title subtitle caption width_mm height_mm columns share_x panels ");
}

}  // namespace
}  // namespace foucault::plot
