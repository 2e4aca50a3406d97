#include "foucault/plot/figure_store.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "foucault/core/error.h"

namespace foucault::plot {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A figure that uses every part of the description.
Figure rich_figure() {
  Panel time;
  time.title = "Panel, with \"quotes\"";
  time.note = "RMS 1 cm";
  time.x.label = "Time since start";
  time.x.unit = "s";
  time.x.kind = AxisKind::duration;
  time.y.label = "North";
  time.y.unit = "m/s²";
  time.y.shown_unit = "cm/s²";
  time.y.shown_factor = 100;
  time.y.zero_centred = true;
  time.y.min = -1.0 / 3;
  Series band;
  band.label = "±3σ";
  band.mark = Mark::band;
  band.x = {0, 1, 2};
  band.lower = {-0.1, -0.2, -0.1};
  band.upper = {0.1, 0.2, 0.1};
  Series line;
  line.label = "error";
  line.x = {0, 1, 2};
  line.y = {1.0 / 3, kNaN, -0.123456789123};
  Series points;
  points.label = "fix";
  points.mark = Mark::points;
  points.shape = Shape::cross;
  points.x = {0.5, 1.5};
  points.y = {0, 0.1};
  points.categories = {{"RTK fixed", Ink::green}, {"RTK float", Ink::orange}};
  points.category = {1, 0};
  points.value = {3, 4};
  time.series = {band, line, points};
  time.shades = {{0.25, 0.75, "outage", Ink::gray}};
  time.lines = {{Direction::vertical, 1, "here", Ink::purple, false}};
  time.annotations = {{1, 0.05, "note", Side::above, Ink::black}};
  time.colour.label = "Speed";
  time.colour.unit = "m/s";

  Panel bars;
  bars.x.kind = AxisKind::category;
  bars.x.categories = {"ADIS16465", "ICM20602"};
  bars.y.label = "Drift";
  bars.y.unit = "m";
  Series method;
  method.label = "ekf";
  method.mark = Mark::bars;
  method.x = {0, 1};
  method.y = {5, 20};
  method.lower = {4, 17};
  method.upper = {6, 24};
  bars.series = {method};

  Panel map;
  map.x.kind = map.y.kind = AxisKind::category;
  map.x.label = "arw";
  map.y.label = "vrw";
  map.x.categories = {"0.1", "0.2"};
  map.y.categories = {"1", "2"};
  map.colour.label = "RMS drift";
  map.colour.unit = "m";
  map.heat_map = HeatMap{2, 2, {1, 2, kNaN, 4}};

  Figure figure;
  figure.name = "rich";
  figure.title = "Everything";
  figure.subtitle = "sub";
  figure.caption = "cap";
  figure.width_mm = 150;
  figure.height_mm = 200;
  figure.panels = {time, bars, map};
  return figure;
}

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

class FigureStore : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

TEST_F(FigureStore, CsvHasNamesWithUnitsAndTheNumbers) {
  std::istringstream csv(to_text(rich_figure()).csv);
  std::string header, first, second;
  std::getline(csv, header);
  std::getline(csv, first);
  std::getline(csv, second);
  EXPECT_EQ(header.substr(0, header.find(",time_since_start_s_2")),
            "time_since_start_s,north_3sigma_lower_m_s2,north_3sigma_upper_m_s2,north_error_m_s2");
  EXPECT_EQ(first.rfind("0,-0.1,0.1,0.333333333,0.5,0,RTK float,3,ADIS16465,5,4,6,", 0), 0U)
      << first;
  EXPECT_EQ(second.rfind("1,-0.2,0.2,,1.5,0.1,RTK fixed,4,ICM20602,20,17,24,", 0), 0U) << second;
}

TEST_F(FigureStore, RoundTripKeepsEverything) {
  const FigureText text = to_text(rich_figure());
  const Figure back = from_text(text, "rich");
  const FigureText again = to_text(back);
  EXPECT_EQ(again.csv, text.csv);
  EXPECT_EQ(again.json, text.json);
  const Panel& time = back.panels.at(0);
  EXPECT_EQ(time.series.at(1).y.size(), 3U);
  EXPECT_TRUE(std::isnan(time.series.at(1).y.at(1)));
  EXPECT_NEAR(time.series.at(1).y.at(2), -0.123456789123, 5e-10) << "nine digits";
  EXPECT_EQ(time.series.at(2).category, (std::vector<double>{1, 0}));
  EXPECT_EQ(time.y.min, -1.0 / 3);
  EXPECT_EQ(time.series.at(2).shape, Shape::cross);
  EXPECT_EQ(back.panels.at(1).series.at(0).x, (std::vector<double>{0, 1}));
  EXPECT_EQ(back.panels.at(2).heat_map->values.at(3), 4);
}

TEST_F(FigureStore, DrawingFromFilesGivesTheSameBytes) {
  Renderer renderer;
  save_figure(rich_figure(), folder_, renderer);
  const std::vector<unsigned char> again = renderer.png(load_figure(folder_, "rich"));
  EXPECT_EQ(std::string(again.begin(), again.end()), content(folder_ / "rich.png"));
}

TEST_F(FigureStore, IndicesThatAreNoPlacesStayNumbers) {
  Figure figure = rich_figure();
  figure.panels = {figure.panels[2]};
  Series mark;
  mark.label = "chosen";
  mark.mark = Mark::points;
  mark.x = {0.5, 1};
  mark.y = {1, 1};
  figure.panels[0].series = {mark};
  const Figure back = from_text(to_text(figure), "map");
  EXPECT_EQ(back.panels[0].series[0].x, mark.x);
  EXPECT_EQ(back.panels[0].series[0].y, mark.y);
}

TEST_F(FigureStore, DamagedFilesAreNamed) {
  const FigureText good = to_text(rich_figure());
  const auto message = [](const FigureText& text) -> std::string {
    try {
      from_text(text, "place/rich");
    } catch (const DataError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_NE(message({good.csv, "{"}).find("place/rich.json"), std::string::npos);
  EXPECT_NE(message({good.csv, "{}"}).find("place/rich.json"), std::string::npos);
  EXPECT_NE(message({"a,b\n1\n", good.json}).find("place/rich.csv:2"), std::string::npos);
  EXPECT_NE(message({"a,b\n1,2\n", good.json}).find("time_since_start_s"), std::string::npos);
  std::string wrong = good.csv;
  wrong.replace(wrong.find("0.333333333"), 11, "zero-point-3");
  EXPECT_NE(message({wrong, good.json}).find("zero-point-3"), std::string::npos);
  EXPECT_NE(message({good.csv.substr(0, good.csv.find('\n') + 1), good.json}).find("cut short"),
            std::string::npos);
}

TEST_F(FigureStore, FolderThatIsNotThereIsAnError) {
  Renderer renderer;
  EXPECT_THROW(save_figure(rich_figure(), folder_ / "no" / "such", renderer), DataError);
  EXPECT_THROW(load_figure(folder_, "absent"), DataError);
}

}  // namespace
}  // namespace foucault::plot
