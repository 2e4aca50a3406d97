#include "foucault/plot/decimation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace foucault::plot {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(DecimatedTable, KeepsAShortStreamAsItIs) {
  DecimatedTable table(2, 100);
  for (int i = 0; i < 80; ++i) table.add(i, {std::sin(i), -1.0 * i});
  const DecimatedTable::Rows rows = table.rows();
  ASSERT_EQ(rows.x.size(), 80U);
  for (size_t i = 0; i < 80; ++i) {
    EXPECT_EQ(rows.x[i], static_cast<double>(i));
    EXPECT_EQ(rows.columns[1][i], -static_cast<double>(i));
  }
}

TEST(DecimatedTable, StaysBoundedAndInOrder) {
  DecimatedTable table(3, 1000);
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300000; ++i) {
    table.add(i, {normal(rng), normal(rng), normal(rng)});
    if (i % 50000 == 0) {
      EXPECT_LE(table.rows().x.size(), 1000U);
    }
  }
  const DecimatedTable::Rows rows = table.rows();
  EXPECT_LE(rows.x.size(), 1000U);
  EXPECT_GE(rows.x.size(), 400U) << "it should use the room it has";
  EXPECT_TRUE(std::is_sorted(rows.x.begin(), rows.x.end()));
  EXPECT_EQ(table.rows_seen(), 300000U);
}

TEST(DecimatedTable, NeverLosesAnExtreme) {
  DecimatedTable table(2, 200);
  std::mt19937 rng{7};
  std::normal_distribution<double> normal;
  double lowest = 0;
  double highest = 0;
  for (int i = 0; i < 50000; ++i) {
    const double a = normal(rng) + (i == 31234 ? 50 : 0);
    const double b = normal(rng) - (i == 777 ? 90 : 0);
    highest = std::max(highest, a);
    lowest = std::min(lowest, b);
    table.add(i, {a, b});
  }
  const DecimatedTable::Rows rows = table.rows();
  const auto peak = std::max_element(rows.columns[0].begin(), rows.columns[0].end());
  EXPECT_EQ(*peak, highest);
  EXPECT_EQ(rows.x[static_cast<size_t>(peak - rows.columns[0].begin())], 31234);
  EXPECT_EQ(*std::min_element(rows.columns[1].begin(), rows.columns[1].end()), lowest);
}

/// Wherever one looks, the highest row of a stretch is kept, or a higher one of its bucket.
TEST(DecimatedTable, KeepsTheEnvelope) {
  DecimatedTable table(1, 400);
  std::vector<double> all;
  for (int i = 0; i < 40000; ++i) {
    all.push_back(std::sin(i * 1e-3) + 0.3 * std::sin(i * 0.9));
    table.add(i, {all.back()});
  }
  const DecimatedTable::Rows rows = table.rows();
  constexpr int kBucket = 512;  // rows a bucket at most: 2 kept of each, 400 in all
  for (int begin = 0; begin < 40000; begin += 1000) {
    double kept = -10;
    for (size_t i = 0; i < rows.x.size(); ++i) {
      const bool is_near = rows.x[i] > begin - kBucket && rows.x[i] < begin + 1000 + kBucket;
      if (is_near) kept = std::max(kept, rows.columns[0][i]);
    }
    EXPECT_GE(kept, *std::max_element(all.begin() + begin, all.begin() + begin + 1000));
  }
}

TEST(DecimatedTable, MarksGaps) {
  DecimatedTable table(1, 100);
  table.add_gap();  // before the first row: nothing to part
  table.add(0, {1});
  table.add(1, {2});
  table.add_gap();
  table.add(11, {3});
  const DecimatedTable::Rows rows = table.rows();
  ASSERT_EQ(rows.x.size(), 4U);
  EXPECT_EQ(rows.x[2], 6);
  EXPECT_TRUE(std::isnan(rows.columns[0][2]));
}

TEST(DecimatedTable, KeepsAGapWhenRowsAreThinned) {
  DecimatedTable table(1, 64);
  for (int i = 0; i < 20000; ++i) {
    if (i == 12345) table.add_gap();
    table.add(i, {std::cos(i * 0.1)});
  }
  const DecimatedTable::Rows rows = table.rows();
  EXPECT_EQ(std::count_if(rows.columns[0].begin(), rows.columns[0].end(),
                          [](double v) { return std::isnan(v); }),
            1);
}

TEST(DecimatedTable, SurvivesNumbersThatAreNotFinite) {
  DecimatedTable table(1, 64);
  for (int i = 0; i < 5000; ++i) table.add(i, {i == 2500 ? 9.0 : kNaN});
  const DecimatedTable::Rows rows = table.rows();
  EXPECT_EQ(std::count(rows.columns[0].begin(), rows.columns[0].end(), 9.0), 1);
}

TEST(DecimatedTable, RefusesWrongShapes) {
  EXPECT_THROW(DecimatedTable(0), std::invalid_argument);
  EXPECT_THROW(DecimatedTable(4, 8), std::invalid_argument);
  DecimatedTable table(2);
  EXPECT_THROW(table.add(0, {1}), std::invalid_argument);
}

}  // namespace
}  // namespace foucault::plot
