#include "foucault/diagnosis/log_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/diagnosis/plausibility.h"
#include "foucault/diagnosis/turn_match.h"
#include "foucault/simulation/faults.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault::diagnosis {
namespace {

using ::testing::HasSubstr;

simulation::ScenarioOptions city(int64_t seed = 5) {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = 400;
  scenario.seed = seed;
  scenario.imu_rate_hz = 100;
  return scenario;
}

LogFacts facts_of(const simulation::ScenarioOptions& scenario,
                  const std::vector<simulation::Fault>& faults) {
  simulation::FaultySource source(
      std::make_unique<simulation::SimulatedSource>(scenario, imu::imu_preset("ADIS16465")), faults,
      1);
  LogChecker checker(imu::imu_preset("ADIS16465"), source.mounting());
  while (const std::optional<Measurement> m = source.next()) checker.add(*m);
  return checker.facts();
}

std::vector<Finding> findings_of(const simulation::ScenarioOptions& scenario,
                                 const std::vector<simulation::Fault>& faults) {
  return judge(facts_of(scenario, faults), imu::imu_preset("ADIS16465"));
}

Finding finding(const std::vector<Finding>& findings, const std::string& subject) {
  for (const Finding& f : findings) {
    if (f.subject == subject) return f;
  }
  ADD_FAILURE() << "nothing about " << subject;
  return {};
}

TEST(LogCheck, HasNothingToSayAboutACleanRecording) {
  for (const Finding& f : findings_of(city(), {})) {
    EXPECT_EQ(f.severity, Severity::ok) << f.subject << ": " << f.text;
  }
}

class TimeOffset : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Offsets, TimeOffset, ::testing::Values(0.0, 0.275, -0.1, 18.0, -2.5));

/// The antenna is 0.1 m ahead of the axle, 10 ms at the speed of this trip.
TEST_P(TimeOffset, IsFound) {
  const LogFacts facts =
      facts_of(city(), {{simulation::FaultKind::imu_stamps_offset, 0, 1e9, GetParam()}});
  ASSERT_TRUE(facts.turns.has_value());
  EXPECT_NEAR(facts.turns->offset_s, GetParam(), 0.02);
  EXPECT_GT(facts.turns->correlation, 0.97);
  EXPECT_NEAR(facts.turns->slope, 1, 0.05);
}

TEST(LogCheck, NamesClocksUnitsAndAxes) {
  const auto severity_of = [](simulation::FaultKind kind, double size, const std::string& subject) {
    const Finding f = finding(findings_of(city(), {{kind, 0, 1e9, size}}), subject);
    EXPECT_NE(f.remedy, "") << subject;
    return f.severity;
  };
  EXPECT_EQ(severity_of(simulation::FaultKind::imu_stamps_offset, 0.275, "time offset"),
            Severity::warning);
  EXPECT_EQ(severity_of(simulation::FaultKind::imu_stamps_offset, 18, "time offset"),
            Severity::error);
  EXPECT_EQ(severity_of(simulation::FaultKind::imu_stamps_offset, 3600, "overlap"),
            Severity::error);
  EXPECT_EQ(severity_of(simulation::FaultKind::imu_gyro_in_degrees, 0, "time offset"),
            Severity::error);
  EXPECT_EQ(severity_of(simulation::FaultKind::imu_accel_in_g, 0, "specific force"),
            Severity::error);
  EXPECT_EQ(severity_of(simulation::FaultKind::imu_axes_turned, 0, "gravity"), Severity::error);
  EXPECT_EQ(severity_of(simulation::FaultKind::fix_sigma_zero, 0, "sigmas"), Severity::warning);
  EXPECT_EQ(severity_of(simulation::FaultKind::fix_sigma_scale, 0.1, "sigmas"), Severity::warning);
}

/// Fixes that are no positions, before all others and among them.
class WithBadFixes : public state::Source {
 public:
  explicit WithBadFixes(std::unique_ptr<state::Source> source) : source_(std::move(source)) {}
  std::optional<Measurement> next() override {
    std::optional<Measurement> m = source_->next();
    if (auto* fix = m ? std::get_if<GnssFix>(&*m) : nullptr) {
      ++fixes_;
      if (fixes_ == 3) fix->antenna.latitude = std::nan("");
      if (fixes_ < 3 || fixes_ == 100) fix->antenna = Geodetic{0, 0, 0};
    }
    return m;
  }
  const state::Mounting& mounting() const override { return source_->mounting(); }
  double progress() const override { return source_->progress(); }

 private:
  std::unique_ptr<state::Source> source_;
  int fixes_ = 0;
};

TEST(LogCheck, FixesThatAreNoPositionsBlindNothingAndAreNamed) {
  WithBadFixes source(std::make_unique<simulation::FaultySource>(
      std::make_unique<simulation::SimulatedSource>(city(), imu::imu_preset("ADIS16465")),
      std::vector<simulation::Fault>{{simulation::FaultKind::imu_stamps_offset, 0, 1e9, 18}}, 1));
  LogChecker checker(imu::imu_preset("ADIS16465"), source.mounting());
  while (const std::optional<Measurement> m = source.next()) checker.add(*m);
  EXPECT_EQ(finding(checker.findings(), "time offset").severity, Severity::error);
  EXPECT_EQ(finding(checker.findings(), "GNSS fixes").severity, Severity::warning);
  EXPECT_THAT(finding(checker.findings(), "GNSS fixes").text, HasSubstr("4 fixes are no pos"));
}

TEST(TurnMatch, AFixThatIsNoPositionDoesNotBlindIt) {
  WithBadFixes source(
      std::make_unique<simulation::SimulatedSource>(city(), imu::imu_preset("ADIS16465")));
  TurnMatcher matcher(1, 0.02);
  while (const std::optional<Measurement> m = source.next()) {
    if (const auto* fix = std::get_if<GnssFix>(&*m)) matcher.add(*fix);
    if (const auto* increment = std::get_if<ImuIncrement>(&*m)) matcher.add(*increment);
  }
  ASSERT_TRUE(matcher.best().has_value());
  EXPECT_NEAR(matcher.best()->slope, 1, 0.05);
}

/// Sensors that measure a multiple of what they should.
class Scaled : public state::Source {
 public:
  Scaled(double gyro, double accel) : gyro_(gyro), accel_(accel) {}
  std::optional<Measurement> next() override {
    std::optional<Measurement> m = source_.next();
    if (auto* increment = m ? std::get_if<ImuIncrement>(&*m) : nullptr) {
      increment->dtheta_b *= gyro_;
      increment->dvel_b *= accel_;
    }
    return m;
  }
  const state::Mounting& mounting() const override { return source_.mounting(); }
  double progress() const override { return source_.progress(); }

 private:
  double gyro_, accel_;
  simulation::SimulatedSource source_{city(), imu::imu_preset("ADIS16465")};
};

std::vector<Finding> findings_of(state::Source& source) {
  LogChecker checker(imu::imu_preset("ADIS16465"), source.mounting());
  while (const std::optional<Measurement> m = source.next()) checker.add(*m);
  return checker.findings();
}

TEST(LogCheck, FactorsThatNoSensorHasAreErrors) {
  for (const double factor : {0.5, 0.7, 1.4, 2.0}) {
    Scaled accel(1, factor), gyro(factor, 1);
    const Finding force = finding(findings_of(accel), "specific force");
    EXPECT_EQ(force.severity, Severity::error) << factor;
    EXPECT_THAT(force.text, HasSubstr(std::to_string(factor).substr(0, 3)));
    const Finding turns = finding(findings_of(gyro), "time offset");
    EXPECT_EQ(turns.severity, Severity::error) << factor;
    EXPECT_THAT(turns.text, HasSubstr("scale factor"));
  }
}

/// A run says the same, as soon as it is certain.
TEST(Plausibility, EndsARunWhoseSensorsHaveSuchFactors) {
  const auto error_of = [](state::Source& source) -> std::string {
    Plausibility plausibility;
    try {
      while (const std::optional<Measurement> m = source.next()) {
        if (const auto* fix = std::get_if<GnssFix>(&*m)) plausibility.add(*fix);
        if (const auto* increment = std::get_if<ImuIncrement>(&*m)) plausibility.add(*increment);
      }
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  };
  Scaled accel(1, 0.5), gyro(0.5, 1), good(0.93, 1.07);
  EXPECT_THAT(error_of(accel), HasSubstr("specific force is 0.5"));
  EXPECT_THAT(error_of(gyro), HasSubstr("the gyroscopes turn 0.5"));
  EXPECT_EQ(error_of(good), "");
}

TEST(LogCheck, FactorsThatSensorsHaveAreNot) {
  for (const double factor : {0.93, 1.07}) {
    Scaled source(factor, factor);
    for (const Finding& f : findings_of(source)) {
      EXPECT_NE(f.severity, Severity::error) << f.subject << ": " << f.text;
    }
  }
}

TEST(LogCheck, ForwardThatIsBackward) {
  simulation::ScenarioOptions scenario = city();
  simulation::SimulatedSource source(scenario, imu::imu_preset("ADIS16465"));
  const state::Mounting turned{
      Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()))};
  LogChecker checker(imu::imu_preset("ADIS16465"), turned);
  while (const std::optional<Measurement> m = source.next()) checker.add(*m);
  EXPECT_EQ(finding(checker.findings(), "axes").severity, Severity::error);
}

TEST(LogCheck, NoiseAgainstTheConfiguration) {
  const LogFacts facts = facts_of(city(), {});
  const imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  ASSERT_GT(facts.rest.seconds, 30);
  // The largest of three axes, from some forty pairs each: 20 % of each, and the maximum above.
  EXPECT_NEAR(facts.rest.gyro_noise_density / noise.gyro_noise_density, 1.15, 0.4);
  EXPECT_NEAR(facts.rest.accel_noise_density / noise.accel_noise_density, 1.15, 0.4);
  imu::ImuNoise better = noise;
  better.gyro_noise_density /= 10;
  EXPECT_EQ(finding(judge(facts, better), "gyroscope noise").severity, Severity::warning);
}

TEST(LogCheck, HolesAndLeverArm) {
  simulation::ScenarioOptions scenario = city();
  scenario.lever_arm_m.setZero();
  const std::vector<Finding> findings =
      findings_of(scenario, {{simulation::FaultKind::imu_gap, 200, 5}});
  EXPECT_EQ(finding(findings, "IMU").severity, Severity::warning);
  EXPECT_THAT(finding(findings, "IMU").text, HasSubstr("1 holes, the longest 5"));
  EXPECT_EQ(finding(findings, "lever arm").severity, Severity::warning);
}

/// Where every offset fits as well as any other there is nothing to complain about.
TEST(TurnMatch, ACircleTellsNoOffset) {
  TurnMatch match;
  match.offset_s = 7;
  match.correlation = 0.99;
  match.slope = 1;
  match.residual_share = 0.9;
  EXPECT_FALSE(gross_mismatch(match, 0).has_value());
  match.residual_share = 0.01;
  EXPECT_TRUE(gross_mismatch(match, 0).has_value());
}

}  // namespace
}  // namespace foucault::diagnosis
