#include "../src/aiding.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "fake_run.h"

namespace foucault::navigation {
namespace {

using namespace foucault::testing;  // NOLINT: the fakes

/// A navigator at rest or in motion whose velocity and rates are known to `sigma`.
class KnownNavigator : public FakeNavigator {
 public:
  KnownNavigator(Log& log, const Vector3d& velocity_n, double sigma)
      : FakeNavigator(log, velocity_n), sigma_(sigma) {}
  state::Epoch epoch() const override {
    state::Epoch epoch = FakeNavigator::epoch();
    epoch.covariance.diagonal()
        .segment<3>(state::block::velocity.offset)
        .setConstant(sigma_ * sigma_);
    return epoch;
  }

 private:
  double sigma_;
};

class AidingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.imu = imu::imu_preset("ADIS16465");
    options_.gnss.gate_false_alarm = 1e-7;
    options_.aids.zero_velocity = options_.aids.nonholonomic = options_.aids.wheel_speed = "auto";
  }

  /// A second of 100 Hz that ends in a stop.
  void second(Aiding& aiding, Navigator& navigator, bool held,
              const Vector3d& rate = Vector3d::Zero(), bool made_up = false) {
    for (int i = 0; i < 100; ++i, now_ms_ += 10) {
      ImuIncrement increment = increment_between(now_ms_, now_ms_ + 10);
      const double shake = (i % 2 == 0 ? 1 : -1) * shake_;
      increment.dtheta_b = (rate + Vector3d(0, 0, shake)) * increment.dt();
      increment.dvel_b = Vector3d(shake, 0, -9.8) * increment.dt();
      aiding.propagate(increment, made_up);
    }
    EXPECT_TRUE(aiding.is_due(at(now_ms_)));
    aiding.stop(at(now_ms_), held, navigator);
    EXPECT_FALSE(aiding.is_due(at(now_ms_)));
  }

  int count(const std::string& name, bool used = true) const {
    return static_cast<int>(
        std::count_if(sink_.observations.begin(), sink_.observations.end(),
                      [&](const auto& o) { return o.name == name && o.used == used; }));
  }

  Aiding started() {
    Aiding aiding(options_, sink_);
    aiding.start(at(0), {});
    return aiding;
  }

  NavigationRunOptions options_;
  RecordingSink sink_;
  Log log_;
  double now_ms_ = 0;
  double shake_ = 1e-3;
};

TEST_F(AidingTest, RestThatFixesShowIsUsedOnceASecond) {
  Aiding aiding = started();
  KnownNavigator navigator(log_, Vector3d::Zero(), 0.01);
  for (int s = 0; s < 5; ++s) second(aiding, navigator, true);
  EXPECT_EQ(count("zero_velocity"), 5);
  EXPECT_EQ(count("zero_rate"), 5);
}

/// On the spot the velocity is zero, and yet it does not rest.
TEST_F(AidingTest, ATurnOnTheSpotIsNoRest) {
  Aiding aiding = started();
  KnownNavigator navigator(log_, Vector3d::Zero(), 0.01);
  for (int s = 0; s < 5; ++s) second(aiding, navigator, true, {0, 0, 0.3});
  EXPECT_TRUE(sink_.observations.empty());
}

/// In an outage that has lasted the state cannot tell, but the IMU shakes as it did at rest.
TEST_F(AidingTest, RestInAnOutageIsKnownByHowTheImuShakes) {
  Aiding aiding = started();
  KnownNavigator stands(log_, Vector3d::Zero(), 0.01), drives(log_, Vector3d(8, 0, 0), 0.01);
  for (int s = 0; s < 20; ++s) second(aiding, stands, true);
  shake_ = 0.05;
  for (int s = 0; s < 200; ++s) second(aiding, drives, true);
  const int before = count("zero_velocity");
  KnownNavigator lost(log_, Vector3d(0.02, 0.01, 0), 3);
  second(aiding, lost, false);
  EXPECT_EQ(count("zero_velocity"), before);  // it shakes as in motion
  shake_ = 1e-3;
  second(aiding, lost, false);
  EXPECT_EQ(count("zero_velocity"), before + 1);
}

TEST_F(AidingTest, WhatWasMadeUpIsNoMeasurement) {
  Aiding aiding = started();
  KnownNavigator navigator(log_, Vector3d::Zero(), 0.01);
  second(aiding, navigator, true, Vector3d::Zero(), true);
  EXPECT_TRUE(sink_.observations.empty());
}

/// It rolls north with its nose to the north; a minute of fixes shows it.
TEST_F(AidingTest, WheelsAreUsedOnceTheyWereSeenToRoll) {
  Aiding aiding = started();
  KnownNavigator navigator(log_, Vector3d(8, 0, 0), 0.01);
  shake_ = 0.05;
  for (int s = 0; s < 20; ++s) {
    aiding.add(WheelSpeed{at(now_ms_ + 505), 8});
    second(aiding, navigator, true);
  }
  EXPECT_EQ(count("nonholonomic") + count("wheel_speed"), 0);
  for (int s = 0; s < 40; ++s) {
    aiding.add(WheelSpeed{at(now_ms_ + 505), 8});
    second(aiding, navigator, true);
  }
  EXPECT_GT(count("nonholonomic"), 10);
  EXPECT_GT(count("wheel_speed"), 10);
}

/// It flies sideways now and then: nothing is assumed.
TEST_F(AidingTest, WhatFliesIsNotSaidToRoll) {
  Aiding aiding = started();
  shake_ = 0.05;
  for (int s = 0; s < 80; ++s) {
    KnownNavigator navigator(log_, Vector3d(6 * std::cos(0.1 * s), 6 * std::sin(0.1 * s), 1), 0.01);
    second(aiding, navigator, true);
  }
  EXPECT_EQ(count("nonholonomic") + count("nonholonomic", false), 0);
}

TEST_F(AidingTest, OnIsOnFromTheBeginningAndOffIsOff) {
  options_.aids.nonholonomic = "on";
  options_.aids.zero_velocity = "off";
  Aiding aiding = started();
  KnownNavigator drives(log_, Vector3d(8, 0, 0), 0.01), stands(log_, Vector3d::Zero(), 0.01);
  second(aiding, drives, true);
  second(aiding, stands, true);
  EXPECT_EQ(count("nonholonomic"), 2);
  EXPECT_EQ(count("zero_velocity"), 0);
}

/// A state that drifts sideways by metres is not pulled: it does not agree.
TEST_F(AidingTest, WhatDoesNotAgreeIsCountedAndLeftOut) {
  options_.aids.nonholonomic = "on";
  Aiding aiding = started();
  KnownNavigator sideways(log_, Vector3d(8, 3, 0), 0.01);
  second(aiding, sideways, true);
  EXPECT_EQ(count("nonholonomic", false), 1);
  EXPECT_EQ(count("nonholonomic"), 0);
}

TEST_F(AidingTest, ModeNoneAsksForNothing) {
  options_.aids.mode = "none";
  Aiding aiding = started();
  EXPECT_FALSE(aiding.is_due(at(5000)));
}

}  // namespace
}  // namespace foucault::navigation
