#include "../src/prediction_probe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "foucault/core/time.h"
#include "foucault/measurement/gnss_position.h"

namespace foucault::navigation {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Pair;

/// Its innovation tells how long it has propagated since the last update [s].
class Coasting : public measurement::Navigator {
 public:
  void start(const state::Epoch&) override {}
  void propagate(const ImuIncrement& increment) override { since_update_s_ += increment.dt(); }
  state::Innovation innovation(const measurement::Observation&) const override {
    return {Eigen::Vector3d(since_update_s_, 0, 0), Eigen::Matrix3d::Identity()};
  }
  void update(const measurement::ObservationPtr&) override { since_update_s_ = 0; }
  void loosen(const state::NodeMatrix&) override {}
  void hold() override {}
  state::Epoch epoch() const override { return {}; }
  std::unique_ptr<measurement::Navigator> ahead(double) const override {
    ++copies;
    return std::make_unique<Coasting>(*this);
  }

  mutable int copies = 0;

 private:
  double since_update_s_ = 0;
};

/// Horizon and time coasted of each prediction.
using Predictions = std::vector<std::pair<double, double>>;

/// One increment a second, fixes at the seconds for which `fixed` is true.
Predictions drive(int until_s, const std::function<bool(int)>& fixed, Coasting& navigator) {
  PredictionProbe probe;
  Predictions predictions;
  for (int t = 1; t <= until_s; ++t) {
    ImuIncrement increment;
    increment.t_begin_ns = nanoseconds(t - 1);
    increment.t_end_ns = nanoseconds(t);
    navigator.propagate(increment);
    probe.propagate(increment);
    if (!fixed(t)) continue;
    GnssFix fix;
    fix.t_ns = nanoseconds(t);
    navigator.update(measurement::gnss_position(fix));
    const auto prediction = probe.meet(fix, navigator);
    if (prediction) predictions.emplace_back(prediction->ahead_s, prediction->innovation_n.x());
  }
  return predictions;
}

TEST(PredictionProbe, CoastsFromAnUpdatedStateOverThreeHorizons) {
  Coasting navigator;
  EXPECT_THAT(drive(
                  100, [](int) { return true; }, navigator),
              ElementsAre(Pair(5, DoubleNear(5, 1e-9)), Pair(15, DoubleNear(15, 1e-9)),
                          Pair(30, DoubleNear(30, 1e-9))));
}

TEST(PredictionProbe, ProbesDoNotOverlap) {
  Coasting navigator;
  const Predictions predictions = drive(
      1000, [](int) { return true; }, navigator);
  EXPECT_EQ(predictions.size(), 3u * static_cast<std::size_t>(navigator.copies));
  EXPECT_GE(navigator.copies, 2);
}

TEST(PredictionProbe, HorizonsWithoutAFixAreLeftOut) {
  Coasting navigator;
  // The probe starts at 61 s; fixes are missing until 73 s and at 91 s: that at 74 s is used for
  // no horizon, that at 76 s for 15 s, and that at 92 s, one second late, for 30 s.
  const auto fixed = [](int t) { return t <= 61 || (t >= 74 && t != 91); };
  EXPECT_THAT(drive(110, fixed, navigator),
              ElementsAre(Pair(15, DoubleNear(15, 1e-9)), Pair(30, DoubleNear(31, 1e-9))));
}

TEST(PredictionProbe, ANewStartEndsTheProbe) {
  PredictionProbe probe;
  const Coasting navigator;
  GnssFix fix;
  for (int t = 0; t < 62; ++t) {
    fix.t_ns = nanoseconds(t);
    EXPECT_FALSE(probe.meet(fix, navigator));
  }
  ASSERT_EQ(navigator.copies, 1);
  probe.restart();
  fix.t_ns = nanoseconds(65);
  EXPECT_FALSE(probe.meet(fix, navigator));
}

}  // namespace
}  // namespace foucault::navigation
