#include "foucault/ekf/error_model.h"

#include <gtest/gtest.h>

#include "trip.h"

namespace foucault::ekf {
namespace {

using Matrix = state::StateMatrix;
using Vector = state::StateVector;
using test::Trip;
using test::TripWindow;

constexpr int kSlow = 15;  // scale factors and cross-axis terms
constexpr int kSize = state::kNodeSize + kSlow;

/// Units in which errors of a car's MEMS navigation are of order one.
Vector natural_units() {
  Vector units(kSize);
  state::part(units, state::block::position).setConstant(1);       // m
  state::part(units, state::block::velocity).setConstant(0.1);     // m/s
  state::part(units, state::block::attitude).setConstant(1e-2);    // rad
  state::part(units, state::block::gyro_bias).setConstant(1e-3);   // rad/s
  state::part(units, state::block::accel_bias).setConstant(1e-2);  // m/s^2
  units.tail<kSlow>().setConstant(1e-2);
  return units;
}

Matrix in_natural_units(const Matrix& phi) {
  const Vector units = natural_units();
  return units.cwiseInverse().asDiagonal() * phi * units.asDiagonal();
}

state::Layout with_scale_factors() {
  constexpr double kForever = 1e12;
  return state::Layout()
      .add(state::block::gyro_scale, 0, kForever)
      .add(state::block::accel_scale, 0, kForever)
      .add(state::block::gyro_cross_axis, 0, kForever)
      .add(state::block::accel_cross_axis, 0, kForever);
}

ImuIncrement compensated(const ImuIncrement& increment, const state::NavState& state) {
  return imu::without_scale(imu::without_bias(increment, state.bias),
                            with_scale_factors().imu_scale(state.slow));
}

/// The mechanization alone, over all increments.
state::NavState integrated(state::NavState state, const std::vector<ImuIncrement>& increments) {
  ImuIncrement previous;
  for (const ImuIncrement& increment : increments) {
    const ImuIncrement clean = compensated(increment, state);
    state = imu::advance(state, previous, clean);
    previous = clean;
  }
  return state;
}

/// Central differences of the mechanization by every error of the begin.
Matrix numerical_transition(const state::NavState& begin,
                            const std::vector<ImuIncrement>& increments) {
  const Vector units = natural_units();
  const state::NavState end = integrated(begin, increments);
  Matrix phi(kSize, kSize);
  for (int i = 0; i < kSize; ++i) {
    const Vector step = 1e-2 * units[i] * Vector::Unit(kSize, i);
    const state::NavState plus = integrated(state::boxplus(begin, step), increments);
    const state::NavState minus = integrated(state::boxplus(begin, -step), increments);
    phi.col(i) = (state::boxminus(plus, end) - state::boxminus(minus, end)) / (2e-2 * units[i]);
  }
  return phi;
}

/// Product of the filter's transitions, a step for so many increments.
Matrix analytic_transition(state::NavState state, const std::vector<ImuIncrement>& increments,
                           const ekf::ProcessNoise& noise, std::size_t increments_per_step) {
  Matrix phi = Matrix::Identity(kSize, kSize);
  ImuIncrement previous;
  state::NavState begin = state;
  ekf::MotionIntegrals integrals;
  std::size_t count = 0;
  for (const ImuIncrement& increment : increments) {
    const ImuIncrement clean = compensated(increment, state);
    const Eigen::Matrix3d R_begin = state.q_n_b.toRotationMatrix();
    state = imu::advance(state, previous, clean);
    integrals.add(clean, R_begin, state.q_n_b.toRotationMatrix(), noise.imu);
    previous = clean;
    if (++count % increments_per_step == 0) {
      phi = (transition(integrals, begin, state, noise).phi.full() * phi).eval();
      begin = state;
      integrals = {};
    }
  }
  return phi;
}

ekf::ProcessNoise with_scale_and_constant_biases() {
  ekf::ProcessNoise noise;
  noise.layout = with_scale_factors();
  noise.imu.bias_tau = 1e12;
  return noise;
}

/// The dynamics compared with differences of the mechanization that they linearize.
void expect_transition_matches(const Trip& trip, double tolerance) {
  state::NavState begin = trip.truth(trip.begin_ns());
  begin.slow = Eigen::VectorXd::Zero(kSlow);
  begin.bias = {{1e-3, -2e-3, 3e-3}, {0.02, -0.01, 0.03}};
  std::vector<ImuIncrement> measured = trip.increments();
  for (ImuIncrement& m : measured) {
    m.dtheta_b += begin.bias.gyro * m.dt();
    m.dvel_b += begin.bias.accel * m.dt();
  }
  const Matrix expected = in_natural_units(numerical_transition(begin, measured));
  const Matrix phi =
      in_natural_units(analytic_transition(begin, measured, with_scale_and_constant_biases(), 10));
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) {
      EXPECT_NEAR(phi(i, j), expected(i, j), tolerance * (1 + std::abs(expected(i, j))))
          << "row " << i << " column " << j;
    }
  }
}

// Ten seconds with steps of 0.1 s. In natural units the Coriolis terms are 1.5e-3, the gravity
// gradient 3e-4; what the dynamics leave out (radii changing with latitude, commutators of the
// motion within a step) lies below the tolerance.
constexpr double kTolerance = 5e-5;

TEST(ErrorModel, TransitionMatchesDifferencesInCityTurns) {
  expect_transition_matches(Trip({"city", 100, 10, 100}), kTolerance);
}

TEST(ErrorModel, TransitionMatchesDifferencesInAnAirliner) {
  expect_transition_matches(Trip({"airliner", 700, 10, 100}), kTolerance);
}

TEST(ErrorModel, ToleranceSeesCoriolisAndGravityGradient) {
  const Trip trip({"airliner", 700, 10, 100});
  state::NavState begin = trip.truth(trip.begin_ns());
  begin.slow = Eigen::VectorXd::Zero(kSlow);
  const Matrix phi = in_natural_units(numerical_transition(begin, trip.increments()));
  EXPECT_GT(std::abs(phi(3, 4)), 10 * kTolerance) << "Coriolis";
  EXPECT_GT(std::abs(phi(5, 2)), 4 * kTolerance) << "gravity gradient";
}

TEST(ErrorModel, BoxminusInvertsBoxplus) {
  std::mt19937_64 rng{42};
  state::NavState state;
  state.position = {0.5, 3.14159265, 100};
  state.q_n_b = so3::exp({0.3, -1.2, 2.0});
  state.slow = Eigen::VectorXd::Zero(kSlow);
  Vector error(kSize);
  for (int i = 0; i < kSize / 3; ++i) error.segment<3>(3 * i) = test::draw3(rng);
  const Vector back = state::boxminus(state::boxplus(state, error), state);
  EXPECT_LT((back - error).norm(), 1e-8);  // rounding of radians: 1 nm
}

TEST(ErrorModel, MarkovProcessesAreInClosedForm) {
  ekf::ProcessNoise noise;
  noise.imu.bias_tau = 5;
  noise.imu.gyro_bias_sigma = 2e-3;
  noise.imu.accel_bias_sigma = 3e-2;
  const Trip trip({"static", 10, 0.5, 100});
  ekf::MotionIntegrals integrals;
  const state::NavState begin = trip.truth(trip.begin_ns());
  const Eigen::Matrix3d R = begin.q_n_b.toRotationMatrix();
  for (const ImuIncrement& increment : trip.increments()) integrals.add(increment, R, R, noise.imu);
  const ekf::Transition t = transition(integrals, begin, begin, noise);
  const state::StateMatrix phi = t.phi.full();
  EXPECT_NEAR(phi(9, 9), std::exp(-0.1), 1e-15);
  EXPECT_NEAR(t.q(9, 9) / 4e-6, 1 - std::exp(-0.2), 1e-12);
  EXPECT_NEAR(t.q(14, 14) / 9e-4, 1 - std::exp(-0.2), 1e-12);
}

/// After hours the constant part of a bias is as unknown as before: a filter that let it decay with
/// the variation would be sure of a wrong bias.
TEST(ErrorModel, TurnOnValuesDoNotDecay) {
  ekf::ProcessNoise noise;
  noise.imu.bias_tau = 5;
  noise.imu.gyro_bias_sigma = 1e-3;
  noise.imu.gyro_turn_on_sigma = 1e-2;
  noise.imu.accel_turn_on_sigma = 3e-2;  // and no variation
  const Trip trip({"static", 10, 0.5, 100});
  ekf::MotionIntegrals integrals;
  const state::NavState begin = trip.truth(trip.begin_ns());
  const Eigen::Matrix3d R = begin.q_n_b.toRotationMatrix();
  for (const ImuIncrement& increment : trip.increments()) integrals.add(increment, R, R, noise.imu);
  const ekf::Transition t = transition(integrals, begin, begin, noise);
  const state::StateMatrix phi = t.phi.full();
  EXPECT_NEAR(phi(9, 9), std::exp(-0.1 / 101), 1e-15);
  // The driving noise is that of the variation, but for the decay over half a second.
  EXPECT_NEAR(t.q(9, 9), 2 * 1e-6 / 5 * 0.5, 2e-10);
  EXPECT_EQ(phi(12, 12), 1);
  EXPECT_EQ(t.q(12, 12), 0);
}

/// Errors of a filter that starts exact and gets noisy increments, against its covariance.
struct MonteCarlo {
  int runs = 0;
  state::NodeMatrix covariance = state::NodeMatrix::Zero();  ///< of the filter
  state::NodeMatrix sampled = state::NodeMatrix::Zero();     ///< of the runs
};

MonteCarlo monte_carlo(const Trip& trip, const imu::ImuNoise& noise, double extra_density,
                       int runs = 1000) {
  std::mt19937_64 rng{42};
  EkfOptions options;
  MonteCarlo result;
  result.runs = runs;
  for (int run = 0; run < result.runs; ++run) {
    EkfNavigator navigator(noise, state::Layout{}, options);
    const state::NavState begin = trip.truth(trip.begin_ns());
    navigator.start(test::to_epoch(begin, state::NodeMatrix::Zero()));
    state::NavState truth = begin;
    for (const ImuIncrement& exact : trip.increments()) {
      const double dt = exact.dt();
      const double decay = std::exp(-dt / noise.bias_tau);
      const double drive = std::sqrt(-std::expm1(-2 * dt / noise.bias_tau));
      const double gyro_density = std::hypot(noise.gyro_noise_density, extra_density);
      ImuIncrement m = exact;
      m.extra_gyro_noise_density = extra_density;
      m.dtheta_b += truth.bias.gyro * dt + gyro_density * std::sqrt(dt) * test::draw3(rng);
      m.dvel_b +=
          truth.bias.accel * dt + noise.accel_noise_density * std::sqrt(dt) * test::draw3(rng);
      truth.bias.gyro = decay * truth.bias.gyro + drive * noise.gyro_bias_sigma * test::draw3(rng);
      truth.bias.accel =
          decay * truth.bias.accel + drive * noise.accel_bias_sigma * test::draw3(rng);
      navigator.propagate(m);
    }
    state::NavState end = trip.truth(navigator.state().t_ns);
    end.bias = truth.bias;
    const state::NodeVector error = state::boxminus(end, navigator.state());
    result.sampled += error * error.transpose() / result.runs;
    if (run == 0) result.covariance = navigator.epoch().covariance;
  }
  return result;
}

/// L^-1 sampled L^-T with L L' = covariance: the unit matrix if the filter is right.
state::NodeMatrix whitened(const MonteCarlo& mc) {
  const Eigen::LLT<state::NodeMatrix> llt(mc.covariance);
  const state::NodeMatrix half = llt.matrixL().solve(mc.sampled);
  return llt.matrixL().solve(half.transpose());
}

imu::ImuNoise strong_noise() {
  imu::ImuNoise noise;
  noise.gyro_noise_density = 2e-4;
  noise.accel_noise_density = 2e-3;
  noise.gyro_bias_sigma = 1e-3;
  noise.accel_bias_sigma = 1e-2;
  noise.bias_tau = 20;
  return noise;
}

TEST(ErrorModel, CovarianceMatchesMonteCarlo) {
  const MonteCarlo mc = monte_carlo(Trip({"city", 100, 4, 50}), strong_noise(), 0);
  const state::NodeMatrix deviation = whitened(mc) - state::NodeMatrix::Identity();
  // Sampling error of a variance: sqrt(2 / runs) = 4.5 %; 120 elements, 4.5 sigma.
  EXPECT_LT(deviation.cwiseAbs().maxCoeff(), 4.5 * std::sqrt(2.0 / mc.runs));
}

TEST(ErrorModel, ExtraNoiseOfAnIncrementIsCounted) {
  const Trip trip({"city", 100, 4, 50});
  const MonteCarlo mc = monte_carlo(trip, strong_noise(), 4e-4);
  const state::NodeMatrix deviation = whitened(mc) - state::NodeMatrix::Identity();
  EXPECT_LT(deviation.cwiseAbs().maxCoeff(), 4.5 * std::sqrt(2.0 / mc.runs));
}

TEST(ErrorModel, MonteCarloSeesMissingNoise) {
  const Trip trip({"city", 100, 4, 50});
  MonteCarlo mc = monte_carlo(trip, strong_noise(), 4e-4);
  mc.covariance = monte_carlo(trip, strong_noise(), 0, 1).covariance;
  EXPECT_GT((whitened(mc) - state::NodeMatrix::Identity()).cwiseAbs().maxCoeff(),
            10 * std::sqrt(2.0 / mc.runs));
}

}  // namespace
}  // namespace foucault::ekf
