#include "foucault/diagnosis/force_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace foucault::diagnosis {
namespace {

using ::testing::HasSubstr;

constexpr double kG = 9.80665;

std::string wrong_mean(double length, double seconds = 10, double interval_s = 0.01) {
  ForceFacts facts;
  facts.mean.z() = -length;
  facts.length = length;
  facts.seconds = seconds;
  facts.interval_s = interval_s;
  const auto wrong = wrong_force(facts);
  return wrong ? wrong->text + "; " + wrong->remedy : "";
}

std::string wrong_factor(double factor, double sigma = 0.01) {
  ForceFacts facts;
  facts.length = kG;
  facts.factor = MeasuredFactor{factor, sigma, 20};
  const auto wrong = wrong_force(facts);
  return wrong ? wrong->text + "; " + wrong->remedy : "";
}

TEST(MeanForce, MeansTheVectorAndItsLength) {
  MeanForce mean;
  EXPECT_EQ(mean.facts().seconds, 0);
  ImuIncrement increment;
  increment.t_end_ns = 500'000'000;
  increment.dvel_b = {0, 3, -4};
  mean.add(increment);
  increment.dvel_b = {0, -3, -4};
  mean.add(increment);
  EXPECT_EQ(mean.facts().seconds, 1);
  EXPECT_EQ(mean.facts().interval_s, 0.5);
  EXPECT_TRUE(mean.facts().mean.isApprox(Eigen::Vector3d(0, 0, -8)));
  EXPECT_DOUBLE_EQ(mean.facts().length, 10);
}

TEST(WrongForce, RestInOtherUnitsIsTold) {
  EXPECT_THAT(wrong_mean(1), HasSubstr("in g, not m/s^2; name the unit"));
  EXPECT_THAT(wrong_mean(1000), HasSubstr("in mg,"));
  EXPECT_THAT(wrong_mean(981), HasSubstr("in cm/s^2,"));
}

TEST(WrongForce, IncrementsAreTold) {
  EXPECT_THAT(wrong_mean(0.02 * kG, 61, 0.02), HasSubstr("in m/s, increments over the 0.02 s"));
  EXPECT_THAT(wrong_mean(0.01 * kG, 61, 0.01), HasSubstr("accel_unit: m_s, gyro_unit: rad"));
  EXPECT_EQ(wrong_mean(0.02 * kG, 10, 0.02), "");
  EXPECT_THAT(wrong_mean(0.02 * kG, 61, 0.01), HasSubstr("wrong units"));
  // In g at 10 Hz, too.
  EXPECT_THAT(wrong_mean(1, 10, 0.1), HasSubstr("in g, not m/s^2"));
}

/// Turns of 6 g, a minute of free fall but a few seconds: vehicles do that.
TEST(WrongForce, AMeanIsRefusedOnlyIfNoVehicleHasIt) {
  for (const double g : {0.4, 1.0, 3.0, 6.0, 12.0}) EXPECT_EQ(wrong_mean(g * kG), "") << g;
  EXPECT_EQ(wrong_mean(0.2 * kG, 25), "");
  EXPECT_THAT(wrong_mean(0.2 * kG, 61), HasSubstr("wrong units, or gravity taken out"));
  EXPECT_THAT(wrong_mean(40 * kG), HasSubstr("wrong units, or gravity taken out"));
}

/// The longer it lasts, the less a change of velocity can take from gravity.
TEST(WrongForce, HalfOfGravityOverMinutesIsNone) {
  EXPECT_EQ(wrong_mean(0.58 * kG, 60), "") << "a parabolic flight";
  EXPECT_EQ(wrong_mean(0.49 * kG, 70), "");
  EXPECT_THAT(wrong_mean(0.49 * kG, 149), HasSubstr("4.81 m/s^2 where gravity is 9.8"));
  EXPECT_EQ(wrong_mean(0.9 * kG, 3600), "") << "scale and offset of a cheap accelerometer";
}

TEST(WrongForce, AFactorDecidesWhereThereIsOne) {
  EXPECT_EQ(wrong_factor(1.1), "");
  EXPECT_EQ(wrong_factor(1.4, 0.1), "");  // it is not sure
  EXPECT_THAT(wrong_factor(1.4), HasSubstr("1.400 (sigma 0.010) times what gravity"));
  EXPECT_THAT(wrong_factor(1.4), HasSubstr("correct unit or scale"));
  EXPECT_THAT(wrong_factor(0.102, 0.001), HasSubstr("in g, not"));
  ForceFacts turning;
  turning.length = 40 * kG;
  turning.factor = MeasuredFactor{1, 0.01, 20};
  EXPECT_FALSE(wrong_force(turning));
}

}  // namespace
}  // namespace foucault::diagnosis
