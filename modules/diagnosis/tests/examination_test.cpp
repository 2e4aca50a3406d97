#include "foucault/diagnosis/examination.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
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
  Examination examination(imu::imu_preset("ADIS16465"), source.mounting());
  while (const std::optional<Measurement> m = source.next()) examination.add(*m);
  return examination.facts();
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

TEST(Examination, HasNothingToSayAboutACleanRecording) {
  for (const Finding& f : findings_of(city(), {})) {
    EXPECT_EQ(f.severity, Severity::ok) << f.subject << ": " << f.text;
  }
}

class TimeOffset : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Offsets, TimeOffset, ::testing::Values(0.0, 0.275, -0.1, 18.0, -2.5));

/// Turns alone see the IMU ahead of the axle in it.
TEST_P(TimeOffset, IsFound) {
  const LogFacts facts =
      facts_of(city(), {{simulation::FaultKind::imu_stamps_offset, 0, 1e9, GetParam()}});
  ASSERT_TRUE(facts.turns.has_value());
  const bool is_near = std::abs(GetParam()) < 1;  // as far as accelerations look
  ASSERT_TRUE(!is_near || facts.accelerations.has_value());
  const double found = is_near ? facts.accelerations->offset_s.value : facts.turns->offset_s;
  EXPECT_NEAR(found, GetParam(), 0.02);
  EXPECT_GT(facts.turns->correlation, 0.97);
  EXPECT_NEAR(facts.turns->slope, 1, 0.05);
}

TEST(Examination, NamesClocksUnitsAndAxes) {
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

/// Missing samples are no delay: over them the motion goes on.
TEST(Examination, MissingSamplesMoveNoClock) {
  const LogFacts facts = facts_of(city(), {{simulation::FaultKind::imu_nan, 200, 100, 0}});
  ASSERT_TRUE(facts.accelerations.has_value());
  EXPECT_NEAR(facts.accelerations->offset_s.value, 0, 0.02);
}

TEST(Examination, FixesThatAreNoPositionsBlindNothingAndAreNamed) {
  WithBadFixes source(std::make_unique<simulation::FaultySource>(
      std::make_unique<simulation::SimulatedSource>(city(), imu::imu_preset("ADIS16465")),
      std::vector<simulation::Fault>{{simulation::FaultKind::imu_stamps_offset, 0, 1e9, 18}}, 1));
  Examination examination(imu::imu_preset("ADIS16465"), source.mounting());
  while (const std::optional<Measurement> m = source.next()) examination.add(*m);
  EXPECT_EQ(finding(examination.findings(), "time offset").severity, Severity::error);
  EXPECT_EQ(finding(examination.findings(), "GNSS fixes").severity, Severity::warning);
  EXPECT_THAT(finding(examination.findings(), "GNSS fixes").text, HasSubstr("4 fixes are no pos"));
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
  Examination examination(imu::imu_preset("ADIS16465"), source.mounting());
  while (const std::optional<Measurement> m = source.next()) examination.add(*m);
  return examination.findings();
}

TEST(Examination, FactorsThatNoSensorHasAreErrors) {
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

TEST(Examination, FactorsThatSensorsHaveAreNot) {
  for (const double factor : {0.93, 1.07}) {
    Scaled source(factor, factor);
    for (const Finding& f : findings_of(source)) {
      EXPECT_NE(f.severity, Severity::error) << f.subject << ": " << f.text;
    }
  }
}

TEST(Examination, ForwardThatIsBackward) {
  simulation::ScenarioOptions scenario = city();
  simulation::SimulatedSource source(scenario, imu::imu_preset("ADIS16465"));
  const state::Mounting turned{
      Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ()))};
  Examination examination(imu::imu_preset("ADIS16465"), turned);
  while (const std::optional<Measurement> m = source.next()) examination.add(*m);
  EXPECT_EQ(finding(examination.findings(), "axes").severity, Severity::warning);
}

TEST(Examination, NoiseAgainstTheConfiguration) {
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

TEST(Examination, HolesAndLeverArm) {
  simulation::ScenarioOptions scenario = city();
  scenario.lever_arm_m.setZero();  // known to be zero
  const std::vector<Finding> findings =
      findings_of(scenario, {{simulation::FaultKind::imu_gap, 200, 5}});
  EXPECT_EQ(finding(findings, "IMU").severity, Severity::warning);
  EXPECT_THAT(finding(findings, "IMU").text, HasSubstr("1 holes, the longest 5"));
  EXPECT_EQ(finding(findings, "lever arm").severity, Severity::ok);
}

/// What is not used of a recording does not tell anything about the rest of it.
TEST(Examination, AdmitsWhatMayBeUsed) {
  Examination examination(imu::imu_preset("ADIS16465"), state::Mounting());
  ImuIncrement increment;
  increment.t_end_ns = 10'000'000;
  increment.dvel_b = {0, 0, -0.098};
  EXPECT_TRUE(examination.admit(increment).increment);
  EXPECT_FALSE(examination.admit(increment).increment);  // comes twice
  GnssFix fix;
  EXPECT_FALSE(examination.admit(fix).fix);  // latitude and longitude are zero
  fix.antenna.latitude = 0.5;
  EXPECT_TRUE(examination.admit(fix).fix);  // to be shown, with a bad sigma
  examination.count(fix);
  const LogFacts facts = examination.facts();
  EXPECT_EQ(facts.imu.count, 1);
  EXPECT_EQ(facts.gnss.count, 3);
  EXPECT_EQ(facts.sigmas.bad, 1);
  EXPECT_EQ(examination.imu_guard().left_out(), 1);
  EXPECT_EQ(examination.fix_guard().summary().size(), 1u);
}

TEST(Examination, FixesThatOptionsExcludeTellNothingOfTurns) {
  GnssOptions options;
  options.min_quality = "fixed_rtk";
  simulation::SimulatedSource source(city(), imu::imu_preset("ADIS16465"));
  Examination examination(imu::imu_preset("ADIS16465"), source.mounting(), options);
  while (std::optional<Measurement> m = source.next()) {
    if (auto* fix = std::get_if<GnssFix>(&*m)) fix->quality = FixQuality::single;
    examination.add(*m);
  }
  EXPECT_FALSE(examination.facts().turns);
  EXPECT_GT(examination.facts().sigmas.smallest_m, 0);
}

TEST(Examination, EndsARunThatIsUseless) {
  Scaled source(1, 0.1);
  Examination examination(imu::imu_preset("ADIS16465"), source.mounting());
  const auto run = [&] {
    while (const std::optional<Measurement> m = source.next()) {
      examination.add(*m);
      examination.throw_if_useless();
    }
  };
  EXPECT_THROW(run(), DataError);
}

/// What a run says at its end; of samples and fixes that were left out it has spoken itself.
TEST(Examination, WarnsOfAllThatIsNotWell) {
  WithBadFixes source(std::make_unique<simulation::FaultySource>(
      std::make_unique<simulation::SimulatedSource>(city(), imu::imu_preset("ADIS16465")),
      std::vector<simulation::Fault>{{simulation::FaultKind::imu_gap, 200, 5}}, 1));
  Examination examination(imu::imu_preset("ADIS16465"), source.mounting());
  while (const std::optional<Measurement> m = source.next()) examination.add(*m);
  const std::vector<state::Notice> warnings = examination.warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0].text, HasSubstr("1 holes, the longest 5"));
  EXPECT_EQ(warnings[0].t_ns, examination.facts().imu.first_ns);
}

}  // namespace
}  // namespace foucault::diagnosis
