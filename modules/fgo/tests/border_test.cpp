#include <gtest/gtest.h>

#include <algorithm>

#include "foucault/fgo/batch.h"
#include "foucault/fgo/window_navigator.h"
#include "slow_drive.h"

namespace foucault::fgo {
namespace {

using namespace testing;

class Border : public SlowDrive {
 protected:
  static std::unique_ptr<WindowNavigator> window(
      double window_s, const state::Layout& layout = SlowDrive::layout()) {
    return std::make_unique<WindowNavigator>(
        window_of(window_s), preintegration::PreintegrationModel::refined, test_noise(), layout);
  }

  static BatchRecorder batch(const state::Layout& forward = layout()) {
    FgoOptions options;
    options.max_iterations = 50;
    return {window(10, forward), options, preintegration::PreintegrationModel::refined,
            test_noise(), layout()};
  }
};

TEST_F(Border, WindowFindsWhatDoesNotChange) {
  Consistency consistency;
  for (unsigned seed = 0; seed < 20; ++seed) {
    reseed(seed);
    draw_slow();
    const auto navigator = window(10);
    navigator->start(initial(1));
    drive(*navigator, 30, 20, 26);
    const state::Epoch last = navigator->epoch();
    consistency.add(whole_error(last), last);
    EXPECT_LT(std::sqrt(last.covariance(state::kNodeSize, state::kNodeSize)),
              0.3);  // of a prior of 5 K
  }
  consistency.expect_within();
}

TEST_F(Border, BatchFindsWhatDoesNotChange) {
  Consistency in_outage, end;
  for (unsigned seed = 0; seed < 20; ++seed) {
    reseed(100 + seed);
    draw_slow();
    BatchRecorder recorder = batch();
    recorder.start(initial(1));
    drive(recorder, 30, 18, 26);
    const std::deque<measurement::SmoothedEpoch> nodes = recorder.smoothed();
    in_outage.add(whole_error(nodes[22].epoch()), nodes[22].epoch());
    end.add(whole_error(nodes.back().epoch()), nodes.back().epoch());
  }
  in_outage.expect_within();
  end.expect_within();
}

/// Who knows nothing of scale factors takes them for something else.
TEST_F(Border, LeavingThemOutIsSeen) {
  Consistency consistency;
  for (unsigned seed = 0; seed < 5; ++seed) {
    reseed(seed);
    draw_slow();
    const auto navigator = window(10, state::Layout().add(kTemperature, 5));
    navigator->start(initial(1));
    drive(*navigator, 30, 20, 26);
    const state::Epoch last = navigator->epoch();
    const state::NodeVector e = error(last);
    consistency.node += e.dot(state::NodeMatrix(state::node_part(last.covariance)).ldlt().solve(e));
  }
  EXPECT_GT(consistency.node, 10 * 5 * state::kNodeSize);
}

/// The same whether the past is marginalized, all is in the window, or solved at the end; and
/// whether the forward run knew the blocks.
TEST_F(Border, AllRoutesEndThere) {
  const auto run = [&](measurement::Navigator& navigator) {
    reseed(7);
    draw_slow();
    navigator.start(initial(0.1));
    drive(navigator, 25, 10, 15);
  };
  const auto all = window(1e9);
  run(*all);
  const state::Epoch expected = all->epoch();
  const auto compare = [&](const state::Epoch& epoch, double tolerance) {
    const state::StateVector sigma = expected.covariance.diagonal().cwiseSqrt();
    EXPECT_LT(state::boxminus(epoch, expected).cwiseQuotient(sigma).cwiseAbs().maxCoeff(),
              tolerance);
    const state::StateVector own = epoch.covariance.diagonal().cwiseSqrt();
    // Old intervals stay linearized at the scale factors of their time.
    EXPECT_LT((own - sigma).cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.3 * tolerance);
  };
  const auto marginalized = window(5);
  run(*marginalized);
  compare(marginalized->epoch(), 0.02);
  for (const state::Layout& forward : {layout(), state::Layout().add(kTemperature, 5)}) {
    BatchRecorder recorder = batch(forward);
    run(recorder);
    compare(recorder.smoothed().back().epoch(), 0.02);
  }
}

/// A drive in parts, if there are passes.
class Parts : public Border {
 protected:
  std::deque<measurement::SmoothedEpoch> smoothed(const std::shared_ptr<BatchPasses>& passes) {
    longest_wait_ = 0;
    reseed(11);
    draw_slow();
    FgoOptions options;
    options.max_iterations = 50;
    constexpr auto kModel = preintegration::PreintegrationModel::refined;
    BatchRecorder recorder(
        std::make_unique<WindowNavigator>(window_of(10), kModel, test_noise(), layout()), options,
        kModel, test_noise(), layout(), passes);
    recorder.start(initial(1));
    std::deque<measurement::SmoothedEpoch> nodes;
    const auto take = [&](std::deque<measurement::SmoothedEpoch> more) {
      longest_wait_ = std::max(longest_wait_, recorder.size() - nodes.size());
      nodes.insert(nodes.end(), more.begin(), more.end());
    };
    drive(recorder, 300, 140, 150, [&] { take(recorder.settled()); });
    take(recorder.smoothed());
    return nodes;
  }

  /// Of states and sigmas, in sigmas of the whole.
  static double largest_difference(const std::deque<measurement::SmoothedEpoch>& parts,
                                   const std::deque<measurement::SmoothedEpoch>& whole) {
    EXPECT_EQ(parts.size(), whole.size());
    double largest = 0;
    for (std::size_t k = 0; k < whole.size(); ++k) {
      const state::Epoch a = parts.at(k).epoch();
      const state::Epoch b = whole[k].epoch();
      EXPECT_EQ(a.t_ns, b.t_ns);
      const state::StateVector sigma = b.covariance.diagonal().cwiseSqrt();
      const state::StateVector change = a.covariance.diagonal().cwiseSqrt() - sigma;
      for (const state::StateVector& d : {state::boxminus(a, b), change})
        largest = std::max(largest, d.cwiseQuotient(sigma).cwiseAbs().maxCoeff());
    }
    return largest;
  }

  std::size_t longest_wait_ = 0;
};

TEST_F(Parts, OfTwoPassesAreTheWhole) {
  const auto whole = smoothed(nullptr);
  const auto passes = std::make_shared<BatchPasses>();
  passes->most_nodes = 120;
  const auto first = smoothed(passes);
  EXPECT_FALSE(passes->is_final());
  *passes = {passes->most_nodes, passes->found, {}, false};
  const auto second = smoothed(passes);
  EXPECT_GT(passes->found.size(), 2u);
  EXPECT_TRUE(passes->is_final());
  EXPECT_LE(longest_wait_, 121u);
  EXPECT_LT(largest_difference(second, whole), 0.01);
  EXPECT_GT(largest_difference(first, whole), 0.1) << "it did not know the end";
}

/// What is estimated beside a node outlives a restart if the Epoch has it, and loosening.
TEST_F(Border, KeepsWhatItKnowsOverARestart) {
  reseed(9);
  draw_slow();
  const auto navigator = window(10);
  navigator->start(initial(1));
  drive(*navigator, 15, 99, 99);
  const state::Epoch before = navigator->epoch();
  state::NodeMatrix added = state::NodeMatrix::Zero();
  state::part(added, state::block::position, state::block::position).setIdentity();
  navigator->loosen(added);
  state::StateMatrix expected = before.covariance;
  state::node_part(expected) += added;
  EXPECT_LT((navigator->epoch().covariance - expected).norm(), 1e-6);
  EXPECT_LT((navigator->epoch().slow - before.slow).norm(), 1e-12);
  navigator->start(before);
  EXPECT_LT(state::boxminus(navigator->epoch(), before).norm(), 1e-7);
  EXPECT_LT((navigator->epoch().covariance - before.covariance).norm(), 1e-9);
  state::Epoch node = before;
  node.slow.resize(0);
  node.covariance = state::NodeMatrix(state::node_part(before.covariance));
  navigator->start(node);
  EXPECT_EQ(navigator->epoch().covariance(state::kNodeSize, state::kNodeSize), 25);
}

}  // namespace
}  // namespace foucault::fgo
