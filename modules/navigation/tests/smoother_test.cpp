#include "foucault/navigation/smoother.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_run.h"
#include "foucault/core/error.h"

namespace foucault::navigation {
namespace {

using measurement::SmoothedEpoch;
using testing::at;
using testing::fix_at;
using testing::increment_between;
using testing::kPlace;
using Vector3d = Eigen::Vector3d;

SmoothedEpoch node(double ms, double variance) {
  SmoothedEpoch node;
  node.state.t_ns = at(ms);
  node.state.position = kPlace;
  node.covariance = state::PackedSymmetric(
      variance * state::StateMatrix::Identity(state::NodeVector::RowsAtCompileTime,
                                              state::NodeVector::RowsAtCompileTime));
  return node;
}

/// The error of a constant error of acceleration a: position a t^2 / 2, velocity a t, a cubic with
/// those slopes exactly.
TEST(Between, ErrorsOfAConstantAccelerationAreMetExactly) {
  const double length = 2, t = 0.7, a = 0.3;
  SmoothedEpoch begin = node(0, 1), end = node(1000 * length, 3);
  part(end.before, state::block::velocity) = Vector3d(a * length, 0, 0);
  part(end.before, state::block::position) = Vector3d(a * length * length / 2, 0, 0);
  state::NavState forward;
  forward.t_ns = at(1000 * t);
  forward.position = kPlace;
  const state::Epoch epoch = between(begin, end, forward);
  const Vector3d moved = testing::LocalFrame(kPlace).to_local(epoch.position);
  EXPECT_NEAR(moved.x(), a * t * t / 2, 1e-6);
  EXPECT_NEAR(epoch.velocity_n.x(), a * t, 1e-12);
  EXPECT_NEAR(epoch.covariance(4, 4), 1 + 2 * t / length, 1e-12);
}

/// A fake navigator and the nodes that it leaves: one a stop, the smoothed state 10 m north.
class FakeRecorder : public testing::FakeNavigator, public measurement::Recording {
 public:
  explicit FakeRecorder(testing::Log& log) : FakeNavigator(log, Vector3d::Zero()) {}
  std::size_t mark() override {
    const int64_t now_ns = epoch().t_ns;
    if (stamps_.empty() || stamps_.back() != now_ns) stamps_.push_back(now_ns);
    return stamps_.size() - 1;
  }
  bool at_node() const override { return !stamps_.empty() && stamps_.back() == epoch().t_ns; }
  std::size_t size() const override { return stamps_.size(); }
  std::deque<SmoothedEpoch> settled() override {
    return in_parts && !stamps_.empty() ? nodes_before(stamps_.size() - 1)
                                        : std::deque<SmoothedEpoch>();
  }
  std::deque<SmoothedEpoch> smoothed() override { return nodes_before(stamps_.size()); }

  double variance = 1;
  bool in_parts = false;
  state::SlowVector slow;

 private:
  std::deque<SmoothedEpoch> nodes_before(std::size_t end) {
    std::deque<SmoothedEpoch> nodes;
    for (; given_out_ < end; ++given_out_) {
      nodes.push_back(node(0, variance));
      nodes.back().state.t_ns = stamps_[given_out_];
      nodes.back().state.position = testing::LocalFrame(kPlace).to_geodetic(Vector3d(10, 0, 0));
      nodes.back().state.velocity_n = Vector3d(0, 5, 0);
      nodes.back().state.slow = slow;
    }
    return nodes;
  }

  std::size_t given_out_ = 0;
  std::vector<int64_t> stamps_;
};

class SmootherTest : public ::testing::Test {
 protected:
  void run(double variance, bool in_parts = false) { run(variance, in_parts, sink_); }

  void run(double variance, bool in_parts, state::Sink& sink) {
    alignment::AlignmentOptions options;
    options.mode = "given";
    options.roll_deg = options.pitch_deg = options.heading_deg = 0;
    auto recorder = std::make_unique<FakeRecorder>(log_);
    recorder->variance = variance;
    recorder->in_parts = in_parts;
    recorder->slow = slow_;
    NavigationRunOptions run_options;
    run_options.layout = layout_;
    const std::unique_ptr<state::Estimator> smoother =
        make_smoother(std::move(recorder),
                      alignment::Aligner(options, imu::imu_preset("ADIS16465"), state::Mounting{}),
                      run_options, sink);
    smoother->process(increment_between(0, 10));
    smoother->process(fix_at(10));
    smoother->process(fix_at(50));
    for (int t = 10; t < 100; t += 10) smoother->process(increment_between(t, t + 10));
    EXPECT_EQ(sink_.epochs_ms.empty(), !in_parts) << "before the end";
    smoother->finish();
  }

  testing::Log log_;
  testing::RecordingSink sink_;
  state::Layout layout_;
  state::SlowVector slow_;
};

TEST_F(SmootherTest, GivesEverythingOutAtTheEndWithPostfitsOfTheSmoothedSolution) {
  run(1);
  EXPECT_THAT(sink_.epochs_ms, ::testing::ElementsAre(10, 50));
  ASSERT_EQ(sink_.fixes.size(), 1u);
  EXPECT_NEAR(sink_.fixes[0].innovation_n.x(), 0, 1e-9);
  EXPECT_NEAR(sink_.fixes[0].postfit_n.x(), -10, 1e-6);
}

TEST_F(SmootherTest, GivesPartsOutWhenTheyAreSettled) {
  run(1, true);
  EXPECT_THAT(sink_.epochs_ms, ::testing::ElementsAre(10, 50));
  ASSERT_EQ(sink_.fixes.size(), 1u);
  EXPECT_NEAR(sink_.fixes[0].postfit_n.x(), -10, 1e-6);
}

/// Half a metre of arm that was not told, and clocks that are 20 ms apart at the first fix and
/// drift.
TEST_F(SmootherTest, PostfitsAreWithTheLeverArmAndTheClocksThatWereFound) {
  layout_.add(state::block::lever_arm, 1);
  layout_.add(state::block::time_offset, 1);
  layout_.add(state::block::time_drift, 1);
  slow_ = state::SlowVector::Zero(layout_.slow_size());
  slow_.head<3>() = Vector3d(0.5, 0, 0);
  slow_.tail<2>() << 0.02, 0.5;
  run(1);
  ASSERT_EQ(sink_.fixes.size(), 1u);
  EXPECT_NEAR(sink_.fixes[0].postfit_n.x(), -10.5, 1e-6);
  const double since_first = 0.04;
  EXPECT_NEAR(sink_.fixes[0].postfit_n.y(), 5 * (0.02 + 0.5 * since_first), 1e-6);
}

/// Of the forward run a sink that asks for it is told at once.
TEST_F(SmootherTest, TellsTheForwardRunAsItGoes) {
  class Told : public state::ForwardSink {
   public:
    void epoch(const state::Epoch& epoch) override { smoothed.push_back(epoch.t_ns); }
    void forward_epoch(const state::Epoch& epoch) override {
      EXPECT_TRUE(smoothed.empty()) << "before everything that is smoothed";
      forward.push_back(epoch.t_ns);
    }
    std::vector<int64_t> smoothed, forward;
  } told;
  run(1, false, told);
  EXPECT_EQ(told.forward, told.smoothed);
  EXPECT_EQ(told.forward.size(), 2u);
}

TEST_F(SmootherTest, ASolutionThatIsNoNumberIsAnErrorAndNoRow) {
  EXPECT_THROW(run(-1), DataError);
  EXPECT_TRUE(sink_.epochs_ms.empty());
}

}  // namespace
}  // namespace foucault::navigation
