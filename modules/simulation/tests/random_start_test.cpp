#include "foucault/simulation/random_start.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault::simulation {
namespace {

constexpr int64_t kStarts = 200;

const std::vector<RandomStart>& starts() {
  static const std::vector<RandomStart> kDrawn = [] {
    std::vector<RandomStart> all;
    for (int64_t seed = 1; seed <= kStarts; ++seed) all.push_back(random_start(seed));
    return all;
  }();
  return kDrawn;
}

/// `count` is what a draw of 200 with this probability gives: within four sigma.
void expect_share(double count, double probability) {
  const double sigma = std::sqrt(kStarts * probability * (1 - probability));
  EXPECT_NEAR(count, kStarts * probability, 4 * sigma);
}

double count(const std::function<bool(const ScenarioOptions&)>& choice) {
  double n = 0;
  for (const RandomStart& start : starts()) n += choice(start.scenario);
  return n;
}

TEST(RandomStart, DrawsEveryMotionAndImu) {
  std::map<std::string, double> motions, imus;
  for (const RandomStart& start : starts()) {
    ++motions[start.scenario.name];
    ++imus[start.imu];
  }
  EXPECT_EQ(motions.size(), 9u);
  for (const auto& [name, n] : motions) expect_share(n, 1.0 / 9);
  EXPECT_EQ(imus.size(), imu::imu_preset_names().size());
  for (const auto& [name, n] : imus) expect_share(n, 1.0 / static_cast<double>(imus.size()));
}

TEST(RandomStart, DrawsEveryKindOfFix) {
  expect_share(count([](const auto& s) { return s.gnss_sigma_m.x() <= 0.02; }), 0.5);
  expect_share(count([](const auto& s) {
                 return s.gnss_quality == "single" && s.gnss_velocity_sigma_m_s == 0;
               }),
               0.25);
  expect_share(count([](const auto& s) { return s.gnss_velocity_sigma_m_s >= 0.05; }), 0.25);
  EXPECT_EQ(count([](const auto& s) {
              const bool rtk = s.gnss_quality == "fixed_rtk" && s.gnss_sigma_m.x() < 0.021;
              return rtk || (s.gnss_quality == "single" && s.gnss_sigma_m.x() > 1.49);
            }),
            kStarts);
  // sqrt(0.2 * 10) Hz halves the logarithms.
  expect_share(count([](const auto& s) { return s.gnss_rate_hz < std::sqrt(2.0); }), 0.5);
  EXPECT_GT(count([](const auto& s) { return s.gnss_rate_hz < 0.3; }), 5);
  EXPECT_GT(count([](const auto& s) { return s.gnss_rate_hz > 7; }), 5);
}

TEST(RandomStart, BeginsAtRestInMotionAndTurning) {
  double turning = 0;
  for (const RandomStart& start : starts()) {
    const Trajectory trip = make_trajectory(start.scenario);
    const double speed = trip.at(0).velocity_n.norm();
    const bool rests = start.scenario.rest_s > 0;
    EXPECT_EQ(start.scenario.duration_s, 180);
    if (rests) {
      EXPECT_GE(start.scenario.rest_s, 5);
      EXPECT_EQ(speed, 0);
      EXPECT_GT(trip.at(60).velocity_n.norm() + trip.at(75).velocity_n.norm(), 0);
    } else {
      EXPECT_GE(speed, 0.4) << start.scenario.name << start.scenario.seed;
    }
    turning += speed > 0 && std::abs(trip.at(0).omega_iv_v.z()) > 5 * kDegree;
  }
  expect_share(count([](const auto& s) { return s.rest_s > 0; }), 1.0 / 3);
  EXPECT_GT(turning, kStarts / 6);  // of the third that is to turn some cannot: a train
}

TEST(RandomStart, SameSeedSameStart) {
  for (int64_t seed : {3, 77}) {
    RandomStart a = random_start(seed), b = random_start(seed), other = random_start(seed + 1);
    EXPECT_EQ(dump_config(a.scenario), dump_config(b.scenario));
    EXPECT_EQ(a.imu, b.imu);
    EXPECT_NE(dump_config(a.scenario), dump_config(other.scenario));
  }
}

TEST(RandomStart, GivesRecordingsFromItsFirstFixOn) {
  for (std::size_t i = 0; i < 10; ++i) {
    const RandomStart& start = starts()[i];
    SimulatedSource source(start.scenario, imu::imu_preset(start.imu));
    int fixes = 0;
    while (const auto measurement = source.next()) {
      fixes += std::holds_alternative<GnssFix>(*measurement);
    }
    EXPECT_NEAR(fixes, 180 * start.scenario.gnss_rate_hz, 1);
  }
}

}  // namespace
}  // namespace foucault::simulation
