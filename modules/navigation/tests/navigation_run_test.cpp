#include "foucault/navigation/navigation_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "fake_run.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "test_drive.h"

namespace foucault::navigation {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace foucault::testing;  // NOLINT: the fakes

/// A run aligned at 0 ms by given angles (and a first increment up to 10 ms).
class NavigationRunTest : public ::testing::Test {
 protected:
  NavigationRun& run() {
    if (!run_) {
      alignment::AlignmentOptions alignment;
      alignment.mode = "given";
      alignment.roll_deg = alignment.pitch_deg = alignment.heading_deg = 0;
      run_ = std::make_unique<NavigationRun>(
          std::make_unique<FakeNavigator>(log_, velocity_n_),
          alignment::Aligner(alignment, imu::imu_preset("ADIS16465"), state::Mounting{}), options_,
          sink_);
    }
    return *run_;
  }

  /// Aligned at 10 ms, when the first fix meets known increments.
  void align() {
    feed_imu(0, 10);
    run().process(fix_at(10));
    ASSERT_EQ(log_.starts.size(), 1u);
    log_.calls.clear();
  }

  void feed_imu(double begin_ms, double end_ms, double step_ms = 10) {
    for (double t = begin_ms; t < end_ms - 0.5; t += step_ms) {
      run().process(increment_between(t, t + step_ms));
    }
  }

  std::string error_of_finish() {
    try {
      run().finish();
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  }

  NavigationRunOptions options_;
  Vector3d velocity_n_ = Vector3d::Zero();
  Log log_;
  RecordingSink sink_;
  std::unique_ptr<NavigationRun> run_;
};

TEST_F(NavigationRunTest, SplitsIncrementsAtFixesAndRequests) {
  align();
  run().process(fix_at(23));
  run().process(EpochRequest{at(26)});
  run().process(increment_between(10, 20));
  run().process(increment_between(20, 30));
  std::vector<double> ends;
  Vector3d dtheta = Vector3d::Zero();
  for (const ImuIncrement& increment : log_.propagated) {
    ends.push_back(ms_of(increment.t_end_ns));
    dtheta += increment.dtheta_b;
  }
  EXPECT_THAT(ends, ElementsAre(20, 23, 26, 30));
  EXPECT_NEAR(dtheta.x(), 0.1 * 0.02, 1e-15);
  EXPECT_THAT(log_.calls, ElementsAre("update@23"));
  EXPECT_THAT(sink_.epochs_ms, ElementsAre(10, 23, 26));
}

/// A position of one's own, right where the fake navigator stands.
measurement::ObservationPtr own() {
  struct Own final : measurement::Observation {
    std::string_view name() const override { return "own"; }
    state::Linearized linearize(const state::NavState&, const measurement::MeanMotion&,
                                const state::Layout& layout) const override {
      state::Linearized z(1, layout.size());
      z.r[0] = 0;
      z.R(0, 0) = 1;
      return z;
    }
  };
  return std::make_shared<Own>();
}

/// What comes while the run aligns waits for the drive; what is of before the start is gone.
TEST_F(NavigationRunTest, AMeasurementOfOnesOwnIsUsedAtItsStampWhateverThePhase) {
  feed_imu(0, 10);
  run().observe(at(5), own());
  run().observe(at(15), own());
  run().process(fix_at(10));
  run().observe(at(17), own());
  feed_imu(10, 30);
  EXPECT_THAT(log_.calls, ElementsAre("start@10", "update@15", "update@17"));
  EXPECT_THROW(run().observe(at(40), nullptr), std::invalid_argument);
}

/// A hole that ends the alignment does not end what waits behind it.
TEST_F(NavigationRunTest, AMeasurementOfOnesOwnOutlivesANewAlignment) {
  align();
  run().observe(at(60'020), own());
  feed_imu(10, 20);
  feed_imu(60'000, 60'010);
  run().process(fix_at(60'010));
  feed_imu(60'010, 60'030);
  EXPECT_THAT(log_.calls, ElementsAre("start@60010", "update@60020"));
}

class UnsoundState : public NavigationRunTest,
                     public ::testing::WithParamInterface<
                         std::pair<const char*, std::function<void(state::Epoch&)>>> {};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
INSTANTIATE_TEST_SUITE_P(
    Parts, UnsoundState,
    ::testing::Values(std::pair("position", [](state::Epoch& e) { e.position.longitude = kNan; }),
                      std::pair("velocity", [](state::Epoch& e) { e.velocity_n.y() = 1 / 0.0; }),
                      std::pair("attitude", [](state::Epoch& e) { e.q_n_b.x() = kNan; }),
                      std::pair("IMU biases", [](state::Epoch& e) { e.bias.accel.z() = kNan; }),
                      std::pair("covariance", [](state::Epoch& e) { e.covariance(3, 8) = kNan; }),
                      std::pair("covariance",
                                [](state::Epoch& e) { e.covariance(7, 7) = -1e-9; })));

TEST_P(UnsoundState, IsAnErrorAndNoRow) {
  align();
  run().process(fix_at(20));
  feed_imu(10, 40);
  run().process(fix_at(50));
  log_.spoil = GetParam().second;
  try {
    feed_imu(40, 60);
    FAIL() << "nothing thrown";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr(std::string("the solution's ") + GetParam().first));
    EXPECT_THAT(error.what(), HasSubstr("not finite at 2023-11-14T22:13:20.050Z"));
    EXPECT_THAT(error.what(), HasSubstr("the last fix was used at 2023-11-14T22:13:20.050Z"));
  }
  EXPECT_THAT(sink_.epochs_ms, ElementsAre(10, 20));
}

TEST_F(NavigationRunTest, FixAtTheEndOfAnIncrementNeedsNoSplit) {
  align();
  run().process(fix_at(20));
  run().process(increment_between(10, 20));
  EXPECT_EQ(log_.propagated.size(), 1u);
  EXPECT_THAT(log_.calls, ElementsAre("update@20"));
}

TEST_F(NavigationRunTest, StartsWithAnIncrementThatReachesTheFix) {
  feed_imu(0, 10);
  run().process(fix_at(20));
  run().process(increment_between(10, 20));  // ends where the run began
  run().process(increment_between(20, 30));
  ASSERT_EQ(log_.propagated.size(), 1u);
  EXPECT_EQ(ms_of(log_.propagated[0].t_begin_ns), 20);
}

TEST_F(NavigationRunTest, TwoFixesAtOneStampAreBothUsedAndGiveOneEpoch) {
  align();
  run().process(fix_at(15));
  run().process(fix_at(15, Vector3d(0.1, 0, 0)));
  feed_imu(10, 30);
  EXPECT_THAT(log_.calls, ElementsAre("update@15", "update@15"));
  EXPECT_THAT(sink_.epochs_ms, ElementsAre(10, 15));
}

TEST_F(NavigationRunTest, HoldsWhenNoFixComes) {
  align();
  feed_imu(10, 3500);
  EXPECT_THAT(log_.calls, ElementsAre("hold@1010", "hold@2010", "hold@3010"));
  EXPECT_THAT(sink_.epochs_ms, ElementsAre(10, 1010, 2010, 3010));
}

TEST_F(NavigationRunTest, AFixInTimeTakesThePlaceOfTheHold) {
  align();
  run().process(fix_at(1010));
  feed_imu(10, 1500);
  EXPECT_THAT(log_.calls, ElementsAre("update@1010"));
}

TEST_F(NavigationRunTest, WaitsForAFixWhoseStampJitters) {
  align();
  std::vector<double> fixes{1010, 2012, 3009.5, 4011};
  double now = 10;
  for (const double ms : fixes) {
    const double before = std::ceil(ms / 10) * 10 - 10;  // the fix precedes what reaches it
    feed_imu(now, before);
    now = before;
    run().process(fix_at(ms));
  }
  feed_imu(now, 4100);
  // The first hold is due at 2010, when fixes are known to come a second apart (exactly so far).
  EXPECT_THAT(log_.calls,
              ElementsAre("update@1010", "hold@2010", "update@2012", "update@3010", "update@4011"));
}

/// Fixes every second, that at 71 s 1 km away: no prediction of what is rejected.
TEST_F(NavigationRunTest, PredictsUsedFixesAheadIfThatIsWanted) {
  for (const bool wanted : {true, false}) {
    run_.reset();
    log_ = Log();
    sink_ = RecordingSink();
    sink_.predict = wanted;
    align();
    for (int t = 1; t <= 110; ++t) {
      feed_imu(1000 * t - 990, 1000 * t, 990);
      run().process(fix_at(1000 * t + 10, Vector3d(t == 71 ? 1000 : 0, 0, 0.1)));
      feed_imu(1000 * t, 1000 * t + 10);
    }
    std::vector<double> horizons;
    for (const state::PredictionResult& p : sink_.predictions) {
      horizons.push_back(p.ahead_s);
      EXPECT_NEAR(p.innovation_n.norm(), 0.1, 1e-6);
      EXPECT_GT(p.innovation_covariance(0, 0), 0);
    }
    if (wanted) {
      EXPECT_THAT(horizons, ElementsAre(5, 15, 30));
    } else {
      EXPECT_THAT(horizons, ElementsAre());
    }
  }
}

TEST_F(NavigationRunTest, RequestsAreNoNodes) {
  align();
  run().process(EpochRequest{at(900)});
  feed_imu(10, 1100);
  EXPECT_THAT(log_.calls, ElementsAre("hold@1010"));
  EXPECT_THAT(sink_.epochs_ms, ElementsAre(10, 900, 1010));
}

TEST_F(NavigationRunTest, ImuRateGivesAnEpochAtEachIncrement) {
  options_.rate = EpochRate::imu;
  align();
  run().process(fix_at(25));
  feed_imu(10, 40);
  EXPECT_THAT(sink_.epochs_ms, ElementsAre(10, 20, 25, 30, 40));
}

TEST_F(NavigationRunTest, BridgesAHoleWithTheRatesBeforeItAndMoreNoise) {
  align();
  feed_imu(10, 500);
  run().process(fix_at(1505));
  log_.propagated.clear();
  run().process(increment_between(2500, 2510));
  EXPECT_TRUE(log_.propagated.empty());  // until the course after the hole is known, or the end
  run().finish();
  ASSERT_FALSE(log_.propagated.empty());
  double extra = 0, angle = 0, covered = 0;
  for (const ImuIncrement& increment : log_.propagated) {
    if (increment.t_end_ns > at(2500)) continue;
    extra = increment.extra_gyro_noise_density;
    angle += increment.dtheta_b.x();
    covered += increment.dt();
    // Random-walk angle of this density over the hole equals a constant rate error: s sqrt(T).
    EXPECT_NEAR(extra, options_.gaps.rate_sigma_deg_s * kDegree * std::sqrt(2.0), 1e-9);
    EXPECT_NEAR(increment.extra_accel_noise_density,
                options_.gaps.accel_sigma_m_s2 * std::sqrt(2.0), 1e-9);
  }
  EXPECT_NEAR(covered, 2, 1e-9);
  EXPECT_NEAR(angle, 0.2, 1e-9);
  EXPECT_EQ(log_.propagated.back().extra_gyro_noise_density, 0);
  EXPECT_THAT(log_.calls, ElementsAre("hold@1010", "update@1505", "hold@2505"));
  ASSERT_GE(sink_.notices.size(), 2u);
  EXPECT_EQ(sink_.notices.back().kind, state::NoticeKind::imu_gap);
}

TEST_F(NavigationRunTest, ShortHolesAreBridgedAtOnce) {
  align();
  feed_imu(10, 100);
  run().process(increment_between(300, 310));
  EXPECT_EQ(log_.propagated.back().t_end_ns, at(310));
}

TEST_F(NavigationRunTest, TheBridgeDoesNotStepByTheIncrementAfterTheHole) {
  align();
  feed_imu(10, 100);
  log_.propagated.clear();
  run().process(increment_between(300, 300.0001));  // of 100 ns
  feed_imu(310, 320);
  EXPECT_LE(log_.propagated.size(), 25u);
  EXPECT_EQ(log_.propagated.back().t_end_ns, at(320));
}

TEST_F(NavigationRunTest, AHoleRightAfterTheStartIsBridgedInFewSteps) {
  align();
  log_.propagated.clear();
  run().process(increment_between(300, 300.0001));
  EXPECT_LE(log_.propagated.size(), 2002u);
  EXPECT_EQ(log_.propagated.back().t_end_ns, at(300.0001));
}

TEST_F(NavigationRunTest, TheCourseAfterAHoleTellsTheTurnInIt) {
  velocity_n_ = Vector3d(10, 0, 0);
  options_.gnss.gate_false_alarm = 0;  // the fake navigator does not move along
  align();
  feed_imu(10, 500);
  log_.propagated.clear();
  feed_imu(3500, 3600);
  run().process(fix_at(3605, Vector3d(20, 10, 0)));
  feed_imu(3600, 4600);
  run().process(fix_at(4605, Vector3d(20, 20, 0)));  // east; it went north before
  feed_imu(4600, 4700);
  Vector3d angle = Vector3d::Zero(), velocity = Vector3d::Zero();
  for (const ImuIncrement& increment : log_.propagated) {
    if (increment.t_end_ns > at(3500)) break;
    angle += increment.dtheta_b;
    velocity += increment.dvel_b;
    EXPECT_LT(increment.extra_gyro_noise_density,
              options_.gaps.rate_sigma_deg_s * kDegree * std::sqrt(3.0));
  }
  EXPECT_NEAR(angle.x(), 0.3, 1e-9);      // as before the hole
  EXPECT_NEAR(angle.z(), kPi / 2, 1e-3);  // chord in the NED of its own place
  EXPECT_NEAR(velocity.y(), 10 * kPi / 2, 1e-2);
  EXPECT_EQ(log_.updates.size(), 2u);
  EXPECT_THAT(sink_.notices.back().text, HasSubstr("turn"));
}

TEST_F(NavigationRunTest, AlignsAnewAfterALongHole) {
  align();
  feed_imu(10, 500);
  feed_imu(15000, 15100);
  run().process(fix_at(15105));
  feed_imu(15100, 15200);
  ASSERT_EQ(log_.starts.size(), 2u);
  EXPECT_EQ(ms_of(log_.starts[1].t_ns), 15105);
  std::vector<state::NoticeKind> kinds;
  for (const state::Notice& notice : sink_.notices) kinds.push_back(notice.kind);
  EXPECT_THAT(kinds, ElementsAre(state::NoticeKind::aligned, state::NoticeKind::imu_gap,
                                 state::NoticeKind::realigned));
}

TEST_F(NavigationRunTest, IncrementsOutOfOrderOrNotFiniteAreLeftOutAndNamed) {
  align();
  feed_imu(10, 30);
  run().process(increment_between(10, 20));  // comes again
  run().process(increment_between(30, 30));  // has no length
  ImuIncrement nan = increment_between(30, 40);
  nan.dvel_b.y() = std::numeric_limits<double>::quiet_NaN();
  run().process(nan);
  feed_imu(40, 60);
  run().process(increment_between(55, 70));  // begins too early
  run().finish();
  int64_t end_ns = at(10);
  for (const ImuIncrement& increment : log_.propagated) {
    EXPECT_EQ(increment.t_begin_ns, end_ns);
    EXPECT_TRUE(increment.dvel_b.allFinite());
    end_ns = increment.t_end_ns;
  }
  EXPECT_EQ(ms_of(end_ns), 70);
  std::string notices;
  for (const state::Notice& notice : sink_.notices) notices += notice.text + "\n";
  EXPECT_THAT(notices, HasSubstr("1 IMU samples are not finite"));
  EXPECT_THAT(notices, HasSubstr("2023-11-14T22:13:20.040Z"));
  EXPECT_THAT(notices, HasSubstr("2 IMU samples do not come after"));
  EXPECT_THAT(notices, HasSubstr("2023-11-14T22:13:20.020Z"));
}

TEST_F(NavigationRunTest, EndsIfMostOfTheImuIsUnusable) {
  align();
  feed_imu(10, 30);
  for (int i = 0; i < 5; ++i) run().process(increment_between(10, 20));
  EXPECT_THAT(error_of_finish(), HasSubstr("5 IMU samples do not come after"));
}

TEST_F(NavigationRunTest, AFixOfAnotherWeekDoesNotKeepOthersWaiting) {
  align();
  run().process(fix_at(20));
  run().process(fix_at(20 + 1000.0 * 604800));
  run().process(fix_at(20 + 1000.0 * 1800));  // half an hour ahead
  run().process(fix_at(30));
  feed_imu(10, 50);
  run().finish();
  EXPECT_EQ(log_.updates.size(), 2u);
  EXPECT_THAT(sink_.notices.back().text, HasSubstr("another GPS week"));
}

TEST_F(NavigationRunTest, AFixThatComesTwiceIsUsedOnce) {
  align();
  run().process(fix_at(20));
  run().process(fix_at(20));
  feed_imu(10, 50);
  EXPECT_EQ(log_.updates.size(), 1u);
  ASSERT_EQ(sink_.fixes.size(), 2u);
  EXPECT_EQ(sink_.fixes.front().verdict, state::FixVerdict::out_of_order);
}

TEST_F(NavigationRunTest, OutlierIsGatedAndReported) {
  align();
  run().process(fix_at(20, Vector3d(10, 0, 0)));
  run().process(fix_at(30, Vector3d(0.1, -0.1, 0)));
  feed_imu(10, 40);
  ASSERT_EQ(sink_.fixes.size(), 2u);
  EXPECT_EQ(sink_.fixes[0].verdict, state::FixVerdict::gated);
  EXPECT_NEAR(sink_.fixes[0].innovation_n.x(), 10, 1e-6);
  EXPECT_EQ(sink_.fixes[1].verdict, state::FixVerdict::used);
  EXPECT_NEAR(sink_.fixes[1].postfit_n.x(), 0.1, 1e-6);
  EXPECT_THAT(log_.calls, ElementsAre("update@30"));
}

TEST_F(NavigationRunTest, GateHasTheProbabilityItNames) {
  // 3 degrees of freedom: P(chi-square > 11.345) = 0.01.
  options_.gnss.gate_false_alarm = 0.01;
  align();
  run().process(fix_at(20, Vector3d(0.1 * std::sqrt(11.35), 0, 0)));
  run().process(fix_at(30, Vector3d(0, 0.1 * std::sqrt(11.34), 0)));
  feed_imu(10, 40);
  EXPECT_EQ(sink_.fixes[0].verdict, state::FixVerdict::gated);
  EXPECT_EQ(sink_.fixes[1].verdict, state::FixVerdict::used);
}

TEST_F(NavigationRunTest, NoGateWhenSwitchedOff) {
  options_.gnss.gate_false_alarm = 0;
  align();
  run().process(fix_at(20, Vector3d(1000, 0, 0)));
  feed_imu(10, 40);
  EXPECT_EQ(sink_.fixes[0].verdict, state::FixVerdict::used);
}

/// From the first of them on; soon after the alignment, which may have been wrong.
TEST_F(NavigationRunTest, ManyOutliersInARowAreBelieved) {
  options_.gnss.reinstate_after = 3;
  align();
  for (int i = 2; i < 7; ++i) run().process(fix_at(10 * i, Vector3d(10, 0, 0)));
  for (int i = 1; i < 15; ++i) run().process(fix_at(1000 * i));
  run().process(fix_at(14500, Vector3d(10, 0, 0)));  // the gate has long closed again
  run().process(fix_at(15000));
  feed_imu(10, 15020);
  std::vector<state::FixVerdict> verdicts;
  for (const state::FixResult& result : sink_.fixes) verdicts.push_back(result.verdict);
  std::vector<state::FixVerdict> expected(5 + 14, state::FixVerdict::used);
  expected.push_back(state::FixVerdict::gated);
  expected.push_back(state::FixVerdict::used);
  EXPECT_EQ(verdicts, expected);
}

TEST_F(NavigationRunTest, ABetterQualityDoesNotMakeAFixTrue) {
  align();
  GnssFix floating = fix_at(20);
  floating.quality = FixQuality::float_rtk;
  run().process(floating);
  run().process(fix_at(30, Vector3d(10, 0, 0)));
  run().process(fix_at(40));
  feed_imu(10, 50);
  ASSERT_EQ(sink_.fixes.size(), 3u);
  EXPECT_EQ(sink_.fixes[1].verdict, state::FixVerdict::gated);
  EXPECT_EQ(sink_.fixes[2].verdict, state::FixVerdict::used);
}

TEST_F(NavigationRunTest, FixesOfLowQualityAreLeftOut) {
  options_.gnss.min_quality = "fixed_rtk";
  align();
  GnssFix fix = fix_at(20);
  fix.quality = FixQuality::float_rtk;
  run().process(fix);
  feed_imu(10, 30);
  ASSERT_EQ(sink_.fixes.size(), 1u);
  EXPECT_EQ(sink_.fixes[0].verdict, state::FixVerdict::low_quality);
  EXPECT_TRUE(log_.updates.empty());
}

/// What was held back over a hole or an alignment is gone through within one call.
TEST_F(NavigationRunTest, CanBeStoppedWhileCatchingUp) {
  align();
  feed_imu(10, 1000);
  run().process(increment_between(3000, 3010));  // the course after the hole is waited for
  sink_.stop_catching_up_at = 5;
  struct Stopped {};
  sink_.stop = [] { throw Stopped(); };
  EXPECT_THROW(
      {
        feed_imu(3010, 60000);
        run().finish();
      },
      Stopped);
}

TEST_F(NavigationRunTest, AFixOfTwoFaultsCountsOnce) {
  options_.gnss.min_quality = "fixed_rtk";
  align();
  GnssFix floating = fix_at(20);
  floating.quality = FixQuality::float_rtk;
  run().process(floating);
  run().process(floating);
  run().process(floating);
  run().process(fix_at(30));
  feed_imu(10, 40);
  EXPECT_EQ(log_.updates.size(), 1u);
  EXPECT_EQ(error_of_finish(), "");
}

TEST_F(NavigationRunTest, WhatIsNoPositionIsLeftOutCountedAndNamed) {
  options_.gnss.gate_false_alarm = 0;  // not the gate's doing
  align();
  for (int i = 2; i < 12; ++i) {
    GnssFix none = fix_at(10 * i);
    none.antenna = Geodetic{0, 0, 0};
    run().process(none);
  }
  GnssFix in_space = fix_at(125);
  in_space.antenna.height = 1.9e6;
  run().process(in_space);
  run().process(fix_at(130));
  feed_imu(10, 140);
  run().finish();
  EXPECT_THAT(log_.calls, ElementsAre("update@130"));
  EXPECT_EQ(sink_.fixes.size(), 12u);
  EXPECT_THAT(sink_.notices.back().text, HasSubstr("11 fixes are no positions"));
  EXPECT_THAT(sink_.notices.back().text, HasSubstr("2023-11-14T22:13:20.020Z"));
}

TEST_F(NavigationRunTest, FixesThatNoVehicleReachesAreLeftOut) {
  options_.gnss.gate_false_alarm = 0;
  align();
  for (int i = 2; i < 22; ++i) run().process(fix_at(10 * i));
  for (int i = 22; i < 32; ++i) run().process(fix_at(10 * i, Vector3d(0, 5e5, 0)));
  for (int i = 32; i < 42; ++i) run().process(fix_at(10 * i));
  feed_imu(10, 500);
  run().finish();
  EXPECT_EQ(log_.updates.size(), 30u);
  EXPECT_THAT(sink_.notices.back().text, HasSubstr("10 fixes lie where no vehicle gets to"));
}

TEST_F(NavigationRunTest, AWrongFirstFixCostsOneGoodOne) {
  run().process(fix_at(-10, Vector3d(5e5, 0, 0)));
  feed_imu(-20, 10);
  for (int i = 1; i < 11; ++i) {
    run().process(fix_at(10 * i));
    feed_imu(10 * i, 10 * i + 10);
  }
  run().finish();
  EXPECT_THAT(sink_.notices.back().text, HasSubstr("1 fixes lie where no vehicle gets to"));
}

TEST_F(NavigationRunTest, APositionHeldUnderNewStampsCountsOnce) {
  options_.gnss.gate_false_alarm = 0;
  align();
  for (int i = 0; i < 150; ++i) {  // at 20 Hz, of a receiver of 4 Hz, at 10 m/s
    feed_imu(10 + 50 * i, 60 + 50 * i);
    run().process(fix_at(65 + 50 * i, Vector3d(2.5 * (i / 5), 0, 0)));
  }
  feed_imu(7510, 7600);
  run().finish();
  // The first ten tell; of the twenty after them one each.
  EXPECT_EQ(log_.updates.size(), 70u);
  EXPECT_EQ(ms_of(log_.updates.back().first), 65 + 50 * 145);
  EXPECT_THAT(sink_.notices.back().text, ::testing::ContainsRegex("80 of [0-9]+ fixes repeat the"));
}

TEST_F(NavigationRunTest, FixesAtRestMayRepeatByChance) {
  options_.gnss.gate_false_alarm = 0;
  align();
  const int runs[] = {1, 2, 1, 1, 4, 1, 2, 3, 1, 1, 2, 1, 5, 1, 1, 3, 2, 1, 1, 2};
  int fixes = 0;
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < runs[i]; ++k, ++fixes) {
      feed_imu(10 + 50 * fixes, 60 + 50 * fixes);
      run().process(fix_at(65 + 50 * fixes, Vector3d(0.01 * (i % 3), 0, 0)));
    }
  }
  feed_imu(10 + 50 * fixes, 100 + 50 * fixes);
  EXPECT_EQ(static_cast<int>(log_.updates.size()), fixes);
}

TEST_F(NavigationRunTest, AVelocityThatIsNoNumberLeavesThePosition) {
  options_.aids.gnss_velocity = "on";
  align();
  GnssFix fix = fix_at(20);
  fix.velocity_n->x() = std::numeric_limits<double>::quiet_NaN();
  run().process(fix);
  fix = fix_at(30);
  fix.velocity_covariance(1, 1) = std::numeric_limits<double>::quiet_NaN();
  run().process(fix);
  feed_imu(10, 50);
  EXPECT_EQ(log_.updates.size(), 2u);
  EXPECT_TRUE(sink_.observations.empty());
}

TEST_F(NavigationRunTest, VelocitiesAreGatedByThemselves) {
  options_.aids.gnss_velocity = "on";
  align();
  GnssFix outlier = fix_at(30);
  outlier.velocity_n->y() = 5;
  run().process(fix_at(20));
  run().process(outlier);
  feed_imu(10, 50);
  EXPECT_EQ(log_.updates.size(), 3u);
  ASSERT_EQ(sink_.observations.size(), 2u);
  EXPECT_TRUE(sink_.observations[0].used);
  EXPECT_EQ(sink_.observations[0].name, "gnss_velocity");
  EXPECT_FALSE(sink_.observations[1].used);
  EXPECT_NEAR(sink_.observations[1].normalized_square, 25 / 0.01, 1e-6);
}

/// Not even the alignment, which would know the velocity at once, gets one.
TEST_F(NavigationRunTest, AidsOfModeNoneArePositionsAlone) {
  options_.aids.gnss_velocity = "on";
  options_.aids.mode = "none";
  feed_imu(0, 10);
  run().process(fix_at(10));
  EXPECT_TRUE(log_.starts.empty());
  for (double ms = 10; ms < 3010; ms += 1000) {
    feed_imu(ms, ms + 1000);
    run().process(fix_at(ms + 1000));
  }
  EXPECT_FALSE(log_.starts.empty());
  EXPECT_TRUE(sink_.observations.empty());
}

TEST_F(NavigationRunTest, AFixWithoutSigmaTellsNoTurnOverAHole) {
  velocity_n_ = Vector3d(10, 0, 0);
  align();
  feed_imu(10, 500);
  log_.propagated.clear();
  feed_imu(3500, 3600);
  for (const double ms : {3605.0, 4605.0}) {
    GnssFix nan = fix_at(ms, Vector3d(0, ms / 100, 0));
    nan.position_covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
    run().process(nan);
    feed_imu(ms - 5, ms + 995);
  }
  run().finish();
  ASSERT_FALSE(log_.propagated.empty());
  for (const ImuIncrement& increment : log_.propagated) {
    EXPECT_TRUE(std::isfinite(increment.extra_gyro_noise_density));
    EXPECT_TRUE(increment.dtheta_b.allFinite());
  }
}

TEST_F(NavigationRunTest, SigmasAreScaledAndFloored) {
  options_.gnss.sigma_scale = 2;
  options_.gnss.sigma_floor_m = 0.3;
  align();
  GnssFix fix = fix_at(20);
  fix.position_covariance = Vector3d(0.01, 0.0025, 1).asDiagonal();
  run().process(fix);
  feed_imu(10, 30);
  ASSERT_EQ(log_.updates.size(), 1u);
  const Vector3d variance = log_.updates[0].second.R.diagonal();
  EXPECT_NEAR(variance.x(), 0.09, 1e-12);
  EXPECT_NEAR(variance.y(), 0.09, 1e-12);
  EXPECT_NEAR(variance.z(), 4, 1e-12);
}

TEST_F(NavigationRunTest, FixesWithoutUsableSigmaAreCountedAndNoticedOnce) {
  align();
  GnssFix zero = fix_at(20);
  zero.position_covariance.setZero();
  GnssFix nan = fix_at(30);
  nan.position_covariance(1, 1) = std::numeric_limits<double>::quiet_NaN();
  GnssFix nowhere = fix_at(40);
  nowhere.antenna.latitude = std::numeric_limits<double>::quiet_NaN();
  for (const GnssFix& fix : {zero, nan, nowhere}) run().process(fix);
  feed_imu(10, 50);
  ASSERT_EQ(sink_.fixes.size(), 3u);
  for (const state::FixResult& result : sink_.fixes)
    EXPECT_EQ(result.verdict, state::FixVerdict::bad_sigma);
  int rejections = 0;
  for (const state::Notice& notice : sink_.notices) {
    rejections += notice.kind == state::NoticeKind::fix_rejected ? 1 : 0;
  }
  EXPECT_EQ(rejections, 1);
  EXPECT_TRUE(log_.updates.empty());
  run().finish();  // the fix it was aligned with was good
}

TEST_F(NavigationRunTest, LateFixIsReportedNotUsed) {
  align();
  feed_imu(10, 100);
  run().process(fix_at(50));
  ASSERT_EQ(sink_.fixes.size(), 1u);
  EXPECT_EQ(sink_.fixes[0].verdict, state::FixVerdict::out_of_order);
  EXPECT_TRUE(log_.updates.empty());
}

TEST_F(NavigationRunTest, FinishSaysThatThereIsNoImu) {
  run().process(fix_at(10));
  EXPECT_THAT(error_of_finish(), HasSubstr("no IMU data"));
}

TEST_F(NavigationRunTest, FinishSaysThatThereIsNoGnss) {
  feed_imu(0, 100);
  EXPECT_THAT(error_of_finish(), HasSubstr("no GNSS fix"));
}

TEST_F(NavigationRunTest, FinishSaysHowManyFixesWereUseless) {
  feed_imu(0, 100);
  for (int i = 0; i < 4; ++i) run().process(fix_at(110 + i, Vector3d::Zero(), 0));
  feed_imu(100, 200);
  const std::string error = error_of_finish();
  EXPECT_THAT(error, HasSubstr("none of the 4 GNSS fixes"));
  EXPECT_THAT(error, HasSubstr("4 with a sigma"));
  EXPECT_THAT(error, HasSubstr("gnss.sigma_floor_m"));
}

TEST_F(NavigationRunTest, ZeroSigmaServesWithAFloor) {
  options_.gnss.sigma_floor_m = 0.05;
  feed_imu(0, 10);
  run().process(fix_at(10, Vector3d::Zero(), 0));
  run().finish();
  EXPECT_EQ(log_.starts.size(), 1u);
}

TEST_F(NavigationRunTest, FinishSaysThatTimesDoNotOverlap) {
  for (int i = 0; i < 4; ++i) run().process(fix_at(10 + i));
  feed_imu(50000, 50100);
  EXPECT_THAT(error_of_finish(), HasSubstr("do not overlap in time"));
}

TEST(NavigationRunWithRest, ReplaysWhatCameBeforeTheAlignment) {
  testing::Sensors sensors;
  const testing::DriveSimulator simulator(testing::rest_and_drive(20, 1.0), sensors);
  Log log;
  RecordingSink sink;
  NavigationRunOptions options;
  options.gnss.gate_false_alarm = 0;  // the fake navigator does not move along
  NavigationRun run(std::make_unique<FakeNavigator>(log, Vector3d::Zero()),
                    alignment::Aligner(alignment::AlignmentOptions(), imu::imu_preset("ADIS16465"),
                                       state::Mounting{}),
                    options, sink);
  int64_t fixes = 0, increments = 0;
  for (const Measurement& m : simulator.stream()) {
    fixes += std::holds_alternative<GnssFix>(m) ? 1 : 0;
    increments += std::holds_alternative<ImuIncrement>(m) ? 1 : 0;
    run.process(m);
  }
  run.finish();
  ASSERT_EQ(log.starts.size(), 1u);
  EXPECT_EQ(log.starts[0].t_ns, testing::DriveSimulator::kStart);
  EXPECT_EQ(static_cast<int64_t>(log.updates.size()), fixes - 1);  // the first gave the position
  EXPECT_EQ(static_cast<int64_t>(log.propagated.size()), increments);
  EXPECT_EQ(static_cast<int64_t>(sink.epochs_ms.size()), fixes);
  EXPECT_TRUE(std::is_sorted(sink.epochs_ms.begin(), sink.epochs_ms.end()));
}

TEST(GnssOptions, RoundTripAndRanges) {
  diagnosis::GnssOptions options;
  load_config_text(
      "{min_quality: ppp, sigma_scale: 3, sigma_floor_m: 0.02, gate_false_alarm: 0.01,"
      " reinstate_after: 7}",
      "test", options);
  diagnosis::GnssOptions again;
  load_config_text(dump_config(options), "again", again);
  EXPECT_EQ(again.min_quality, "ppp");
  EXPECT_EQ(again.sigma_scale, 3);
  EXPECT_EQ(again.sigma_floor_m, 0.02);
  EXPECT_EQ(again.gate_false_alarm, 0.01);
  EXPECT_EQ(again.reinstate_after, 7);
  EXPECT_THROW(set_config("sigma_scale=0", options), UsageError);
  EXPECT_THROW(set_config("gate_false_alarm=1", options), UsageError);
}

TEST(GapOptions, RoundTripAndRanges) {
  GapOptions options;
  load_config_text("{max_gap_s: 7, rate_sigma_deg_s: 3, accel_sigma_m_s2: 0.5}", "test", options);
  GapOptions again;
  load_config_text(dump_config(options), "again", again);
  EXPECT_EQ(again.max_gap_s, 7);
  EXPECT_EQ(again.rate_sigma_deg_s, 3);
  EXPECT_EQ(again.accel_sigma_m_s2, 0.5);
  EXPECT_THROW(set_config("max_gap_s=-1", options), UsageError);
}

}  // namespace
}  // namespace foucault::navigation
