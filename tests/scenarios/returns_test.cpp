/// Fixes that return after an outage: true ones are believed however wrong the noise model, wrong
/// ones are left out, by filter, window and smoothers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "foucault/simulation/simulated_source.h"
#include "jobs/laboratory_job.h"
#include "methods.h"
#include "support/test_folder.h"

namespace foucault::app {
namespace {

using namespace laboratory;

using ::testing::HasSubstr;

const std::vector<std::string> kMethods{"ekf", "full", "rts", "batch"};

std::vector<laboratory::FaultOutcome> run(const std::string& fault, int64_t seed = 1) {
  const test::TestFolder folder;
  return app::run_fault(laboratory::find_fault_case(fault), kMethods, Settings(), seed,
                        folder / (fault + ".rawlog"));
}

/// Off in position, not in motion: no drift of the state looks so. The limits are three times what
/// the outage alone costs, up to where the fixes are true again (60 + 15 s: 6.2 m forward).
TEST(Returns, WrongFixesAfterAnOutageAreLeftOut) {
  struct Expected {
    const char* fault;
    int wrong;
    double forward_m, smoothed_m;
  };
  for (const Expected& expected :
       {Expected{"return_5s_5s_5m", 5, 0.3, 0.1}, Expected{"return_5s_60s_5m", 60, 14, 1},
        Expected{"return_20s_15s_20m", 15, 3, 0.3}, Expected{"return_60s_15s_100m", 15, 19, 1}}) {
    for (const laboratory::FaultOutcome& outcome : run(expected.fault)) {
      const bool smoothed = outcome.method == "rts" || outcome.method == "batch";
      EXPECT_EQ(outcome.rejected, expected.wrong) << expected.fault << outcome.method;
      EXPECT_LT(outcome.largest_m, smoothed ? expected.smoothed_m : expected.forward_m)
          << expected.fault << outcome.method;
      EXPECT_THAT(outcome.message, HasSubstr("the first after an outage"));
    }
  }
}

TEST(Returns, TrueFixesAreBelievedWhateverTheNoise) {
  for (const laboratory::ReturnCase& what :
       {laboratory::ReturnCase{"", 0.1, 15, "ekf"}, laboratory::ReturnCase{"", 0.1, 60, "rough"},
        laboratory::ReturnCase{"", 0.1, 60, "rts"}, laboratory::ReturnCase{"", 10, 60, "full"}}) {
    const laboratory::ReturnOutcome outcome = app::study_return(what, Settings());
    EXPECT_GE(outcome.outages, 5);
    EXPECT_LE(outcome.ratio(), 1.1) << what.noise << " " << what.length_s << what.method;
    EXPECT_LE(outcome.longest_s, 5) << what.noise << " " << what.length_s << what.method;
  }
}

TEST(Returns, ABetterQualityAloneMakesNoFixTrue) {
  for (const laboratory::FaultOutcome& outcome : run("wrong_after_float")) {
    EXPECT_GE(outcome.rejected, 5) << outcome.method;  // until it is known what to correct them by
    EXPECT_LT(outcome.largest_m, 0.1) << outcome.method;
  }
  for (const laboratory::FaultOutcome& outcome : run("outliers_float")) {
    EXPECT_GT(outcome.rejected, 25) << outcome.method;
    EXPECT_LT(outcome.largest_m, 0.1) << outcome.method;
  }
}

/// Fixes that `ekf` does not use as they are, of a trip with faults.
int left_out(const simulation::ScenarioOptions& scenario,
             const std::vector<simulation::Fault>& faults, const Settings& settings) {
  struct Count : state::Sink {
    void fix(const state::FixResult& fix) override {
      fixes += fix.verdict != state::FixVerdict::used;
    }
    int fixes = 0;
  } count;
  simulation::FaultySource source(
      std::make_unique<simulation::SimulatedSource>(scenario, imu::imu_preset("ADIS16465")), faults,
      1);
  const std::unique_ptr<state::Estimator> estimator =
      methods::find("ekf").make(method_options(settings, source.mounting()), count);
  while (const std::optional<Measurement> m = source.next()) estimator->process(*m);
  estimator->finish();
  return count.fixes;
}

/// The wrong ones end while the first fixes are still being weighed.
TEST(Returns, NoTrueFixIsLeftOutAfterAJumpAtTenHertz) {
  simulation::ScenarioOptions scenario = laboratory::fault_scenario(1);
  scenario.duration_s = 260;
  scenario.gnss_rate_hz = 10;
  EXPECT_EQ(left_out(scenario,
                     {{simulation::FaultKind::fix_gap, laboratory::kFaultStart, 20},
                      {simulation::FaultKind::fix_jump, laboratory::kFaultStart + 20, 4, 20}},
                     Settings()),
            40);
}

/// One in half a minute, or one in five seconds, with the noise of the IMU taken for a tenth.
TEST(Returns, RareFixesAreBelieved) {
  Settings settings;
  settings.imu = settings.imu.scaled(0.1);
  for (const double period_s : {5, 32}) {
    std::vector<simulation::Fault> gaps;
    for (double t = laboratory::kFaultStart; t < 440; t += period_s) {
      gaps.push_back({simulation::FaultKind::fix_gap, t, period_s - 1});
    }
    EXPECT_EQ(left_out(laboratory::fault_scenario(1), gaps, settings), 0) << period_s;
  }
}

/// The fixes jump to the truth at 200 s. It is understood 90 s later, and used from the jump on.
TEST(Returns, WhatIsUnderstoodLaterCountsFromItsBeginning) {
  for (const laboratory::FaultOutcome& outcome : run("jump_back")) {
    EXPECT_EQ(outcome.rejected, 0) << outcome.method;
    ASSERT_TRUE(outcome.recovery_s.has_value()) << outcome.method;
    EXPECT_LE(*outcome.recovery_s, 1) << outcome.method;
  }
}

}  // namespace
}  // namespace foucault::app
