#include "foucault/diagnosis/judgement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "foucault/core/time.h"

namespace foucault::diagnosis {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Of a recording without any fault.
LogFacts good() {
  LogFacts facts;
  facts.imu = {10000, 0, nanoseconds(100), 0.01, 0, 0};
  facts.gnss = {101, 0, nanoseconds(100), 1, 0, 0};
  facts.overlap_s = 100;
  facts.sigmas = {0, 0.02, 1.5};
  facts.lever_arm_m = 0.5;
  facts.lever_arm_known = true;
  facts.force.mean = {0, 0, -9.8};
  facts.force.length = 9.8;
  facts.force.seconds = 100;
  facts.force.factor = MeasuredFactor{1, 0.01, 30};
  facts.rest.seconds = 30;
  facts.rest.gyro_noise_density = 4e-5;
  facts.rest.accel_noise_density = 2e-4;
  facts.turns = TurnMatch();
  facts.turns->slope = facts.turns->correlation = 1;
  facts.turns->gyro_factor = MeasuredFactor{1, 0.01, 30};
  facts.turns->samples = 100;
  facts.accelerations = AccelerationFit{{0, 0.01}, 0.95, {0, 0.01}, false, true, 100};
  return facts;
}

std::vector<Finding> judged(const LogFacts& facts) {
  return judge(facts, imu::imu_preset("ADIS16465"));
}

/// All that is not ok, a line each.
std::string complaints(const LogFacts& facts) {
  std::string text;
  for (const Finding& f : judged(facts)) {
    EXPECT_EQ(f.remedy.empty(), f.severity == Severity::ok) << f.subject;
    if (f.severity == Severity::ok) continue;
    text += (f.severity == Severity::error ? "error " : "warning ") + f.subject + ": " + f.text +
            " -> " + f.remedy + "\n";
  }
  return text;
}

TEST(Judgement, AGoodRecordingIsWell) {
  EXPECT_EQ(complaints(good()), "");
  EXPECT_EQ(judged(good()).size(), 11u);
  LogFacts few = good();
  few.turns.reset();
  few.accelerations.reset();
  few.force.factor.reset();
  few.lever_arm_m.reset();
  few.rest.seconds = 9;
  EXPECT_EQ(complaints(few), "");
}

/// Each change and what is said of it.
class Complaint : public ::testing::Test {
 protected:
  LogFacts facts_ = good();
};

TEST_F(Complaint, Streams) {
  facts_.imu.longest_hole_s = 0.11;
  facts_.gnss.longest_hole_s = 31;
  EXPECT_THAT(complaints(facts_), AllOf(HasSubstr("warning IMU:"), HasSubstr("warning GNSS:")));
  facts_ = good();
  facts_.imu.interval_s = 0.5;
  EXPECT_THAT(complaints(facts_), HasSubstr("record more often"));
  facts_ = LogFacts();
  EXPECT_THAT(complaints(facts_), AllOf(HasSubstr("error IMU: no data"), HasSubstr("error GNSS")));
}

TEST_F(Complaint, Overlap) {
  facts_.gnss.first_ns = nanoseconds(60);
  facts_.gnss.last_ns = nanoseconds(160);
  facts_.overlap_s = 40;
  EXPECT_THAT(complaints(facts_), HasSubstr("warning overlap: 40.0 s in common"));
  facts_.gnss.first_ns = nanoseconds(200);
  facts_.overlap_s = -100;
  EXPECT_THAT(complaints(facts_), HasSubstr("error overlap: IMU and GNSS have no time in common"));
}

TEST_F(Complaint, WeeksModulo1024) {
  const int64_t days = 24 * 3600 * kNanosecondsPerSecond;
  facts_.imu.first_ns = facts_.gnss.first_ns = 5424 * days;  // 1984-11-07
  facts_.imu.last_ns = facts_.gnss.last_ns = 5424 * days + nanoseconds(100);
  EXPECT_THAT(complaints(facts_), AllOf(HasSubstr("warning date: the recording is of 1984-11-07"),
                                        HasSubstr("2004-06-23"), HasSubstr("2024-02-07")));
  facts_.imu.first_ns = facts_.gnss.first_ns = 11000 * days;  // 2000-02-13
  facts_.imu.last_ns = facts_.gnss.last_ns = 11000 * days + nanoseconds(100);
  EXPECT_EQ(complaints(facts_), "");
}

TEST_F(Complaint, AReferenceOfAnotherPlace) {
  facts_.reference = {11, 6, 62854};
  EXPECT_THAT(complaints(facts_), HasSubstr("warning reference: 6.285e+04 m (RMS) from fixes"));
  facts_.reference = {12, 6, 300};  // some fixes may be wrong
  EXPECT_EQ(complaints(facts_), "");
}

TEST_F(Complaint, SamplesAndFixesThatWereLeftOut) {
  facts_.bad_samples = {"3 IMU samples"};
  facts_.bad_fixes = {"4 fixes"};
  EXPECT_THAT(complaints(facts_), AllOf(HasSubstr("warning IMU samples: 3 IMU samples"),
                                        HasSubstr("warning GNSS fixes: 4 fixes")));
}

TEST_F(Complaint, Sigmas) {
  facts_.sigmas.bad = 5;
  EXPECT_THAT(complaints(facts_), HasSubstr("warning sigmas: 5 of 101 fixes have a sigma that"));
  facts_.sigmas.bad = 101;
  EXPECT_THAT(complaints(facts_), ::testing::Not(HasSubstr("which no receiver has")));
  facts_.sigmas = {0, 1e-5, 1};
  EXPECT_THAT(complaints(facts_), HasSubstr("which no receiver has"));
  facts_.sigmas = {0, 1, 2000};
  EXPECT_THAT(complaints(facts_), HasSubstr("which no receiver has"));
  facts_.sigmas = {0, 0.1, 1};
  facts_.rest.fix_pairs = 20;
  facts_.rest.fix_scatter = 4.2;
  EXPECT_THAT(complaints(facts_), HasSubstr("scatter 4.2 times as much -> gnss.sigma_scale=5"));
}

TEST_F(Complaint, LeverArm) {
  facts_.lever_arm_m = 0;
  EXPECT_THAT(complaints(facts_), Not(HasSubstr("lever arm")));  // it was given
  facts_.lever_arm_known = false;
  EXPECT_THAT(complaints(facts_), HasSubstr("warning lever arm: not known"));
  facts_.lever_arm_known = true;
  facts_.lever_arm_m = 50;
  EXPECT_THAT(complaints(facts_), HasSubstr("is it in metres"));
}

TEST_F(Complaint, Force) {
  facts_.force.factor->value = 0.5;
  EXPECT_THAT(complaints(facts_), HasSubstr("error specific force: specific force is 0.5"));
  facts_.force.factor->value = 1;
  facts_.force.mean.z() = 9.8;
  EXPECT_THAT(complaints(facts_), HasSubstr("error gravity:"));
  facts_.force.mean.z() = 2;  // rolls and loops have no up
  EXPECT_EQ(complaints(facts_), "");
}

TEST_F(Complaint, ARateThatIsTooLow) {
  facts_.commutation = {100, 1e-6, 1e-6};
  EXPECT_EQ(complaints(facts_), "");
  facts_.commutation.drift = 4e-5;  // 8 deg/h, of 2
  EXPECT_THAT(complaints(facts_),
              HasSubstr("warning IMU rate: rotations between samples cost 8.3"));
  facts_.commutation = {100, 0, 2e-4};
  EXPECT_THAT(complaints(facts_), HasSubstr("warning IMU rate"));
  facts_.force.factor->value = 0.5;  // of which rates are no rates either
  EXPECT_THAT(complaints(facts_), ::testing::Not(HasSubstr("IMU rate")));
}

TEST_F(Complaint, Axes) {
  facts_.accelerations->angle.value = 3;
  EXPECT_THAT(complaints(facts_), HasSubstr("warning axes: forces are 172 deg (sigma 1) to the "
                                            "right"));
  EXPECT_THAT(complaints(facts_), HasSubstr("forward is backward"));
  facts_.accelerations->angle.value = -1.6;
  EXPECT_THAT(complaints(facts_), HasSubstr("forward is sideways"));
  facts_.accelerations->correlation = 0.4;  // a vehicle of its own ways
  EXPECT_EQ(complaints(facts_), "");
}

TEST_F(Complaint, Sides) {
  facts_.turns->correlation = -0.95;
  EXPECT_THAT(complaints(facts_), HasSubstr("error axes: the gyroscopes turn against"));
  facts_.turns->correlation = -0.6;
  EXPECT_THAT(complaints(facts_), HasSubstr("warning axes: the gyroscopes turn against"));
  facts_.force.mean.z() = 9.8;
  EXPECT_THAT(complaints(facts_), AllOf(HasSubstr("error gravity"), HasSubstr("accel_sign: -1"),
                                        ::testing::Not(HasSubstr("correct the axes"))));
}

/// Turns see slip and arms as an offset, so forces must see it.
TEST_F(Complaint, Offsets) {
  facts_.turns->offset_s = -0.08;
  facts_.turns->offset_sigma_s = 0.01;
  EXPECT_EQ(complaints(facts_), "");
  facts_.accelerations->offset_s = {-0.07, 0.008};
  EXPECT_THAT(complaints(facts_),
              AllOf(HasSubstr("0.070 s (sigma 0.008) before those of GNSS by accelerations, 0.080"),
                    HasSubstr("offset_s: 0.070")));
  facts_.turns->offset_sigma_s = 0.05;
  EXPECT_THAT(complaints(facts_), HasSubstr("time offset"));
  facts_.lever_arm_m.reset();  // it may be of an antenna that is ahead
  EXPECT_EQ(complaints(facts_), "");
  facts_.accelerations.reset();
  EXPECT_EQ(complaints(facts_), "");
  facts_.turns->offset_s = 0.3;  // steps and slip make it
  EXPECT_EQ(complaints(facts_), "");
}

TEST_F(Complaint, Turns) {
  facts_.turns->drift = Measured{200e-6, 10e-6};
  EXPECT_THAT(complaints(facts_), HasSubstr("warning clock drift"));
  facts_.turns->drift->sigma = 100e-6;
  EXPECT_EQ(complaints(facts_), "");
  facts_.turns->offset_s = 7;
  EXPECT_EQ(complaints(facts_), "");
  facts_.turns->turned = 7;
  EXPECT_THAT(complaints(facts_), HasSubstr("error time offset: stamps of the IMU are 7.00 s"));
  facts_.turns->correlation = 0.7;
  EXPECT_EQ(complaints(facts_), "");  // as noise makes it
  facts_.turns->misfit = 5;
  EXPECT_EQ(complaints(facts_), "");  // as a copter does
}

TEST_F(Complaint, Noise) {
  facts_.rest.gyro_noise_density *= 10;
  facts_.rest.accel_noise_density /= 100;
  facts_.rest.gyro_mean = 0.01;
  EXPECT_THAT(complaints(facts_),
              AllOf(HasSubstr("warning gyroscope noise"), HasSubstr("of a much worse IMU"),
                    HasSubstr("gyroscope bias: 2.06e+03 deg/h at rest")));
}

/// What a whole recording has shown stands; an engine at rest is no reason to tell another one.
TEST_F(Complaint, NoneOfNoiseThatTheRecordingHasTold) {
  facts_.rest.gyro_noise_density *= 10;
  imu::ImuNoise learned = imu::imu_preset("ADIS16465");
  const auto names_noise = [&] {
    const std::vector<Finding> findings = judge(facts_, learned);
    return std::any_of(findings.begin(), findings.end(),
                       [](const Finding& f) { return f.subject == "gyroscope noise"; });
  };
  EXPECT_TRUE(names_noise());
  learned.learned = true;
  EXPECT_FALSE(names_noise());
}

}  // namespace
}  // namespace foucault::diagnosis
