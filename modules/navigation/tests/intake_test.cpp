#include "../src/intake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "fake_run.h"
#include "foucault/core/error.h"

namespace foucault::navigation {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace foucault::testing;  // NOLINT: measurements by milliseconds

class IntakeTest : public ::testing::Test {
 protected:
  Admitted admit(const Measurement& measurement) { return intake().admit(measurement); }
  Intake& intake() {
    if (!intake_) intake_.emplace(options_);
    return *intake_;
  }
  std::string error() {
    try {
      intake().throw_if_nothing_usable();
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  }

  NavigationRunOptions options_;
  std::optional<Intake> intake_;
};

TEST_F(IntakeTest, GoodMeasurementsPassAsTheyAre) {
  const Admitted increment = admit(increment_between(0, 10));
  ASSERT_TRUE(increment.measurement);
  EXPECT_EQ(std::get<ImuIncrement>(*increment.measurement).dvel_b, increment_between(0, 10).dvel_b);
  const Admitted fix = admit(fix_at(10));
  ASSERT_TRUE(fix.measurement);
  EXPECT_EQ(std::get<GnssFix>(*fix.measurement).position_covariance,
            fix_at(10).position_covariance);
  EXPECT_TRUE(admit(EpochRequest{at(20)}).measurement);
  EXPECT_THAT(intake().summary(0), IsEmpty());
  EXPECT_EQ(error(), "");
}

TEST_F(IntakeTest, TheUsualIntervalIsThatOfTheTime) {
  double t = 0;
  for (int i = 0; i < 100; ++i, t += 10) admit(increment_between(t, t + 10));
  EXPECT_NEAR(intake().usual_interval(), 0.01, 1e-12);
  admit(increment_between(t, t + 1e-4));  // a slip of a stamp
  EXPECT_NEAR(intake().usual_interval(), 0.01, 1e-8);
}

TEST_F(IntakeTest, AFixOfAnotherClockIsNeverSeen) {
  admit(increment_between(0, 10));
  const Admitted off = admit(fix_at(2 * 3600e3));
  EXPECT_FALSE(off.measurement);
  EXPECT_FALSE(off.left_out);
  EXPECT_THAT(error(), HasSubstr("do not overlap in time: the fixes are stamped"));
  EXPECT_THAT(intake().summary(0), ElementsAre(HasSubstr("1 fixes were left out")));
}

TEST_F(IntakeTest, FixesThatCannotBeAreShownAsLeftOut) {
  admit(increment_between(0, 10));
  admit(fix_at(10));
  EXPECT_EQ(admit(fix_at(10)).left_out, state::FixVerdict::out_of_order);
  GnssFix nowhere = fix_at(20);
  nowhere.antenna = Geodetic{};
  const Admitted none = admit(nowhere);
  EXPECT_FALSE(none.measurement);
  EXPECT_EQ(none.left_out, state::FixVerdict::bad_sigma);
  EXPECT_THAT(intake().summary(3),
              ElementsAre(HasSubstr("1 fixes"), HasSubstr("1 fixes repeat the one before"),
                          HasSubstr("3 fixes came after later ones")));
}

/// They pass, so that a run shows them; alone they are no recording.
TEST_F(IntakeTest, FixesWithoutSigmaAndOfLowQualityPassButAreNotUsable) {
  options_.gnss.min_quality = "fixed_rtk";
  admit(increment_between(0, 10));
  GnssFix bad = fix_at(10);
  bad.position_covariance.setZero();
  EXPECT_TRUE(admit(bad).measurement);
  GnssFix low = fix_at(1010);
  low.quality = FixQuality::single;
  EXPECT_TRUE(admit(low).measurement);
  EXPECT_THAT(error(), HasSubstr("none of the 2 GNSS fixes can be used: 1 with a sigma that"));
  EXPECT_THAT(error(), HasSubstr("1 below gnss.min_quality=fixed_rtk"));
  EXPECT_TRUE(admit(fix_at(2010)).measurement);
  EXPECT_EQ(error(), "");
}

TEST_F(IntakeTest, AidsThatAreOffAreTakenOffTheFix) {
  options_.aids.mode = "none";
  admit(increment_between(0, 10));
  EXPECT_FALSE(std::get<GnssFix>(*admit(fix_at(10)).measurement).velocity_n);
}

TEST_F(IntakeTest, AStuckAccelerometerGetsNoiseAndWeakensTheState) {
  Admitted admitted;
  for (int i = 0; i < 200; ++i) {
    ImuIncrement increment = increment_between(10 * i, 10 * i + 10);
    increment.dtheta_b = Vector3d(1e-4 * (i % 7), 2e-4 * (i % 5), 1e-4 * (i % 3));
    increment.dvel_b = Vector3d(5, 1e-3 * (i % 11), -9.8 + 1e-3 * (i % 13)) * increment.dt();
    admitted = admit(increment);
    ASSERT_TRUE(admitted.measurement);
  }
  EXPECT_TRUE(admitted.weakens_state);
  // An error that stays for 3 s, as white noise.
  EXPECT_NEAR(std::get<ImuIncrement>(*admitted.measurement).extra_accel_noise_density,
              options_.gaps.accel_sigma_m_s2 * std::sqrt(3), 1e-12);
}

TEST_F(IntakeTest, MostOfTheImuUnusableIsAnError) {
  for (int i = 0; i < 10; ++i) {
    ImuIncrement increment = increment_between(10 * i, 10 * i + 10);
    if (i % 5 > 0) increment.dvel_b.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(admit(increment).measurement.has_value(), i % 5 == 0);
  }
  EXPECT_THAT(error(), HasSubstr("sort the IMU data by time and remove what is damaged"));
}

TEST_F(IntakeTest, NothingIsAnErrorThatSaysWhatIsMissing) {
  EXPECT_THAT(error(), HasSubstr("no IMU data"));
  admit(increment_between(0, 10));
  EXPECT_THAT(error(), HasSubstr("no GNSS fix"));
}

}  // namespace
}  // namespace foucault::navigation
