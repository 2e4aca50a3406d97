#include "foucault/ekf/rts.h"

#include <gtest/gtest.h>

#include <map>

#include "foucault/core/constants.h"
#include "foucault/navigation/smoother.h"
#include "foucault/simulation/simulated_source.h"
#include "trip.h"

namespace foucault::ekf {
namespace {

using test::Trip;

constexpr int kSize = state::kNodeSize;

/// A linear estimation problem in the error state: x_0 ~ (0, P0), x_k+1 = phi_k x_k + w,
/// z_k = position of x_k + noise. Attitude errors are small enough for rotations to add up.
struct LinearProblem {
  static constexpr int kNodes = 6;
  state::NodeMatrix P0;
  std::vector<state::NodeMatrix> phi, Q;  ///< from node k to k + 1
  std::vector<Eigen::Vector3d> z;
  Eigen::Matrix3d R = Eigen::Vector3d(0.01, 0.02, 0.04).asDiagonal();
};

state::NodeVector sigmas() {
  state::NodeVector s;
  s << Eigen::Vector3d::Constant(0.3), Eigen::Vector3d::Constant(0.2),
      Eigen::Vector3d::Constant(1e-7), Eigen::Vector3d::Constant(1e-3),
      Eigen::Vector3d::Constant(1e-2);
  return s;
}

LinearProblem random_problem() {
  std::mt19937_64 rng{11};
  const state::NodeVector s = sigmas();
  LinearProblem p;
  p.P0 = test::random_covariance(rng, s);
  for (int k = 0; k < LinearProblem::kNodes; ++k) {
    state::NodeMatrix mix;
    for (int i = 0; i < 15; ++i) mix.col(i) = 0.2 * test::draw15(rng);
    mix.bottomRows<15 - state::kMotionSize>() =
        state::NodeMatrix(mix.diagonal().asDiagonal()).bottomRows<15 - state::kMotionSize>();
    p.phi.push_back(s.asDiagonal() * (state::NodeMatrix::Identity() + mix) *
                    s.cwiseInverse().asDiagonal());
    p.Q.push_back(0.1 * test::random_covariance(rng, s));
    p.z.push_back(0.3 * test::draw3(rng));
  }
  return p;
}

state::NavState origin() {
  state::NavState state;
  state.position = {0.1, 0.2, 30};
  return state;
}

/// The filter's forward pass as nodes.
std::deque<RtsNode> filtered(const LinearProblem& p) {
  std::deque<RtsNode> nodes;
  state::NodeVector x = state::NodeVector::Zero();
  state::NodeMatrix P = p.P0;
  for (int k = 0; k < LinearProblem::kNodes; ++k) {
    RtsNode node;
    node.begins_run = k == 0;
    if (k > 0) {
      x = (p.phi[k - 1] * x).eval();
      P = (p.phi[k - 1] * P * p.phi[k - 1].transpose() + p.Q[k - 1]).eval();
      node.motion = p.phi[k - 1].topRows<state::kMotionSize>();
      node.decay = p.phi[k - 1].diagonal().tail<15 - state::kMotionSize>();
    }
    node.predicted = state::boxplus(origin(), x);
    node.predicted_covariance = state::PackedSymmetric(P);
    const Eigen::Matrix<double, 15, 3> K =
        P.leftCols<3>() * (P.topLeftCorner<3, 3>() + p.R).inverse();
    x = (x + K * (p.z[k] - x.head<3>())).eval();
    P = (P - K * P.topRows<3>()).eval();
    node.filtered = state::boxplus(origin(), x);
    node.filtered_covariance = state::PackedSymmetric(P);
    nodes.push_back(node);
  }
  return nodes;
}

struct Batch {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;
};

/// All states at once, by the normal equations in units of sigmas.
Batch least_squares(const LinearProblem& p) {
  const int n = 15 * LinearProblem::kNodes;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  information.topLeftCorner<15, 15>() = p.P0.inverse();
  for (int k = 0; k < LinearProblem::kNodes; ++k) {
    information.block<3, 3>(15 * k, 15 * k) += p.R.inverse();
    right.segment<3>(15 * k) += p.R.inverse() * p.z[k];
    if (k + 1 == LinearProblem::kNodes) break;
    Eigen::Matrix<double, 15, 30> J;
    J << -p.phi[k], state::NodeMatrix::Identity();
    information.block<30, 30>(15 * k, 15 * k) += J.transpose() * p.Q[k].inverse() * J;
  }
  const Eigen::VectorXd scale = sigmas().replicate(LinearProblem::kNodes, 1);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::MatrixXd covariance = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  return {covariance * right, covariance};
}

TEST(Rts, EqualsBatchLeastSquaresOnALinearProblem) {
  const LinearProblem p = random_problem();
  const std::deque<measurement::SmoothedEpoch> nodes = smooth(filtered(p));
  const Batch batch = least_squares(p);
  const state::NodeVector units = sigmas().cwiseInverse();
  for (int k = 0; k < LinearProblem::kNodes; ++k) {
    const state::NodeVector x = state::boxminus(nodes[k].state, origin());
    const state::NodeVector dx = units.asDiagonal() * (x - batch.x.segment<15>(15 * k));
    const state::NodeMatrix dP =
        units.asDiagonal() *
        (nodes[k].covariance.full() - batch.covariance.block<15, 15>(15 * k, 15 * k)) *
        units.asDiagonal();
    // A metre of the ellipsoid is linear to 1e-7.
    EXPECT_LT(dx.cwiseAbs().maxCoeff(), 1e-6) << "node " << k;
    EXPECT_LT(dP.cwiseAbs().maxCoeff(), 1e-9) << "node " << k;
  }
}

TEST(Rts, NothingIsCarriedBackOverAStart) {
  std::deque<RtsNode> nodes = filtered(random_problem());
  nodes[3].begins_run = true;
  const std::deque<measurement::SmoothedEpoch> alone = smooth({nodes.begin(), nodes.begin() + 3});
  const std::deque<measurement::SmoothedEpoch> both = smooth(nodes);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(state::boxminus(both[k].state, alone[k].state).norm(), 0);
    EXPECT_EQ(alone[k].covariance.full(), both[k].covariance.full());
  }
}

/// A trip through the driver: epochs of one method with the truth at their stamps.
struct Collected : public state::Sink {
  void epoch(const state::Epoch& e) override { epochs.push_back(e); }
  void fix(const state::FixResult& f) override { fixes.push_back(f); }
  std::vector<state::Epoch> epochs;
  std::vector<state::FixResult> fixes;
};

constexpr double kOutageBegin = 200;
constexpr double kOutageEnd = 260;

simulation::ScenarioOptions trip_options(int64_t seed) {
  simulation::ScenarioOptions options;
  options.duration_s = 320;
  options.imu_rate_hz = 100;
  options.reference_rate_hz = 0;
  options.seed = seed;
  return options;
}

alignment::AlignmentOptions given_alignment(const simulation::SimulatedSource& source,
                                            int64_t start_ns) {
  const so3::Euler euler = so3::to_euler(source.truth(start_ns).q_n_b);
  alignment::AlignmentOptions options;
  options.mode = "given";
  options.roll_deg = euler.roll / kDegree;
  options.pitch_deg = euler.pitch / kDegree;
  options.heading_deg = euler.heading / kDegree;
  return options;
}

bool in_outage(double t) { return t > kOutageBegin && t <= kOutageEnd; }

void feed(state::Estimator& estimator, simulation::SimulatedSource& source, int64_t start_ns) {
  while (const std::optional<Measurement> m = source.next()) {
    const bool withheld =
        std::holds_alternative<GnssFix>(*m) && in_outage(seconds_between(start_ns, stamp(*m)));
    if (!withheld) estimator.process(*m);
  }
  estimator.finish();
}

/// What forward and smoothed runs over the same recording give.
struct BothWays {
  Collected forward, smoothed;
};

Collected run_smoother(const simulation::ScenarioOptions& scenario, const imu::ImuNoise& noise,
                       const navigation::NavigationRunOptions& options = {}) {
  Collected collected;
  simulation::SimulatedSource source(scenario, noise);
  alignment::Aligner aligner(given_alignment(source, scenario.start_ns()), noise,
                             source.mounting());
  const std::unique_ptr<state::Estimator> rts =
      navigation::make_smoother(std::make_unique<RtsRecorder>(noise, state::Layout{}, EkfOptions{}),
                                std::move(aligner), options, collected);
  feed(*rts, source, scenario.start_ns());
  return collected;
}

BothWays run_both_ways(const simulation::ScenarioOptions& scenario, const imu::ImuNoise& noise) {
  const int64_t start_ns = scenario.start_ns();
  BothWays both;
  {
    simulation::SimulatedSource source(scenario, noise);
    alignment::Aligner aligner(given_alignment(source, start_ns), noise, source.mounting());
    navigation::NavigationRun run(
        std::make_unique<EkfNavigator>(noise, state::Layout{}, EkfOptions{}), std::move(aligner),
        navigation::NavigationRunOptions{}, both.forward);
    feed(run, source, start_ns);
  }
  both.smoothed = run_smoother(scenario, noise);
  return both;
}

Eigen::Vector3d position_error(const simulation::SimulatedSource& source,
                               const state::Epoch& epoch) {
  const Geodetic truth = source.truth(epoch.t_ns).position;
  return geodesy::displacement_n(truth, epoch.position, geodesy::Place(truth));
}

TEST(RtsSmoother, IsNeverWorseThanTheForwardRun) {
  const imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  double forward_worst = 0;
  double smoothed_worst = 0;
  double nees = 0;
  int epochs = 0;
  for (const int64_t seed : {1, 2, 3}) {
    const simulation::ScenarioOptions scenario = trip_options(seed);
    const simulation::SimulatedSource truth(scenario, noise);
    const BothWays both = run_both_ways(scenario, noise);
    ASSERT_EQ(both.forward.epochs.size(), both.smoothed.epochs.size());
    ASSERT_EQ(both.forward.fixes.size(), both.smoothed.fixes.size());
    for (std::size_t k = 0; k < both.forward.epochs.size(); ++k) {
      const state::Epoch& forward = both.forward.epochs[k];
      const state::Epoch& smoothed = both.smoothed.epochs[k];
      ASSERT_EQ(forward.t_ns, smoothed.t_ns);
      const state::NodeVector gain = forward.covariance.diagonal() - smoothed.covariance.diagonal();
      EXPECT_GE(gain.cwiseQuotient(forward.covariance.diagonal()).minCoeff(), -1e-6);
      if (!in_outage(seconds_between(scenario.start_ns(), forward.t_ns))) continue;
      const Eigen::Vector3d error = position_error(truth, smoothed);
      forward_worst = std::max(forward_worst, position_error(truth, forward).norm());
      smoothed_worst = std::max(smoothed_worst, error.norm());
      nees += error.dot(smoothed.covariance.topLeftCorner<3, 3>().llt().solve(error));
      ++epochs;
    }
  }
  // Between fixes on both sides the error of 60 s falls to that of 2 x 30 s, and with the cubic
  // growth of drift to a tenth or less.
  EXPECT_GT(forward_worst, 1);
  EXPECT_LT(smoothed_worst, 0.3 * forward_worst);
  // Errors within an outage are one draw, so the mean is of few: a factor, not a band.
  EXPECT_LT(nees / epochs, 3 * 3);
}

TEST(RtsSmoother, PostfitsAreOfTheSmoothedSolution) {
  const BothWays both = run_both_ways(trip_options(4), imu::imu_preset("ADIS16465"));
  double innovation = 0;
  double postfit = 0;
  int count = 0;
  for (std::size_t k = 0; k < both.smoothed.fixes.size(); ++k) {
    const state::FixResult& fix = both.smoothed.fixes[k];
    EXPECT_EQ(fix.innovation_n, both.forward.fixes[k].innovation_n);
    if (fix.verdict != state::FixVerdict::used) continue;
    innovation += fix.innovation_n.squaredNorm();
    postfit += fix.postfit_n.squaredNorm();
    ++count;
  }
  EXPECT_LT(postfit, innovation);
  // The fixes' own noise: 1, 1, 2 cm.
  EXPECT_NEAR(std::sqrt(postfit / count), 0.0245, 0.003);
}

TEST(RtsSmoother, EpochsBetweenNodesAreInterpolated) {
  const imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  navigation::NavigationRunOptions every_increment;
  every_increment.rate = navigation::EpochRate::imu;
  const Collected interpolated = run_smoother(trip_options(6), noise, every_increment);
  navigation::NavigationRunOptions many_nodes;
  many_nodes.node_interval_s = 0.25;
  const Collected exact = run_smoother(trip_options(6), noise, many_nodes);

  std::map<int64_t, state::Epoch> by_stamp;
  for (const state::Epoch& epoch : interpolated.epochs) by_stamp[epoch.t_ns] = epoch;
  EXPECT_EQ(by_stamp.size(), interpolated.epochs.size());
  int compared = 0;
  for (const state::Epoch& epoch : exact.epochs) {
    const auto found = by_stamp.find(epoch.t_ns);
    ASSERT_NE(found, by_stamp.end());
    const state::Epoch& other = found->second;
    const geodesy::Place place(epoch.position);
    // Errors of some milliradians times a specific force that changes by m/s^2 within the second.
    EXPECT_LT(geodesy::displacement_n(epoch.position, other.position, place).norm(), 1e-3);
    EXPECT_LT((epoch.velocity_n - other.velocity_n).norm(), 5e-3);
    EXPECT_LT(epoch.q_n_b.angularDistance(other.q_n_b), 1e-4);
    const state::NodeVector ratio =
        other.covariance.diagonal().cwiseQuotient(epoch.covariance.diagonal());
    EXPECT_LT((ratio.array() - 1).abs().maxCoeff(), 0.2);
    ++compared;
  }
  EXPECT_GT(compared, 500);
}

}  // namespace
}  // namespace foucault::ekf
