#include "foucault/tuning/grid_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace foucault::tuning {
namespace {

GridAxis axis(const std::string& key, std::size_t count) {
  GridAxis axis{key, {}, true};
  for (std::size_t i = 0; i < count; ++i) axis.values.push_back(std::to_string(i));
  return axis;
}

using Valley = std::function<double(const GridPoint&)>;

BatchObjective batch(const Valley& valley) {
  return [valley](const std::vector<GridPoint>& points) {
    std::vector<double> values;
    for (const GridPoint& point : points) values.push_back(valley(point));
    return values;
  };
}

/// A valley oblique to the axes, as too much noise here is made up for by too little there.
Valley oblique(double x0, double y0) {
  return [=](const GridPoint& p) {
    const double x = static_cast<double>(p[0]) - x0;
    const double y = static_cast<double>(p[1]) - y0;
    return 5 + std::sqrt(x * x + y * y + x * y);
  };
}

TEST(ParameterGrid, LastAxisRunsFastest) {
  const ParameterGrid grid{{axis("a", 2), axis("b", 3)}};
  EXPECT_EQ(grid.size(), 6u);
  const std::vector<GridPoint> points = grid.points();
  ASSERT_EQ(points.size(), 6u);
  EXPECT_EQ(points[1], (GridPoint{0, 1}));
  EXPECT_EQ(points[3], (GridPoint{1, 0}));
}

TEST(FullSearch, SeesEveryPointAndTakesTheFirstOfEqualOnes) {
  const ParameterGrid grid{{axis("a", 3), axis("b", 4)}};
  const GridSearchResult result = full_search(grid, batch([](const GridPoint&) { return 7.0; }));
  EXPECT_EQ(result.evaluated.size(), 12u);
  EXPECT_EQ(result.best, (GridPoint{0, 0}));
  EXPECT_EQ(result.value, 7.0);
}

TEST(CoarseToFine, FindsTheSameWithAtMostAThirdOfTheRuns) {
  const ParameterGrid grid{{axis("a", 13), axis("b", 13)}};
  for (int x = 0; x < 13; ++x) {
    for (int y = 0; y < 13; ++y) {
      const BatchObjective objective = batch(oblique(x + 0.3, y - 0.2));
      const GridSearchResult full = full_search(grid, objective);
      const GridSearchResult fast = coarse_to_fine_search(grid, objective);
      EXPECT_EQ(fast.best, full.best) << x << ", " << y;
      EXPECT_EQ(fast.value, full.value);
      EXPECT_LE(3 * fast.evaluated.size(), full.evaluated.size()) << x << ", " << y;
    }
  }
}

TEST(CoarseToFine, ThreeParameters) {
  const ParameterGrid grid{{axis("a", 9), axis("b", 7), axis("c", 9)}};
  const BatchObjective objective = batch([](const GridPoint& p) {
    const double a = static_cast<double>(p[0]) - 6;
    const double b = static_cast<double>(p[1]) - 1;
    const double c = static_cast<double>(p[2]) - 3;
    return a * a + b * b + c * c + 0.8 * (a * b + b * c);
  });
  const GridSearchResult fast = coarse_to_fine_search(grid, objective);
  EXPECT_EQ(fast.best, full_search(grid, objective).best);
  EXPECT_LE(3 * fast.evaluated.size(), grid.size());
}

TEST(CoarseToFine, NamesAreAllTried) {
  ParameterGrid grid{{axis("a", 17), axis("mode", 5)}};
  grid.axes[1].ordered = false;
  const BatchObjective objective = batch([](const GridPoint& p) {
    return std::abs(static_cast<double>(p[0]) - 11) + (p[1] == 3 ? 0 : 100);
  });
  const GridSearchResult result = coarse_to_fine_search(grid, objective);
  EXPECT_EQ(result.best, (GridPoint{11, 3}));
}

TEST(CoarseToFine, SmallGridsAreTakenWhole) {
  const ParameterGrid grid{{axis("a", 1), axis("b", 2), axis("c", 3)}};
  const GridSearchResult result = coarse_to_fine_search(
      grid, batch([](const GridPoint& p) { return static_cast<double>(p[2]); }));
  EXPECT_EQ(result.evaluated.size(), 6u);
  EXPECT_EQ(result.best, (GridPoint{0, 0, 0}));
}

TEST(CoarseToFine, PointsWithoutAValueAreAvoided) {
  const ParameterGrid grid{{axis("a", 9)}};
  const BatchObjective objective = batch([](const GridPoint& p) {
    return p[0] < 3 ? std::numeric_limits<double>::infinity() : static_cast<double>(p[0]);
  });
  EXPECT_EQ(coarse_to_fine_search(grid, objective).best, (GridPoint{3}));
}

TEST(CoarseToFine, EachPointIsAskedForOnce) {
  const ParameterGrid grid{{axis("a", 13), axis("b", 13)}};
  std::map<GridPoint, int> asked;
  const BatchObjective objective = [&](const std::vector<GridPoint>& points) {
    for (const GridPoint& point : points) ++asked[point];
    return batch(oblique(8, 3))(points);
  };
  coarse_to_fine_search(grid, objective);
  for (const auto& [point, times] : asked) EXPECT_EQ(times, 1);
}

TEST(Profile, LeastOverTheOtherParameters) {
  const ParameterGrid grid{{axis("a", 2), axis("b", 3), axis("c", 2)}};
  GridSearchResult result;
  result.evaluated = {{{0, 1, 0}, 5.0}, {{0, 1, 1}, 4.0}, {{1, 2, 0}, 3.0}};
  const std::vector<std::vector<double>> least = profile(grid, result, 0, 1);
  ASSERT_EQ(least.size(), 3u);
  EXPECT_EQ(least[1][0], 4.0);
  EXPECT_EQ(least[2][1], 3.0);
  EXPECT_TRUE(std::isnan(least[0][0]));
}

}  // namespace
}  // namespace foucault::tuning
