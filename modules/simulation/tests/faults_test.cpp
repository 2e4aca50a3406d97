#include "foucault/simulation/faults.h"

#include <gtest/gtest.h>

#include <cmath>

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault::simulation {
namespace {

struct Recording {
  std::vector<GnssFix> fixes;
  std::vector<ImuIncrement> increments;
};

Recording record(const std::vector<Fault>& faults, int64_t seed = 3) {
  ScenarioOptions scenario;
  scenario.duration_s = 100;
  scenario.imu_rate_hz = 100;
  FaultySource source(std::make_unique<SimulatedSource>(scenario, imu::imu_preset("ADIS16465")),
                      faults, seed);
  Recording recording;
  while (const std::optional<Measurement> m = source.next()) {
    if (const auto* fix = std::get_if<GnssFix>(&*m)) recording.fixes.push_back(*fix);
    if (const auto* imu = std::get_if<ImuIncrement>(&*m)) recording.increments.push_back(*imu);
  }
  return recording;
}

double offset_m(const GnssFix& a, const GnssFix& b) {
  return geodesy::LocalFrame(b.antenna).to_local(a.antenna).norm();
}

TEST(Faults, NoneLeaveTheRecordingAsItIs) {
  const Recording recording = record({});
  EXPECT_EQ(recording.fixes.size(), 101u);
  EXPECT_EQ(recording.increments.size(), 10000u);
}

TEST(Faults, RampGrowsToItsSizeAndIsGone) {
  const Recording clean = record({});
  const Recording faulty = record({{FaultKind::fix_ramp, 20, 60, 20}});
  EXPECT_NEAR(offset_m(faulty.fixes[20], clean.fixes[20]), 0, 1e-9);
  EXPECT_NEAR(offset_m(faulty.fixes[50], clean.fixes[50]), 10, 1e-6);
  EXPECT_NEAR(offset_m(faulty.fixes[80], clean.fixes[80]), 20, 1e-6);
  EXPECT_NEAR(offset_m(faulty.fixes[81], clean.fixes[81]), 0, 1e-9);
}

TEST(Faults, OutliersHaveTheirShareAndSizeAndTheirSeed) {
  const Recording clean = record({});
  const Recording faulty = record({{FaultKind::fix_outliers, 0, 1e9, 0.3}});
  const Recording again = record({{FaultKind::fix_outliers, 0, 1e9, 0.3}});
  const Recording other = record({{FaultKind::fix_outliers, 0, 1e9, 0.3}}, 4);
  int outliers = 0, differ = 0;
  for (std::size_t i = 0; i < clean.fixes.size(); ++i) {
    const double off = offset_m(faulty.fixes[i], clean.fixes[i]);
    EXPECT_EQ(offset_m(again.fixes[i], clean.fixes[i]), off);
    differ += offset_m(other.fixes[i], clean.fixes[i]) != off ? 1 : 0;
    if (off < 1e-6) continue;
    ++outliers;
    EXPECT_GT(off, 4.99);
    EXPECT_LT(off, 50.01);
  }
  EXPECT_NEAR(outliers, 30, 14);  // 3 sigmas of a binomial
  EXPECT_GT(differ, 10);
}

TEST(Faults, SpliceKeepsTheStampsEvenAndLosesMotion) {
  const Recording clean = record({});
  const Recording faulty = record({{FaultKind::imu_splice, 60, 20, 0.3}});
  EXPECT_EQ(faulty.increments.size(), clean.increments.size() - 30);
  int holes = 0;
  for (std::size_t i = 1; i < faulty.increments.size(); ++i) {
    const double hole =
        seconds_between(faulty.increments[i - 1].t_end_ns, faulty.increments[i].t_begin_ns);
    EXPECT_GE(hole, 0);
    if (hole > 1e-4) ++holes;
  }
  EXPECT_EQ(holes, 1);  // at its end, not at its beginning
}

TEST(Faults, JitterKeepsRatesAndLeavesNoHoles) {
  const Recording clean = record({});
  const Recording faulty = record({{FaultKind::imu_jitter, 0, 1e9, 0.001}});
  for (std::size_t i = 1; i < faulty.increments.size(); ++i) {
    const ImuIncrement& a = faulty.increments[i];
    EXPECT_EQ(a.t_begin_ns, faulty.increments[i - 1].t_end_ns);
    EXPECT_NEAR(a.dvel_b.z() / a.dt(), clean.increments[i].dvel_b.z() / clean.increments[i].dt(),
                1e-6);
  }
}

TEST(Faults, BurstsKeepRatesOrderAndCount) {
  const Recording clean = record({});
  const Recording faulty = record({{FaultKind::imu_bursts, 0, 1e9, 4}});
  ASSERT_EQ(faulty.increments.size(), clean.increments.size());
  for (std::size_t i = 1; i + 4 < faulty.increments.size(); ++i) {
    const ImuIncrement& a = faulty.increments[i];
    EXPECT_EQ(a.t_begin_ns, faulty.increments[i - 1].t_end_ns);
    EXPECT_EQ(a.t_end_ns,
              clean.increments[i / 4 * 4 + 3].t_end_ns + static_cast<int64_t>(i % 4) * 200'000);
    EXPECT_NEAR(a.dvel_b.z() / a.dt(), clean.increments[i].dvel_b.z() / clean.increments[i].dt(),
                1e-6);
  }
}

TEST(Faults, OrderOfFixes) {
  const Recording swapped = record({{FaultKind::fix_swapped, 10, 20}});
  EXPECT_GT(swapped.fixes[11].t_ns, swapped.fixes[12].t_ns);
  const Recording twice = record({{FaultKind::fix_duplicate, 0, 1e9}});
  EXPECT_EQ(twice.fixes[5].t_ns, twice.fixes[6].t_ns);
}

}  // namespace
}  // namespace foucault::simulation
