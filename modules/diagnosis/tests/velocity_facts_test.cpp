#include "foucault/diagnosis/velocity_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "foucault/core/constants.h"
#include "foucault/diagnosis/judgement.h"
#include "foucault/diagnosis/log_facts.h"
#include "foucault/geodesy/place.h"
#include "foucault/imu/imu_noise.h"

namespace foucault::diagnosis {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using Spoil = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// A car on a circle of 12 m/s; positions of 1.5 m, velocities as `spoil` leaves them.
VelocityFacts facts_of(const Spoil& spoil, int fixes = 200) {
  std::mt19937 rng{7};
  std::normal_distribution<double> normal;
  VelocityWatch watch;
  GnssFix fix;
  fix.antenna = {50 * kDegree, 8 * kDegree, 100};
  Geodetic truth = fix.antenna;
  for (int i = 0; i < fixes; ++i) {
    const double course = 0.05 * i;
    const Eigen::Vector3d velocity = 12 * Eigen::Vector3d(std::cos(course), std::sin(course), 0);
    const geodesy::Place place(truth);
    truth = geodesy::displaced(truth, velocity, place);
    fix.t_ns += 1'000'000'000;
    fix.antenna = geodesy::displaced(
        truth, 1.5 * Eigen::Vector3d::NullaryExpr([&] { return normal(rng); }), place);
    fix.velocity_n = spoil(velocity);
    watch.add(fix);
  }
  return watch.facts();
}

std::string said_of(const VelocityFacts& velocities) {
  LogFacts facts;
  facts.velocities = velocities;
  for (const Finding& finding : judge(facts, imu::imu_preset("ADIS16465"))) {
    if (finding.subject != "velocities") continue;
    return finding.severity == Severity::ok ? "ok" : finding.text + " -> " + finding.remedy;
  }
  return "nothing";
}

TEST(VelocityFacts, OfSoundVelocities) {
  const VelocityFacts facts = facts_of([](const auto& v) { return v; });
  EXPECT_FALSE(facts.mirrored);
  EXPECT_LT(std::abs(facts.scale - 1), 4 * facts.sigma + 0.01);  // the chord of a turn is shorter
  EXPECT_LT(facts.sigma, 0.03);
  EXPECT_EQ(said_of(facts), "ok");
}

TEST(VelocityFacts, UnitsAndSignsAreNamed) {
  EXPECT_THAT(said_of(facts_of([](const auto& v) { return Eigen::Vector3d(v * 3600 / 1852); })),
              HasSubstr("velocity_unit: knots"));
  EXPECT_THAT(said_of(facts_of([](const auto& v) { return Eigen::Vector3d(v * 3.6); })),
              HasSubstr("velocity_unit: km_h"));
  EXPECT_THAT(said_of(facts_of([](const auto& v) { return Eigen::Vector3d(v.y(), v.x(), 0); })),
              HasSubstr("exchanged"));
  EXPECT_THAT(said_of(facts_of([](const auto& v) { return Eigen::Vector3d(v.x(), -v.y(), 0); })),
              HasSubstr("a sign is wrong"));
  EXPECT_THAT(said_of(facts_of([](const auto& v) { return Eigen::Vector3d(-v); })),
              HasSubstr("178 deg"));
}

TEST(VelocityFacts, OfFewPairsNothingIsSaid) {
  const VelocityFacts facts = facts_of([](const auto& v) { return Eigen::Vector3d(2 * v); }, 15);
  EXPECT_EQ(said_of(facts), "nothing");
}

}  // namespace
}  // namespace foucault::diagnosis
