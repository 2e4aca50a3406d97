#include "foucault/evaluation/distance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "foucault/evaluation/outage_join.h"

namespace foucault::evaluation {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<double> evenly(int count, double last) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(last * i / (count - 1));
  return values;
}

TEST(DistanceBins, NoneNearTheStart) {
  EXPECT_THAT(distance_bins({}), IsEmpty());
  EXPECT_THAT(distance_bins(evenly(30, 9.9)), IsEmpty());
  EXPECT_THAT(distance_bins({kNaN, kNaN}), IsEmpty());
}

TEST(DistanceBins, RoundBordersAndEveryOutageOnce) {
  const std::vector<double> distances = evenly(60, 540);
  const std::vector<DistanceBin> bins = distance_bins(distances);
  ASSERT_THAT(bins, SizeIs(6));
  std::size_t outages = 0;
  for (std::size_t b = 0; b < bins.size(); ++b) {
    EXPECT_EQ(bins[b].from_km, 100.0 * static_cast<double>(b));
    EXPECT_EQ(bins[b].to_km, bins[b].from_km + 100);
    outages += bins[b].outages.size();
    for (const std::size_t i : bins[b].outages) {
      EXPECT_GE(distances[i], bins[b].from_km);
      EXPECT_LT(distances[i], bins[b].to_km);
    }
  }
  EXPECT_EQ(outages, distances.size());
}

TEST(DistanceBins, NeighboursAreJoinedUntilThereAreEnough) {
  // Of 31: three within 20 km, three up to 40 km, 24 up to 60 km, one at the end; one elsewhere.
  std::vector<double> distances{1, 2, 15, 21, 25, 30};
  distances.insert(distances.end(), 24, 45);
  distances.insert(distances.end(), {62, kNaN});
  const std::vector<DistanceBin> bins = distance_bins(distances);
  ASSERT_THAT(bins, SizeIs(2));
  EXPECT_EQ(bins[0].from_km, 0);
  EXPECT_EQ(bins[0].to_km, 40);
  EXPECT_THAT(bins[0].outages, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_EQ(bins[1].from_km, 40);
  EXPECT_EQ(bins[1].to_km, 80);
  EXPECT_THAT(bins[1].outages, SizeIs(25));
}

/// Outages every 5 km whose drift grows with distance for `lost`, and not for `kept`.
class Profile : public testing::Test {
 protected:
  Profile() {
    for (const char* method : {"kept", "lost"}) {
      ExperimentResult result;
      result.recording = "trip";
      result.imu = "IMU";
      result.method = method;
      for (int i = 0; i < 20; ++i) {
        OutageDrift drift;
        drift.outage = {i, i * 100, i * 100 + 60};
        drift.distance_m = 5000.0 * i;
        drift.maximum.horizontal = 2 * (result.method == "lost" ? 1 + 0.1 * i : 1);
        drift.maximum.vertical = 1;
        result.run.drifts.push_back(drift);
      }
      result.run.scheduled = 20;
      results_.push_back(result);
    }
  }
  std::vector<ExperimentResult> results_;
};

TEST_F(Profile, NumbersOfEachBinAreThoseOfItsOutages) {
  const std::vector<DistanceProfile> profiles =
      distance_profiles(group_outages(results_, Grouping::imu));
  ASSERT_THAT(profiles, SizeIs(1));
  ASSERT_THAT(profiles[0].bins, SizeIs(2));  // 0-50 km and 50-100 km: of three bins 50 km is next
  const ProfileBin& far = profiles[0].bins[1];
  EXPECT_DOUBLE_EQ(far.mean_km, 72.5);
  ASSERT_THAT(far.methods, SizeIs(2));
  EXPECT_DOUBLE_EQ(far.methods[0].horizontal_m.value, 2);
  EXPECT_DOUBLE_EQ(far.methods[0].horizontal_relative.value, 0);
  double square = 0;
  for (int i = 10; i < 20; ++i) square += std::pow(2 * (1 + 0.1 * i), 2) / 10;
  EXPECT_NEAR(far.methods[1].horizontal_m.value, std::sqrt(square), 1e-12);
  EXPECT_NEAR(far.methods[1].horizontal_relative.value, std::sqrt(square) / 2 - 1, 1e-12);
  EXPECT_GT(far.methods[1].horizontal_relative.low, 1);
  EXPECT_DOUBLE_EQ(far.methods[1].vertical_relative.value, 0);
}

TEST_F(Profile, TablesHaveARowABinAndDirection) {
  const std::vector<DistanceProfile> profiles =
      distance_profiles(group_outages(results_, Grouping::imu));
  const TextTable drift = distance_table(profiles, "IMU");
  EXPECT_THAT(drift.header,
              ElementsAre("IMU", "Distance (km)", "Outages", "Direction", "kept", "lost"));
  ASSERT_THAT(drift.rows, SizeIs(4));
  EXPECT_THAT(drift.rows[3], ElementsAre("IMU", "50 to 100", "10", "vertical", "1.00 [1.00, 1.00]",
                                         "1.00 [1.00, 1.00]"));
  const TextTable difference = distance_difference_table(profiles, "IMU");
  EXPECT_EQ(difference.title, "Difference of RMS drift from kept in percent");
  EXPECT_THAT(difference.header,
              ElementsAre("IMU", "Distance (km)", "Outages", "Direction", "lost"));
  EXPECT_EQ(difference.rows[3].back(), "0.00 [0.00, 0.00]");
}

TEST_F(Profile, NoneWhereNothingIsFar) {
  for (ExperimentResult& result : results_) {
    for (OutageDrift& drift : result.run.drifts) drift.distance_m *= 0.01;
  }
  EXPECT_THAT(distance_profiles(group_outages(results_, Grouping::imu)), IsEmpty());
}

}  // namespace
}  // namespace foucault::evaluation
