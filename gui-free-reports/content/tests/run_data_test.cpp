#include "run_data.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foucault/core/time.h"

namespace foucault::content {
namespace {

TEST(AxisStatistics, AreRmsAndShareInsideThreeSigmaOfWhatIsFinite) {
  AxisStatistics statistics;
  EXPECT_EQ(statistics.rms(), Eigen::Vector3d::Zero()) << "of nothing";
  const Eigen::Vector3d sigma(1, 1, 0.5);
  statistics.add({3, 0, 4}, sigma);
  statistics.add({4, 0, 0}, sigma);
  statistics.add({std::numeric_limits<double>::quiet_NaN(), 0, 0}, sigma);
  EXPECT_EQ(statistics.count(), 2U);
  EXPECT_TRUE(statistics.rms().isApprox(Eigen::Vector3d(std::sqrt(12.5), 0, std::sqrt(8.0))));
  EXPECT_EQ(statistics.inside_3_sigma(), Eigen::Vector3d(0.5, 1, 0.5));
}

TEST(AxisStatistics, TellMeanQuantilesAndTheLargest) {
  AxisStatistics statistics;
  for (int i = 0; i <= 100000; ++i) {
    statistics.add({i % 2 == 0 ? 1.0 * i : -1.0 * i, 2, -3}, Eigen::Vector3d::Ones());
  }
  EXPECT_NEAR(statistics.mean().x(), 50000.0 / 100001, 1e-9);
  EXPECT_NEAR(statistics.quantile(0.5).x(), 50000, 20) << "of every eighth";
  EXPECT_NEAR(statistics.quantile(0.95).x(), 95000, 20);
  EXPECT_EQ(statistics.largest(), Eigen::Vector3d(100000, 2, 3));
  EXPECT_EQ(statistics.quantile(0.5).z(), 3);
}

TEST(Triad, CountsFromItsSettlingTimeOnAndKeepsAllRows) {
  Triad triad;
  EXPECT_TRUE(triad.empty());
  triad.statistics_from = 10;
  for (const double t : {9.0, 10.0}) triad.add(t, {t, 0, 0}, {1, 2, 3});
  EXPECT_EQ(triad.statistics.count(), 1U);
  EXPECT_EQ(triad.rows.rows().columns.at(5), (std::vector<double>{3, 3}));
}

TEST(Stretches, GoOnUntilTheNextBegins) {
  Stretches stretches;
  stretches.extend(5);  // of nothing
  EXPECT_TRUE(stretches.empty());
  stretches.begin(10);
  stretches.extend(12);
  stretches.extend(11);
  stretches.begin(3);
  ASSERT_EQ(stretches.intervals().size(), 2U);
  EXPECT_EQ(stretches.intervals()[0].begin, 3) << "in order";
  EXPECT_EQ(stretches.intervals()[1].length(), 2);
}

TEST(Stretches, CloseOnesAreJoinedOnceThereAreTooMany) {
  Stretches stretches;
  for (int i = 0; i < 5000; ++i) {
    stretches.begin(i % 2 == 0 ? 10.0 * i : 10.0 * i - 8);  // pauses of 1 and 17 s
    stretches.extend(i % 2 == 0 ? 10.0 * i + 1 : 10.0 * i - 7);
  }
  const std::vector<Interval> intervals = stretches.intervals();
  EXPECT_LE(intervals.size(), 1001U);
  EXPECT_EQ(intervals.front().begin, 0);
  EXPECT_EQ(intervals.back().end, 10.0 * 4999 - 7);
}

TEST(StepWatch, TellsGapsFromUsualSteps) {
  StepWatch watch(0.2);
  EXPECT_FALSE(watch.observe(0));
  EXPECT_EQ(watch.duration(), 0);
  EXPECT_EQ(watch.rate(), 0);
  for (int i = 1; i <= 10; ++i) EXPECT_NEAR(*watch.observe(0.1 * i), 0.1, 1e-12);
  EXPECT_NEAR(watch.longest_usual(), 0.5, 1e-12);
  watch.observe(1.4);
  EXPECT_FALSE(watch.last_was_gap());
  watch.observe(3.4);
  EXPECT_TRUE(watch.last_was_gap());
  EXPECT_EQ(watch.gaps(), 1U);
  EXPECT_NEAR(watch.gap_duration(), 2, 1e-12);
  EXPECT_NEAR(watch.longest(), 2, 1e-12);
  EXPECT_NEAR(watch.rate(), 11 / 1.4, 1e-9) << "steps a second outside of the gap";
  EXPECT_EQ(watch.steps().rows_seen(), 12U);
}

TEST(StepWatch, KeepsTheLongestGapsInOrder) {
  StepWatch watch(0.5);
  double t = 0;
  for (int gap = 0; gap < 100; ++gap) {
    for (int i = 0; i < 9; ++i) watch.observe(t += 0.01);
    watch.observe(t += gap == 3 ? 1 : 2 + 0.01 * gap);
  }
  EXPECT_EQ(watch.gaps(), 100U);
  const std::vector<Interval> gaps = watch.longest_gaps();
  ASSERT_EQ(gaps.size(), 64U);
  for (size_t i = 1; i < gaps.size(); ++i) EXPECT_GT(gaps[i].begin, gaps[i - 1].begin);
  EXPECT_NEAR(gaps.front().length(), 2 + 0.01 * 36, 1e-9);
}

TEST(StartPlane, IsMetricAlongTheEllipsoid) {
  const StartPlane plane({0.7, M_PI - 1e-5, 100});
  const Eigen::Vector3d p = plane.north_east_up({0.7 + 1e-4, -M_PI + 1e-5, 90});
  EXPECT_NEAR(p.x(), 636.21, 0.01);
  EXPECT_NEAR(p.y(), 2e-5 * 6387120 * std::cos(0.70005), 0.01) << "over the date line";
  EXPECT_EQ(p.z(), -10);
}

TEST(RunData, OutagesAreRelativeToTheFirstStamp) {
  RunData data(state::Mounting{}, {});
  data.add_outage(nanoseconds(105), nanoseconds(165));
  EXPECT_TRUE(data.outages().empty()) << "no start yet";
  data.add_imu_stamp(nanoseconds(100));
  ASSERT_EQ(data.outages().size(), 1U);
  EXPECT_EQ(data.outages()[0].begin, 5);
  EXPECT_EQ(data.outages()[0].end, 65);
}

TEST(RunData, SquaresGoWhereTheyBelong) {
  RunData data(state::Mounting{}, {});
  for (const NormalizedKind kind : {NormalizedKind::innovation, NormalizedKind::position,
                                    NormalizedKind::velocity, NormalizedKind::attitude}) {
    NormalizedSquare square;
    square.kind = kind;
    square.value = 1 + static_cast<double>(kind);
    data.add(square);
  }
  NormalizedSquare rejected;
  rejected.used = false;
  rejected.value = 50;
  data.add(rejected);
  EXPECT_EQ(data.nis.rows().columns[0], std::vector<double>{1});
  EXPECT_TRUE(std::isnan(data.nis.rows().columns[1][0])) << "no running mean yet";
  EXPECT_EQ(data.rejected_nis.rows().columns[0], std::vector<double>{50});
  EXPECT_EQ(data.position_nees.rows().columns[0], std::vector<double>{2});
  EXPECT_EQ(data.velocity_nees.rows().columns[0], std::vector<double>{3});
  EXPECT_EQ(data.attitude_nees.rows().columns[0], std::vector<double>{4});
}

TEST(RunData, CountsFixesByQualityAndVerdict) {
  RunData data(state::Mounting{}, {});
  state::FixResult fix;
  fix.quality = FixQuality::ppp;
  data.add(fix);
  EXPECT_EQ(data.not_used_name(), "rejected");
  fix.verdict = state::FixVerdict::corrected;
  fix.t_ns = nanoseconds(1);
  data.add(fix);
  EXPECT_EQ(data.not_used_name(), "rejected or corrected");
  EXPECT_EQ(data.qualities.at(FixQuality::ppp), 2U);
  EXPECT_EQ(data.verdicts.at(state::FixVerdict::corrected), 1U);
  EXPECT_EQ(data.rejected_innovation.rows.rows_seen(), 1U);
}

TEST(RunData, KeepsTheFirstNoticesAndCountsAll) {
  RunData data(state::Mounting{}, {});
  for (int i = 0; i < 300; ++i) data.add(state::Notice{i, state::NoticeKind::skipped, ""});
  EXPECT_EQ(data.notices.size(), 200U);
  EXPECT_EQ(data.notices_seen, 300U);
}

}  // namespace
}  // namespace foucault::content
