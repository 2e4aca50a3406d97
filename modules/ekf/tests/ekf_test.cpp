#include "foucault/ekf/ekf.h"

#include <gtest/gtest.h>

#include <functional>

#include "foucault/core/constants.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/measurement/gnss_velocity.h"
#include "foucault/state/calibrate_options.h"
#include "trip.h"

namespace foucault::ekf {
namespace {

using Matrix = state::StateMatrix;
using Vector = state::StateVector;
using test::kLeverArm;
using test::Trip;

constexpr int kSize = state::kNodeSize;

using Matrix3x15 = Eigen::Matrix<double, 3, kSize>;

imu::ImuNoise adis16465() {
  imu::ImuNoise noise;
  noise.gyro_noise_density = 0.15 * kDegree / 60;
  noise.accel_noise_density = 0.012 / 60;
  noise.gyro_bias_sigma = 2 * kDegree / 3600;
  noise.accel_bias_sigma = 3.6e-5;
  noise.gyro_turn_on_sigma = 100 * kDegree / 3600;
  noise.accel_turn_on_sigma = 1.4e-2;
  return noise;
}

state::NodeVector initial_sigmas() {
  const imu::ImuNoise noise = adis16465();
  state::NodeVector sigmas;
  sigmas << Eigen::Vector3d(0.05, 0.05, 0.05), Eigen::Vector3d(0.05, 0.05, 0.05),
      Eigen::Vector3d(0.2, 0.2, 1) * kDegree,
      Eigen::Vector3d::Constant(std::hypot(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma)),
      Eigen::Vector3d::Constant(std::hypot(noise.accel_turn_on_sigma, noise.accel_bias_sigma));
  return sigmas;
}

/// A filter in the middle of a turn, with a covariance full of correlations.
struct Fixture {
  Trip trip{{"city", 100, 2, 100}};
  std::mt19937_64 rng{7};
  state::NodeMatrix prior = test::random_covariance(rng, initial_sigmas());
  state::NavState state;
  GnssFix fix = trip.exact_fix(trip.begin_ns(), {0.03, 0.02, 0.05});

  Fixture() {
    state = trip.truth(trip.begin_ns());
    state.bias = {{1e-3, 2e-3, -1e-3}, {0.01, 0.02, -0.01}};
  }

  EkfNavigator navigator(const state::Layout& layout = {}) const {
    EkfNavigator filter(adis16465(), layout, EkfOptions{});
    filter.start(test::to_epoch(state, prior));
    return filter;
  }

  /// H by central differences of the innovation, which is minus the measurement's prediction.
  /// Good to 2e-6: rounding of a position, 1 nm, over the step.
  Matrix3x15 numerical_H() const {
    Matrix3x15 H;
    for (int i = 0; i < kSize; ++i) {
      const Vector step = 1e-3 * Vector::Unit(kSize, i);
      H.col(i) = (innovation_from(state::boxplus(state, -step)) -
                  innovation_from(state::boxplus(state, step))) /
                 2e-3;
    }
    return H;
  }

  Eigen::Vector3d innovation_from(const state::NavState& from) const {
    EkfNavigator filter(adis16465(), state::Layout{}, EkfOptions{});
    filter.start(test::to_epoch(from, prior));
    return filter.innovation(measurement::GnssPosition(fix)).value;
  }
};

/// P+ = (P^-1 + H' R^-1 H)^-1.
template <int kRows>
state::NodeMatrix information_update(const state::NodeMatrix& prior,
                                     const Eigen::Matrix<double, kRows, kSize>& H,
                                     const Eigen::Matrix<double, kRows, kRows>& R) {
  const state::NodeMatrix information = prior.inverse() + H.transpose() * R.inverse() * H;
  return information.inverse();
}

/// Largest deviation of `value` from `expected`, each element in units of the sigmas of `expected`.
double relative_deviation(const state::NodeMatrix& value, const state::NodeMatrix& expected) {
  const state::NodeVector scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  const state::NodeMatrix deviation = scale.asDiagonal() * (value - expected) * scale.asDiagonal();
  return deviation.cwiseAbs().maxCoeff();
}

TEST(Ekf, InnovationCovarianceFollowsFromDifferences) {
  const Fixture f;
  const Matrix3x15 H = f.numerical_H();
  const Eigen::Matrix3d expected =
      H * f.prior * H.transpose() + Eigen::Matrix3d(f.fix.position_covariance);
  const Eigen::Matrix3d found =
      f.navigator().innovation(measurement::GnssPosition(f.fix)).covariance;
  EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm());
  EXPECT_GT(state::columns_of(H, state::block::attitude).norm(), 0.5) << "no lever arm seen";
}

TEST(Ekf, ExactFixOnLeverArmHasNoInnovation) {
  const Fixture f;
  // The radii at the IMU and at the antenna differ by 1e-7.
  EXPECT_LT(f.navigator().innovation(measurement::GnssPosition(f.fix)).value.norm(), 1e-6);
}

TEST(Ekf, LeverArmTurnedTheWrongWayIsSeen) {
  Fixture f;
  f.fix.p_b_a = -f.fix.p_b_a;
  EXPECT_GT(f.navigator().innovation(measurement::GnssPosition(f.fix)).value.norm(),
            kLeverArm.norm());
}

TEST(Ekf, JosephFormEqualsInformationForm) {
  const Fixture f;
  EkfNavigator filter = f.navigator();
  filter.update(measurement::gnss_position(f.fix));  // no innovation, hence no reset
  const state::NodeMatrix expected =
      information_update<3>(f.prior, f.numerical_H(), Eigen::Matrix3d(f.fix.position_covariance));
  EXPECT_LT(relative_deviation(filter.epoch().covariance, expected), 1e-5);
}

TEST(Ekf, UpdateIsTheTextbookGain) {
  Fixture f;
  f.fix.antenna =
      geodesy::displaced(f.fix.antenna, {0.05, -0.03, 0.04}, geodesy::Place(f.fix.antenna));
  const Matrix3x15 H = f.numerical_H();
  const Eigen::Vector3d z = f.navigator().innovation(measurement::GnssPosition(f.fix)).value;
  const Eigen::Matrix3d S = H * f.prior * H.transpose() + f.fix.position_covariance;
  const state::NodeVector expected = f.prior * H.transpose() * S.inverse() * z;
  EkfNavigator filter = f.navigator();
  filter.update(measurement::gnss_position(f.fix));
  const state::NodeVector found = state::boxminus(filter.state(), f.state);
  const state::NodeVector sigmas = f.prior.diagonal().cwiseSqrt();
  EXPECT_LT((found - expected).cwiseQuotient(sigmas).norm(), 1e-5);
}

TEST(Ekf, AttitudeResetTurnsTheCovariance) {
  Fixture f;
  f.prior *= 400;  // 20 deg of heading: a correction that is not small
  f.fix.antenna = geodesy::displaced(f.fix.antenna, {0.5, -0.5, 0}, geodesy::Place(f.fix.antenna));
  EkfNavigator filter = f.navigator();
  filter.update(measurement::gnss_position(f.fix));
  const state::NodeVector d = state::boxminus(filter.state(), f.state);
  state::NodeMatrix reset = state::NodeMatrix::Identity();
  state::part(reset, state::block::attitude, state::block::attitude) =
      so3::right_jacobian(state::part(d, state::block::attitude));
  const state::NodeMatrix before_reset =
      information_update<3>(f.prior, f.numerical_H(), Eigen::Matrix3d(f.fix.position_covariance));
  const state::NodeMatrix expected = reset * before_reset * reset.transpose();
  EXPECT_GT(state::part(d, state::block::attitude).norm(), 2 * kDegree);
  EXPECT_LT(relative_deviation(filter.epoch().covariance, expected), 1e-5);
  EXPECT_GT(relative_deviation(filter.epoch().covariance, before_reset), 1e-3);
}

/// Antenna velocity, written out from its definition.
Eigen::Vector3d antenna_velocity(const state::NavState& state, const Eigen::Vector3d& gyro_b) {
  const Eigen::Vector3d omega_b = gyro_b - state.bias.gyro;
  return state.velocity_n + state.q_n_b * omega_b.cross(kLeverArm);
}

TEST(Ekf, VelocityOfAFixActsThroughTheLeverArm) {
  Fixture f;
  EkfNavigator filter = f.navigator();
  ImuIncrement turning = f.trip.increments().front();
  turning.dtheta_b = Eigen::Vector3d(0.1, -0.2, 0.5) * turning.dt();
  filter.propagate(turning);
  const state::NavState now = filter.state();
  const state::NodeMatrix prior = filter.epoch().covariance;
  const Eigen::Vector3d gyro_b = turning.dtheta_b / turning.dt();

  Eigen::Matrix<double, 6, kSize> H = Eigen::Matrix<double, 6, kSize>::Zero();
  for (int i = 0; i < kSize; ++i) {
    const Vector step = 1e-4 * Vector::Unit(kSize, i);
    const state::NavState plus = state::boxplus(now, step);
    const state::NavState minus = state::boxplus(now, -step);
    const geodesy::Place place(now.position);
    H.col(i).head<3>() = (geodesy::displacement_n(minus.position, plus.position, place) +
                          plus.q_n_b * kLeverArm - minus.q_n_b * kLeverArm) /
                         2e-4;
    H.col(i).tail<3>() = (antenna_velocity(plus, gyro_b) - antenna_velocity(minus, gyro_b)) / 2e-4;
  }
  f.fix.antenna =
      geodesy::displaced(now.position, now.q_n_b * kLeverArm, geodesy::Place(now.position));
  f.fix.velocity_n = antenna_velocity(now, gyro_b);
  f.fix.velocity_covariance = Eigen::Vector3d(1e-4, 4e-4, 9e-4).asDiagonal();
  filter.update(measurement::gnss_position(f.fix));
  filter.update(measurement::gnss_velocity(f.fix));

  Eigen::Matrix<double, 6, 6> R = Eigen::Matrix<double, 6, 6>::Zero();
  R.topLeftCorner<3, 3>() = f.fix.position_covariance;
  R.bottomRightCorner<3, 3>() = f.fix.velocity_covariance;
  EXPECT_LT(relative_deviation(filter.epoch().covariance, information_update<6>(prior, H, R)),
            1e-5);
}

TEST(Ekf, AskingDoesNotChangeTheResult) {
  const Fixture f;
  EkfNavigator quiet = f.navigator();
  EkfNavigator asked = f.navigator();
  for (const ImuIncrement& increment : f.trip.increments()) {
    quiet.propagate(increment);
    asked.propagate(increment);
    asked.epoch();
    asked.innovation(measurement::GnssPosition(f.fix));
  }
  EXPECT_EQ(quiet.epoch().covariance, asked.epoch().covariance);
}

TEST(Ekf, CovarianceStepHardlyMatters) {
  Trip trip({"city", 80, 60, 100});
  const auto run = [&](double cov_interval_s) {
    EkfOptions options;
    options.cov_interval_s = cov_interval_s;
    EkfNavigator filter(adis16465(), state::Layout{}, options);
    const state::NodeMatrix prior = initial_sigmas().cwiseAbs2().asDiagonal();
    state::NavState state;
    state = trip.truth(trip.begin_ns());
    filter.start(test::to_epoch(state, prior));
    for (const ImuIncrement& increment : trip.increments()) filter.propagate(increment);
    return filter.epoch().covariance;
  };
  const state::NodeMatrix every_increment = run(0);
  EXPECT_LT(relative_deviation(run(EkfOptions{}.cov_interval_s), every_increment), 1e-3);
}

/// One seeded run: begin drawn from its covariance, IMU errors and GNSS noise drawn.
struct Consistency {
  double nis = 0;  ///< mean over fixes
  int fixes = 0;
  double nees = 0;  ///< position, velocity, attitude at the end of the GNSS part
  double nees_bias = 0;
  double nees_outage = 0;       ///< horizontal position at the end of the outage
  double horizontal_drift = 0;  ///< [m]
};

Consistency consistency_run(const Trip& trip, uint64_t seed, const imu::ImuNoise& believed,
                            double gnss_end_s) {
  std::mt19937_64 rng{seed};
  const Eigen::Vector3d gnss_sigma(0.01, 0.01, 0.02);
  simulation::ImuErrors errors(adis16465(), {}, static_cast<int64_t>(seed));
  const state::NodeVector sigmas = initial_sigmas();
  state::NavState truth;
  truth = trip.truth(trip.begin_ns());
  state::NodeVector deviation = sigmas.cwiseProduct(test::draw15(rng));
  deviation.tail<6>().setZero();  // the true biases are drawn, the first estimate is zero
  EkfNavigator filter(believed, state::Layout{}, EkfOptions{});
  filter.start(test::to_epoch(state::boxplus(truth, deviation), sigmas.cwiseAbs2().asDiagonal()));

  Consistency result;
  const int64_t gnss_end_ns = trip.begin_ns() + nanoseconds(gnss_end_s);
  for (const ImuIncrement& exact : trip.increments()) {
    filter.propagate(errors.apply(exact));
    const int64_t now_ns = exact.t_end_ns;
    if (now_ns > gnss_end_ns || now_ns % kNanosecondsPerSecond != 0) continue;
    GnssFix fix = trip.exact_fix(now_ns, gnss_sigma);
    const Eigen::Vector3d noise_n = gnss_sigma.cwiseProduct(test::draw3(rng));
    fix.antenna = geodesy::displaced(fix.antenna, noise_n, geodesy::Place(fix.antenna));
    const state::Innovation innovation = filter.innovation(measurement::GnssPosition(fix));
    result.nis += innovation.value.dot(innovation.covariance.llt().solve(innovation.value));
    ++result.fixes;
    filter.update(measurement::gnss_position(fix));
    if (now_ns == gnss_end_ns) {
      truth = trip.truth(now_ns);
      truth.bias = errors.bias();
      const state::NodeVector error = state::boxminus(truth, filter.state());
      const state::NodeMatrix P = filter.epoch().covariance;
      result.nees = error.head<9>().dot(P.topLeftCorner<9, 9>().llt().solve(error.head<9>()));
      result.nees_bias =
          error.tail<6>().dot(P.bottomRightCorner<6, 6>().llt().solve(error.tail<6>()));
    }
  }
  truth = trip.truth(filter.state().t_ns);
  const Eigen::Vector2d drift = state::boxminus(truth, filter.state()).head<2>();
  const Eigen::Matrix2d P = filter.epoch().covariance.topLeftCorner<2, 2>();
  result.nees_outage = drift.dot(P.llt().solve(drift));
  result.horizontal_drift = drift.norm();
  result.nis /= result.fixes;
  return result;
}

Consistency mean_of_runs(const Trip& trip, int runs, const imu::ImuNoise& believed) {
  Consistency mean;
  for (int run = 0; run < runs; ++run) {
    const Consistency one = consistency_run(trip, 100 + run, believed, 120);
    mean.fixes += one.fixes;
    mean.nis += one.nis / runs;
    mean.nees += one.nees / runs;
    mean.nees_bias += one.nees_bias / runs;
    mean.nees_outage += one.nees_outage / runs;
    mean.horizontal_drift += one.horizontal_drift * one.horizontal_drift / runs;
  }
  mean.horizontal_drift = std::sqrt(mean.horizontal_drift);
  return mean;
}

/// Half width of the 99.9 % band of the mean of `count` chi-squares (normal approximation).
double band(double degrees, double count) { return 3.29 * std::sqrt(2 * degrees / count); }

class EkfConsistency : public ::testing::Test {
 protected:
  static constexpr int kRuns = 60;
  /// 120 s with GNSS, then 60 s without.
  Trip trip_{{"city", 60, 180, 50}};
};

TEST_F(EkfConsistency, ErrorsAreAsLargeAsTheCovarianceSays) {
  const Consistency mean = mean_of_runs(trip_, kRuns, adis16465());
  EXPECT_NEAR(mean.nis, 3, band(3, mean.fixes));
  EXPECT_NEAR(mean.nees, 9, band(9, kRuns));
  EXPECT_NEAR(mean.nees_bias, 6, band(6, kRuns));
  EXPECT_NEAR(mean.nees_outage, 2, band(2, kRuns));
  // 0.15 deg/sqrt(h) alone over 60 s: 9.8 * 4.4e-5 * sqrt(60^5 / 20) = 2.7 m an axis.
  EXPECT_GT(mean.horizontal_drift, 2);
  EXPECT_LT(mean.horizontal_drift, 10);
}

TEST_F(EkfConsistency, TooLittleNoiseIsSeen) {
  imu::ImuNoise believed = adis16465();
  believed.gyro_noise_density /= 2;
  const Consistency mean = mean_of_runs(trip_, kRuns, believed);
  EXPECT_GT(mean.nees, 9 + 2 * band(9, kRuns));
}

state::Layout with_scale_factors() {
  state::CalibrateOptions options;
  options.gyro_scale = options.accel_scale = "on";
  return options.layout();
}

/// A drive of 400 s with fixes, by gyroscopes whose vertical scale is off by -2000 ppm. Only that
/// axis turns enough in a car to be seen.
EkfNavigator filter_that_found_scale_factors(const Trip& trip, const Eigen::Vector3d& gyro_scale) {
  std::mt19937_64 rng{3};
  simulation::ImuErrors errors(adis16465(), {}, 3);
  EkfNavigator filter(adis16465(), with_scale_factors(), EkfOptions{});
  state::NavState begin;
  begin = trip.truth(trip.begin_ns());
  filter.start(test::to_epoch(begin, initial_sigmas().cwiseAbs2().asDiagonal()));
  const Eigen::Vector3d gnss_sigma(0.01, 0.01, 0.02);
  for (const ImuIncrement& exact : trip.increments()) {
    ImuIncrement m = exact;
    m.dtheta_b.array() *= 1 + gyro_scale.array();
    filter.propagate(errors.apply(m));
    if (exact.t_end_ns % kNanosecondsPerSecond != 0) continue;
    GnssFix fix = trip.exact_fix(exact.t_end_ns, gnss_sigma);
    fix.antenna = geodesy::displaced(fix.antenna, gnss_sigma.cwiseProduct(test::draw3(rng)),
                                     geodesy::Place(fix.antenna));
    filter.update(measurement::gnss_position(fix));
  }
  return filter;
}

double vertical_gyro_scale_sigma(const EkfNavigator& filter) {
  const int row = kSize + *with_scale_factors().slow_index(state::block::gyro_scale) + 2;
  return std::sqrt(filter.covariance()(row, row));
}

TEST(Ekf, FindsScaleFactors) {
  const Trip trip({"city", 60, 400, 50});
  const Eigen::Vector3d gyro_scale(1500e-6, -1000e-6, -2000e-6);
  const EkfNavigator filter = filter_that_found_scale_factors(trip, gyro_scale);
  const double sigma = vertical_gyro_scale_sigma(filter);
  EXPECT_LT(sigma, 500e-6);
  const state::ImuScale found = with_scale_factors().imu_scale(filter.state().slow);
  EXPECT_NEAR(found.gyro.z(), gyro_scale.z(), 3.3 * sigma);
}

TEST(Ekf, AStartKeepsSlowBlocksAndTheirCorrelations) {
  const Trip trip({"city", 60, 100, 50});
  EkfNavigator filter = filter_that_found_scale_factors(trip, {1500e-6, -1000e-6, -2000e-6});
  const state::Epoch learned = filter.epoch();
  EkfNavigator other(adis16465(), with_scale_factors(), EkfOptions{});
  other.start(learned);
  EXPECT_EQ(other.epoch().slow, learned.slow);
  EXPECT_EQ(other.epoch().covariance, learned.covariance);
}

TEST(Ekf, OneAheadIsTheFilterWithOtherSigmas) {
  Fixture fixture;
  EkfNavigator filter = fixture.navigator();
  const std::unique_ptr<measurement::Navigator> doubtful = filter.ahead(2);
  EXPECT_LT((doubtful->epoch().covariance - 4 * fixture.prior).norm(), 1e-12);
  for (const ImuIncrement& increment : fixture.trip.increments()) {
    filter.propagate(increment);
    doubtful->propagate(increment);
  }
  const std::unique_ptr<measurement::Navigator> ahead = filter.ahead(1);
  const GnssFix fix = fixture.trip.exact_fix(filter.epoch().t_ns, {0.03, 0.02, 0.05});
  EXPECT_EQ(ahead->innovation(measurement::GnssPosition(fix)).value,
            filter.innovation(measurement::GnssPosition(fix)).value);
  EXPECT_LT((doubtful->innovation(measurement::GnssPosition(fix)).value -
             filter.innovation(measurement::GnssPosition(fix)).value)
                .norm(),
            1e-9);
  const state::Epoch before = filter.epoch();
  ahead->update(measurement::gnss_position(fix));
  EXPECT_EQ(filter.epoch().covariance, before.covariance);
}

/// What is learned beside a node's blocks stays, and so do correlations.
TEST(Ekf, LooseningAddsAndForgetsNothing) {
  Fixture fixture;
  EkfNavigator filter = fixture.navigator(with_scale_factors());
  for (const ImuIncrement& increment : fixture.trip.increments()) filter.propagate(increment);
  filter.update(
      measurement::gnss_position(fixture.trip.exact_fix(filter.epoch().t_ns, {0.03, 0.02, 0.05})));
  const Matrix before = filter.covariance();
  const state::NavState state = filter.state();
  state::NodeMatrix added = state::NodeMatrix::Zero();
  added.diagonal().head<3>() = Eigen::Vector3d(1, 4, 9);
  filter.loosen(added);
  Matrix expected = before;
  state::node_part(expected) += added;
  EXPECT_EQ(filter.covariance(), expected);
  EXPECT_GT((before.topRightCorner<kSize, 6>().cwiseAbs().maxCoeff()), 0);
  EXPECT_EQ(filter.state().slow, state.slow);
}

}  // namespace
}  // namespace foucault::ekf
