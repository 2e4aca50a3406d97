#include "live_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "foucault/core/time.h"

namespace foucault::page {
namespace {

using plot::Figure;
using plot::Mark;
using plot::Panel;
using plot::Series;

Figure figure_of(const std::string& name, const Series& series) {
  Figure figure{name, "Title"};
  Panel panel;
  panel.series = {series};
  figure.panels = {panel};
  return figure;
}

ReportPage page_of(const std::vector<Figure>& figures) {
  ReportPage page;
  page.sections = {{"S", {}, {}, figures}};
  return page;
}

int digit(char c) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  return static_cast<int>(digits.find(c));
}

/// As the script does it.
std::vector<double> decoded(const nlohmann::json& column) {
  const std::string text = column.at(0);
  const double low = column.at(1), high = column.at(2);
  std::vector<double> values;
  for (size_t i = 0; i + 4 <= text.size(); i += 4) {
    int code = 0;
    for (size_t k = 0; k < 4; ++k) code = code * 64 + digit(text[i + k]);
    values.push_back(code == 0xffffff ? std::nan("") : low + (high - low) * code / 0xfffffe);
  }
  return values;
}

TEST(LiveData, NumbersComeBackGapsIncluded) {
  Series series{"error"};
  series.x = {0, 1, 2, 3};
  series.y = {-1000, 0.123, plot::kNoValue, 1000};
  const auto json = nlohmann::json::parse(live_data(page_of({figure_of("a", series)})));
  const auto& shown = json.at("figures").at("a").at("panels").at(0).at("series").at(0);
  const std::vector<double> y = decoded(json.at("columns").at(shown.at("y").get<size_t>()));
  ASSERT_EQ(y.size(), 4U);
  EXPECT_EQ(y[0], -1000);
  EXPECT_NEAR(y[1], 0.123, 2000 / 1.6e7) << "24 bits of the range";
  EXPECT_TRUE(std::isnan(y[2]));
  EXPECT_EQ(y[3], 1000);
}

TEST(LiveData, EqualColumnsAreThereOnce) {
  Series series{"error"};
  series.x = {0, 1};
  series.y = {5, 6};
  const auto json =
      nlohmann::json::parse(live_data(page_of({figure_of("a", series), figure_of("b", series)})));
  EXPECT_EQ(json.at("columns").size(), 2U);
  EXPECT_EQ(json.at("figures").size(), 2U);
}

TEST(LiveData, LongSeriesAreThinnedAndKeepTheirPeaks) {
  Series series{"error"};
  for (int i = 0; i < 50000; ++i) {
    series.x.push_back(i);
    series.y.push_back(i == 31234 ? 7 : std::sin(0.001 * i));
  }
  const auto json = nlohmann::json::parse(live_data(page_of({figure_of("a", series)})));
  const auto& shown = json.at("figures").at("a").at("panels").at(0).at("series").at(0);
  const std::vector<double> x = decoded(json.at("columns").at(shown.at("x").get<size_t>()));
  const std::vector<double> y = decoded(json.at("columns").at(shown.at("y").get<size_t>()));
  EXPECT_LE(x.size(), 2000U);
  EXPECT_EQ(x.size(), y.size());
  EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
  EXPECT_EQ(*std::max_element(y.begin(), y.end()), 7);
}

TEST(LiveData, NothingInItEndsTheScript) {
  Series series{"</script><b>"};
  series.x = series.y = {1};
  EXPECT_THAT(live_data(page_of({figure_of("a", series)})),
              ::testing::Not(::testing::HasSubstr("<")));
  EXPECT_THAT(live_script(), ::testing::Not(::testing::HasSubstr("</script")));
}

TEST(LiveData, FiguresColouredByValueStayImages) {
  Series series{"drift"};
  series.x = series.y = series.value = {1, 2};
  const auto json = nlohmann::json::parse(live_data(page_of({figure_of("a", series)})));
  EXPECT_TRUE(json.at("figures").empty());
}

TEST(LiveData, TellsTheClock) {
  ReportPage page;
  EXPECT_FALSE(nlohmann::json::parse(live_data(page)).contains("start_ms"));
  page.start_ns = gps_to_unix_ns(2300, 345600.5);
  const auto json = nlohmann::json::parse(live_data(page));
  EXPECT_DOUBLE_EQ(json.at("gps_second"), 345600.5);
  EXPECT_NEAR(json.at("start_ms").get<double>(), 1e3 * to_seconds(*page.start_ns), 1e-3);
}

}  // namespace
}  // namespace foucault::page
