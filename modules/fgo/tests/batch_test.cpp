#include "foucault/fgo/batch.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "foucault/fgo/window_navigator.h"
#include "slow_drive.h"

namespace foucault::fgo {
namespace {

using namespace testing;

class BatchTest : public NoisyDrive {
 protected:
  std::unique_ptr<BatchRecorder> recorder(double window_s = 10) {
    auto forward = std::make_unique<WindowNavigator>(
        window_of(window_s), preintegration::PreintegrationModel::refined, test_noise());
    return std::make_unique<BatchRecorder>(
        std::move(forward), exact(), preintegration::PreintegrationModel::refined, test_noise());
  }

  static FgoOptions exact() {
    FgoOptions options;
    options.max_iterations = 50;
    return options;
  }
};

/// A chain as a recorder would leave it, six nodes with fixes at all but two.
struct ChainDrive : SlowDrive {
  explicit ChainDrive(const state::Layout& with = {})
      : context{frame_, preintegration::PreintegrationModel::refined, with} {}
  void TestBody() override {}
  using SlowDrive::fix_at;

  const GraphContext context;

  /// `integrated_at`: gyro bias of the preintegration. `keep`: the increments.
  BatchChain chain(double gyro_bias_sigma = 2e-4, const Vector3d& integrated_at = Vector3d::Zero(),
                   bool keep = false) {
    reseed(5);
    state::Epoch begin = initial(1);
    state::part(begin.covariance, state::block::gyro_bias, state::block::gyro_bias) =
        gyro_bias_sigma * gyro_bias_sigma * Matrix3d::Identity();
    state::NodeState x;
    x.p_w_b = frame_.to_local(begin.position);
    x.v_w_b = begin.velocity_n;
    x.q_w_b = begin.q_n_b;
    x.bias = begin.bias;
    BatchChain out;
    begin = state::with_slow_blocks(begin, context.layout);
    out.prior = prior_from_covariance(x, begin.slow, begin.covariance);
    out.nodes.push_back({0, x, {}});
    for (int k = 0; k < 5; ++k) {
      preintegration::Preintegrator integrator(test_noise(), {integrated_at, x.bias.accel},
                                               k * 1'000'000'000LL, std::nullopt,
                                               scale_of(context.layout, begin.slow));
      ImuInterval& interval = out.intervals.emplace_back();
      for (int64_t i = 0; i < 100; ++i) {
        const int64_t t = k * 1'000'000'000LL + i * 10'000'000;
        const ImuIncrement increment = noisy_increment(t, t + 10'000'000);
        integrator.add(increment);
        if (keep) interval.increments.push_back(increment);
      }
      interval.factor = std::make_unique<PreintegrationFactor>(integrator.result(), wuhan_earth(),
                                                               context.layout);
      x = predict(x, integrator.result(), wuhan_earth());
      BatchNode& node = out.nodes.emplace_back();
      node.x = x;
      if (k == 1 || k == 2) continue;
      node.observations.push_back({measurement::gnss_position(fix_at(k + 1, 0.02))});
      if (context.layout.slow_index(kTemperature)) node.observations.push_back({range_at(k + 1)});
    }
    return out;
  }
};

/// The cost's gradient and Gauss-Newton matrix, dense, the border behind.
struct Dense {
  Dense(const BatchChain& chain, const GraphContext& context, const BatchSolution& at)
      : slow(at.slow.size()),
        nodes(state::kNodeSize * static_cast<Eigen::Index>(at.x.size())),
        H(Eigen::MatrixXd::Zero(nodes + slow, nodes + slow)),
        gradient(Eigen::VectorXd::Zero(nodes + slow)) {
    const StateRows prior = PriorFactor(chain.prior).linearize(at.x[0], at.slow);
    add(0, prior.J, prior.r);
    for (std::size_t k = 0; k < at.x.size(); ++k) {
      const Eigen::Index own = state::kNodeSize * static_cast<Eigen::Index>(k);
      for (const NodeObservation& observation : chain.nodes[k].observations) {
        const ObservationRows z = linearize(observation, at.x[k], at.slow, context);
        add(own, z.J, z.r);
      }
      if (k + 1 == at.x.size()) break;
      const IntervalRows m = chain.intervals[k].factor->linearize(at.x[k], at.x[k + 1], at.slow);
      Eigen::MatrixXd J(state::kNodeSize, 2 * state::kNodeSize + slow);
      J << m.J_x0, m.J_x1, m.J_slow;
      add(own, J, m.r);
    }
  }

  /// Rows over the columns from `own` on, and the border.
  void add(Eigen::Index own, const Eigen::MatrixXd& J, const Eigen::VectorXd& r) {
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(J.rows(), nodes + slow);
    whole.middleCols(own, J.cols() - slow) = J.leftCols(J.cols() - slow);
    whole.rightCols(slow) = J.rightCols(slow);
    H += whole.transpose() * whole;
    gradient += whole.transpose() * r;
  }

  Eigen::MatrixXd covariance() const {
    // In units of sigmas, so that the dense inverse keeps its digits.
    const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
    return scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  }

  /// Rows of a node and the border.
  Eigen::VectorXi rows_of_node(std::size_t k) const {
    const int own = state::kNodeSize * static_cast<int>(k);
    Eigen::VectorXi rows(state::kNodeSize + slow);
    rows << Eigen::VectorXi::LinSpaced(state::kNodeSize, own, own + state::kNodeSize - 1),
        Eigen::VectorXi::LinSpaced(slow, static_cast<int>(nodes),
                                   static_cast<int>(nodes + slow) - 1);
    return rows;
  }

  Eigen::Index slow, nodes;
  Eigen::MatrixXd H;
  Eigen::VectorXd gradient;
};

/// That Gauss and Newton would still take [sigma].
double largest_step(const Dense& normal, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd step = covariance * normal.gradient;
  return step.cwiseQuotient(covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
}

void expect_least_squares(const state::Layout& layout) {
  ChainDrive drive(layout);
  BatchChain chain = drive.chain();
  FgoOptions options;
  options.max_iterations = 50;
  const BatchSolution solution = solve(chain, drive.context, options, test_noise());
  const Dense normal(drive.chain(), drive.context, solution);  // the same once more
  const Eigen::MatrixXd covariance = normal.covariance();
  EXPECT_LT(largest_step(normal, covariance), 1e-3);
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  for (std::size_t k = 0; k < solution.x.size(); ++k) {
    const Eigen::VectorXi rows = normal.rows_of_node(k);
    const Eigen::VectorXd unit = sigma(rows).cwiseInverse();
    const Eigen::MatrixXd difference = solution.covariance_w[k].full() - covariance(rows, rows);
    EXPECT_LT((unit.asDiagonal() * difference * unit.asDiagonal()).cwiseAbs().maxCoeff(), 1e-6)
        << "node " << k;
  }
}

TEST(Batch, IsTheLeastSquaresSolutionWithItsCovariance) { expect_least_squares({}); }

TEST(Batch, IsTheLeastSquaresSolutionWithABorder) {
  expect_least_squares(state::Layout()
                           .add(kTemperature, 5)
                           .add(state::block::gyro_scale, 3e-3)
                           .add(state::block::accel_scale, 3e-3));
}

/// A forward run whose biases jump at every fix, by 1e5 sigmas and more of what they drift between
/// two: the first step takes nearly all of the cost away, whatever it makes of the attitudes.
TEST(Batch, BiasesThatJumpDoNotHideWhatIsLeft) {
  ChainDrive drive;
  FgoOptions options;
  options.max_iterations = 50;
  BatchChain chain = drive.chain();
  for (std::size_t k = 0; k < chain.nodes.size(); ++k) {
    state::NodeState& x = chain.nodes[k].x;
    x.bias.accel.array() += k % 2 == 0 ? 1.0 : -1.0;
    x.q_w_b = x.q_w_b * so3::exp(Vector3d(0.01, -0.01, 0.03));
  }
  const BatchSolution solution = solve(chain, drive.context, options, test_noise());
  const Dense normal(drive.chain(), drive.context, solution);
  EXPECT_LT(largest_step(normal, normal.covariance()), 1e-3);
}

TEST(Batch, ABiasThatMovedIsIntegratedAnew) {
  // A phone's gyro bias, 0.05 rad/s, of which the forward run knew nothing.
  const Vector3d wrong(0.05, -0.03, 0.04);
  ChainDrive drive;
  FgoOptions options;
  options.max_iterations = 50;
  const auto solved = [&](const Vector3d& integrated_at, bool keep) {
    BatchChain chain = drive.chain(0.05, integrated_at, keep);
    return solve(chain, drive.context, options, test_noise());
  };
  const BatchSolution near = solved(Vector3d::Zero(), true);
  const auto off = [&](const BatchSolution& other) {
    double worst = 0;
    for (std::size_t k = 0; k < near.x.size(); ++k) {
      const state::NodeVector sigma = near.covariance_w[k].full().diagonal().cwiseSqrt();
      const state::NodeVector difference =
          state::boxminus(other.x[k], near.x[k]).cwiseQuotient(sigma);
      worst = std::max(worst, difference.cwiseAbs().maxCoeff());
    }
    return worst;
  };
  EXPECT_LT(off(solved(wrong, true)), 0.01);
  EXPECT_GT(off(solved(wrong, false)), 0.1);  // first-order updates alone
}

TEST(Batch, RobustLossShrugsOffAnOutlier) {
  ChainDrive drive;
  const auto solved = [&](const char* robust, double off) {
    BatchChain chain = drive.chain();
    GnssFix outlier = drive.fix_at(4, 0.02);
    outlier.antenna.height += off;
    chain.nodes[4].observations = {{measurement::gnss_position(outlier)}};
    FgoOptions options;
    options.robust = robust;
    options.max_iterations = 50;
    return solve(chain, drive.context, options, test_noise()).x[4].p_w_b;
  };
  const Vector3d right = solved("none", 0);
  EXPECT_GT((solved("none", 10) - right).norm(), 0.3);
  for (const char* robust : {"huber", "cauchy"}) {
    EXPECT_LT((solved(robust, 10) - right).norm(), 0.1) << robust;
  }
}

/// Dead reckoning from an attitude off by tens of degrees, with increments known to 1e-5 m/s: the
/// valley of the cost is curved, and a plain Gauss-Newton step climbs out of it.
TEST_F(BatchTest, ConvergesFromAttitudesFarOff) {
  imu::ImuNoise noise = test_noise();
  noise.gyro_noise_density = 1e-6;
  noise.accel_noise_density = 1e-5;
  const GraphContext context{frame_, preintegration::PreintegrationModel::refined, {}};
  for (unsigned seed = 0; seed < 20; ++seed) {
    reseed(seed);
    state::NodeState x = motion_.state(0);
    const Vector3d sigma(0.1, 0.1, 0.4);
    x.q_w_b = x.q_w_b * so3::exp(draw(1).cwiseProduct(sigma));
    state::Epoch begin = initial(1);
    state::part(begin.covariance, state::block::attitude, state::block::attitude).diagonal() +=
        sigma.cwiseAbs2();
    BatchChain chain;
    chain.prior = prior_from_covariance(x, state::SlowVector(0), begin.covariance);
    chain.nodes.push_back({0, x, {}});
    for (int second = 0; second < 20; ++second) {
      const preintegration::Preintegration pre =
          preintegrate(motion_.increments(second, second + 1, 100), noise, x.bias);
      chain.intervals.emplace_back().factor =
          std::make_unique<PreintegrationFactor>(pre, wuhan_earth());
      x = predict(x, pre, wuhan_earth());
      chain.nodes.push_back(
          {pre.t_end_ns, x, {{measurement::gnss_position(fix_at(second + 1, 0.02))}}});
    }
    const BatchSolution solution = solve(chain, context, exact(), noise);
    const state::NodeVector e = state::boxminus(motion_.state(20), solution.x.back());
    EXPECT_LT(state::part(e, state::block::position).norm(), 0.15) << seed;
    EXPECT_LT(state::part(e, state::block::attitude).norm(), 0.02) << seed;
  }
}

TEST_F(BatchTest, EndsWhereAWindowOverEverythingEnds) {
  reseed(1);
  WindowNavigator window(window_of(1e9), preintegration::PreintegrationModel::refined,
                         test_noise());
  window.start(initial(0.1));
  run(window, 25, 10, 15, [](int) {});
  reseed(1);
  const std::unique_ptr<BatchRecorder> batch = recorder();
  batch->start(initial(0.1));
  run(*batch, 25, 10, 15, [](int) {});
  const std::deque<measurement::SmoothedEpoch> nodes = batch->smoothed();
  ASSERT_EQ(nodes.size(), 26u);
  const state::Epoch a = nodes.back().epoch();
  const state::Epoch b = window.epoch();
  const state::NodeVector sigma = b.covariance.diagonal().cwiseSqrt();
  EXPECT_LT((error(a) - error(b)).cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 1e-2);
  EXPECT_LT(
      (a.covariance.diagonal().cwiseSqrt() - sigma).cwiseQuotient(sigma).cwiseAbs().maxCoeff(),
      1e-3);
}

TEST_F(BatchTest, ErrorsInAnOutageStayWithinTheirCovarianceAndBelowForward) {
  double nees_sum = 0, forward_square = 0, smoothed_square = 0;
  constexpr int kRuns = 20;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    reseed(seed);
    const std::unique_ptr<BatchRecorder> batch = recorder();
    batch->start(initial(1));
    state::Epoch forward;
    run(*batch, 35, 15, 26, [&](int second) {
      if (second == 25) forward = batch->epoch();
    });
    const std::deque<measurement::SmoothedEpoch> nodes = batch->smoothed();
    const state::NodeVector e = error(nodes[20].epoch());
    nees_sum += e.dot(nodes[20].epoch().covariance.ldlt().solve(e));
    smoothed_square += error(nodes[20].epoch()).head<2>().squaredNorm();
    forward_square += error(forward).head<2>().squaredNorm();
    const state::NodeVector variance = nodes[25].epoch().covariance.diagonal();
    EXPECT_LT(variance.head<3>().sum(), forward.covariance.diagonal().head<3>().sum());
  }
  // Sum of kRuns chi-squares of 15; 99.9 %.
  EXPECT_NEAR(nees_sum, 15.0 * kRuns, 3.3 * std::sqrt(2 * 15.0 * kRuns));
  EXPECT_LT(smoothed_square, forward_square / 4);
}

TEST_F(BatchTest, WhatItFoundInTheForwardRunPutsItRight) {
  reseed(2);
  const std::unique_ptr<BatchRecorder> batch = recorder();
  batch->start(initial(0.1));
  state::Epoch forward;
  run(*batch, 20, 8, 14, [&](int second) {
    if (second == 13) forward = batch->epoch();
  });
  const measurement::SmoothedEpoch node = batch->smoothed()[13];
  const state::NavState right = state::boxplus(forward, node.after);
  EXPECT_LT(state::boxminus(node.state, right).norm(), 1e-8);
  EXPECT_GT(node.after.head<3>().norm(), 1e-3);
}

TEST_F(BatchTest, ANewStartIsANewChain) {
  reseed(3);
  const std::unique_ptr<BatchRecorder> batch = recorder();
  batch->start(initial(0.1));
  run(*batch, 5, 99, 99, [](int) {});
  const std::size_t before = batch->size();
  reseed(3);
  batch->start(initial(0.1));
  run(*batch, 5, 99, 99, [](int) {});
  const std::deque<measurement::SmoothedEpoch> nodes = batch->smoothed();
  ASSERT_EQ(nodes.size(), 2 * before);
  for (std::size_t k = 0; k < before; ++k) {
    EXPECT_LT((error(nodes[k].epoch()) - error(nodes[before + k].epoch())).norm(), 1e-6);
  }
}

/// Fixes of the second half are 5 m off the first: a jump that no motion explains.
TEST_F(BatchTest, LooseningBridgesAJumpOfTheState) {
  const auto largest_postfit = [&](bool loosened) {
    reseed(4);
    const std::unique_ptr<BatchRecorder> batch = recorder();
    batch->start(initial(0.1));
    std::vector<GnssFix> fixes;
    for (int second = 1; second <= 20; ++second) {
      for (int64_t t = (second - 1) * 1'000'000'000LL; t < second * 1'000'000'000LL;
           t += 10'000'000)
        batch->propagate(noisy_increment(t, t + 10'000'000));
      GnssFix fix = fix_at(second, 0.02);
      if (second > 10) fix.antenna = geodesy::LocalFrame(fix.antenna).to_geodetic({5, 0, 0});
      if (second == 11 && loosened) {
        state::NodeMatrix added = state::NodeMatrix::Zero();
        added.diagonal().head<3>().setConstant(25);
        batch->loosen(added);
      }
      batch->update(measurement::gnss_position(fix));
      fixes.push_back(fix);
    }
    const std::deque<measurement::SmoothedEpoch> nodes = batch->smoothed();
    double largest = 0;
    for (std::size_t k = 0; k < fixes.size(); ++k) {
      const state::Epoch epoch = nodes[k + 1].epoch();
      const Vector3d antenna_n = geodesy::LocalFrame(epoch.position).to_local(fixes[k].antenna);
      largest = std::max(largest, (antenna_n - epoch.q_n_b * fixes[k].p_b_a).norm());
    }
    return largest;
  };
  EXPECT_LT(largest_postfit(true), 0.1);
  EXPECT_GT(largest_postfit(false), 1);
}

}  // namespace
}  // namespace foucault::fgo
