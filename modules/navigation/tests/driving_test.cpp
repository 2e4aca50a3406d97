#include "../src/driving.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_run.h"

namespace foucault::navigation {
namespace {

using ::testing::ElementsAre;
using namespace foucault::testing;  // NOLINT: the fakes

/// Started at 0 ms; its navigator stands still.
class DrivingTest : public ::testing::Test {
 protected:
  Driving& driving() {
    if (!driving_) {
      driving_.emplace(std::make_unique<FakeNavigator>(log_, Vector3d::Zero()), options_, sink_);
      state::Epoch initial;
      initial.t_ns = at(0);
      driving_->start(initial);
    }
    return *driving_;
  }
  Interruption take(const Measurement& measurement) { return driving().take(measurement); }
  static bool goes_on(const Interruption& i) { return std::holds_alternative<std::monostate>(i); }
  /// Past the seconds in which everything is believed.
  void settle() {
    for (int s = 1; s <= 12; ++s) {
      take(fix_at(1000 * s));
      ASSERT_TRUE(goes_on(take(increment_between(1000 * (s - 1), 1000 * s))));
    }
  }

  NavigationRunOptions options_;
  Log log_;
  RecordingSink sink_;
  std::optional<Driving> driving_;
};

TEST_F(DrivingTest, StopsAtWhatIsDueAndTellsTheSink) {
  take(fix_at(23));
  take(EpochRequest{at(26)});
  EXPECT_TRUE(goes_on(take(increment_between(0, 30))));
  EXPECT_THAT(log_.calls, ElementsAre("start@0", "update@23"));
  EXPECT_THAT(sink_.epochs_ms, ElementsAre(0, 23, 26));
  EXPECT_EQ(driving().time_ns(), at(30));
  EXPECT_EQ(sink_.fixes.at(0).verdict, state::FixVerdict::used);
}

TEST_F(DrivingTest, AHoleEndsTheWayBeforeIt) {
  take(increment_between(0, 10));
  const Interruption interruption = take(increment_between(15, 25));
  ASSERT_TRUE(std::holds_alternative<HoleMet>(interruption));
  EXPECT_EQ(std::get<HoleMet>(interruption).next.t_begin_ns, at(15));
  EXPECT_EQ(driving().time_ns(), at(10));
}

TEST_F(DrivingTest, AnIncrementThatOverlapsIsCut) {
  take(increment_between(0, 10));
  take(increment_between(5, 15));
  ASSERT_EQ(log_.propagated.size(), 2u);
  EXPECT_EQ(log_.propagated[1].t_begin_ns, at(10));
  EXPECT_NEAR(log_.propagated[1].dvel_b.z(), -9.8 * 0.005, 1e-12);
}

/// The rest of the increment comes back, and the fix has no result until the doubt is over.
TEST_F(DrivingTest, AFixThatDoesNotAgreeIsInDoubtOnceTheGateIsClosed) {
  settle();
  const std::size_t results = sink_.fixes.size();
  take(fix_at(12500, Vector3d(100, 0, 0)));
  const Interruption interruption = take(increment_between(12000, 13000));
  ASSERT_TRUE(std::holds_alternative<FixInDoubt>(interruption));
  const auto& in_doubt = std::get<FixInDoubt>(interruption);
  EXPECT_EQ(in_doubt.fix.t_ns, at(12500));
  EXPECT_FALSE(in_doubt.returns);
  ASSERT_TRUE(in_doubt.rest);
  EXPECT_EQ(in_doubt.rest->t_begin_ns, at(12500));
  EXPECT_EQ(in_doubt.rest->t_end_ns, at(13000));
  EXPECT_EQ(sink_.fixes.size(), results);
}

TEST_F(DrivingTest, ADoubtThatIsDecidedIsCarriedOut) {
  settle();
  const GnssFix fix = fix_at(12500, Vector3d(100, 0, 0));
  take(fix);
  take(increment_between(12000, 13000));
  diagnosis::DoubtOutcome outcome;
  diagnosis::FixDecision decision;
  decision.action = diagnosis::FixDecision::Action::leave_out;
  decision.fix = fix;
  outcome.fixes = {decision};
  outcome.notices = {"one is wrong"};
  log_.calls.clear();
  EXPECT_TRUE(goes_on(driving().resume(fix, outcome)));
  EXPECT_EQ(sink_.fixes.back().verdict, state::FixVerdict::gated);
  EXPECT_EQ(sink_.notices.back().text, "one is wrong");
  EXPECT_THAT(log_.calls, ElementsAre());
  EXPECT_EQ(sink_.epochs_ms.back(), 12500);
}

TEST_F(DrivingTest, TheFirstFixAfterAnOutageIsInDoubtEvenIfItAgrees) {
  settle();
  take(increment_between(12000, 19000));
  take(fix_at(19500));
  const Interruption interruption = take(increment_between(19000, 20000));
  ASSERT_TRUE(std::holds_alternative<FixInDoubt>(interruption));
  EXPECT_TRUE(std::get<FixInDoubt>(interruption).returns);
}

TEST_F(DrivingTest, RatesBeforeAHoleLeaveOutWhatWasMadeUp) {
  take(increment_between(0, 10));
  ImuIncrement made_up = increment_between(10, 20);
  made_up.dtheta_b.x() = 1;
  made_up.extra_gyro_noise_density = 0.1;
  take(made_up);
  EXPECT_NEAR(driving().take_recent_rates(made_up).gyro_b.x(), 0.1, 1e-12);
  // There are none any more: those of the next increment.
  EXPECT_NEAR(driving().take_recent_rates(increment_between(30, 40)).gyro_b.x(), 0.1, 1e-12);
}

/// A height that nobody has thought of.
struct Height final : measurement::Observation {
  explicit Height(double residual) : r(residual) {}
  std::string_view name() const override { return "height"; }
  state::Linearized linearize(const state::NavState&, const measurement::MeanMotion&,
                              const state::Layout& layout) const override {
    state::Linearized z(1, layout.size());
    z.r[0] = r;
    z.H(0, 2) = z.R(0, 0) = 1;
    return z;
  }
  double r;  ///< sigma 1
};

Observed height_at(double ms, double residual) {
  return {at(ms), std::make_shared<Height>(residual)};
}

TEST_F(DrivingTest, WhatElseWasMeasuredIsUsedAtItsStampIfItAgrees) {
  driving().observe(height_at(5, 2));
  driving().observe(height_at(7, 20));
  take(increment_between(0, 10));
  EXPECT_THAT(log_.calls, ElementsAre("start@0", "update@5"));
  EXPECT_THAT(sink_.epochs_ms, ElementsAre(0, 5, 7));
  ASSERT_EQ(sink_.observations.size(), 2u);
  EXPECT_EQ(sink_.observations[0].name, "height");
  EXPECT_EQ(sink_.observations[0].normalized_square, 4);
  EXPECT_TRUE(sink_.observations[0].used);
  EXPECT_FALSE(sink_.observations[1].used);
}

/// A node stands where it was used; the next hold comes a second after it.
TEST_F(DrivingTest, WhatElseWasMeasuredIsANode) {
  driving().observe(height_at(600, 0));
  take(increment_between(0, 1700));
  EXPECT_THAT(log_.calls, ElementsAre("start@0", "update@600", "hold@1600"));
}

TEST_F(DrivingTest, WhatElseWasMeasuredWaitsBehindAFixInDoubt) {
  settle();
  const std::size_t updates = log_.updates.size();
  const GnssFix fix = fix_at(12500, Vector3d(100, 0, 0));
  take(fix);
  driving().observe(height_at(12500, 0));
  ASSERT_TRUE(std::holds_alternative<FixInDoubt>(take(increment_between(12000, 13000))));
  EXPECT_EQ(log_.updates.size(), updates);
  diagnosis::DoubtOutcome outcome;
  outcome.fixes.emplace_back();
  outcome.fixes.back().action = diagnosis::FixDecision::Action::leave_out;
  outcome.fixes.back().fix = fix;
  driving().resume(fix, outcome);
  EXPECT_EQ(log_.updates.size(), updates + 1);
  EXPECT_EQ(sink_.observations.back().name, "height");
}

TEST_F(DrivingTest, WhatElseWasMeasuredTooEarlyIsNamedOnce) {
  take(increment_between(0, 100));
  driving().observe(height_at(50, 0));
  driving().observe(height_at(60, 0));
  ASSERT_EQ(sink_.notices.size(), 1u);
  EXPECT_EQ(sink_.notices[0].text,
            "height at 2023-11-14T22:13:20.050Z came after later measurements; such are left out");
}

TEST_F(DrivingTest, LateFixesAreLeftOutAndCounted) {
  take(increment_between(0, 100));
  take(fix_at(50));
  EXPECT_EQ(driving().late_fixes(), 1);
  EXPECT_EQ(sink_.fixes.back().verdict, state::FixVerdict::out_of_order);
}

TEST_F(DrivingTest, ASigmaThatIsNoneIsNamedOnce) {
  for (const double ms : {10, 20}) {
    GnssFix fix = fix_at(ms);
    fix.position_covariance.setZero();
    take(fix);
  }
  take(increment_between(0, 100));
  EXPECT_EQ(sink_.fixes.size(), 2u);
  EXPECT_EQ(sink_.fixes.back().verdict, state::FixVerdict::bad_sigma);
  EXPECT_EQ(sink_.notices.size(), 1u);
}

}  // namespace
}  // namespace foucault::navigation
