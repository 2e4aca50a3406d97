#include "foucault/ekf/ekf.h"

#include <gtest/gtest.h>

#include <functional>

#include "trip.h"

namespace foucault {
namespace {

using ekf::FullState;
using ekf::Matrix;
using ekf::Vector;
using test::kDeg;
using test::kLeverArm;
using test::Trip;

constexpr int kSize = error_state::kSize;

using Matrix3x15 = Eigen::Matrix<double, 3, kSize>;

ImuNoise adis16465() {
  ImuNoise noise;
  noise.gyro_noise_density = 0.15 * kDeg / 60;
  noise.accel_noise_density = 0.012 / 60;
  noise.gyro_bias_sigma = 2 * kDeg / 3600;
  noise.accel_bias_sigma = 3.6e-5;
  noise.gyro_turn_on_sigma = 100 * kDeg / 3600;
  noise.accel_turn_on_sigma = 1.4e-2;
  return noise;
}

Vector15d initial_sigmas() {
  const ImuNoise noise = adis16465();
  Vector15d sigmas;
  sigmas << Eigen::Vector3d(0.05, 0.05, 0.05), Eigen::Vector3d(0.05, 0.05, 0.05),
      Eigen::Vector3d(0.2, 0.2, 1) * kDeg,
      Eigen::Vector3d::Constant(std::hypot(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma)),
      Eigen::Vector3d::Constant(std::hypot(noise.accel_turn_on_sigma, noise.accel_bias_sigma));
  return sigmas;
}

/// A filter in the middle of a turn, with a covariance full of correlations.
struct Fixture {
  Trip trip{{"city", 100, 2, 100}};
  std::mt19937_64 rng{7};
  Matrix15d prior = test::random_covariance(rng, initial_sigmas());
  FullState state;
  GnssFix fix = trip.exact_fix(trip.begin_ns(), {0.03, 0.02, 0.05});

  Fixture() {
    state.motion = trip.truth(trip.begin_ns());
    state.bias = {{1e-3, 2e-3, -1e-3}, {0.01, 0.02, -0.01}};
  }

  EkfNavigator navigator(const EkfOptions& options = {}) const {
    EkfNavigator filter(adis16465(), options);
    filter.start(test::to_epoch(state, prior));
    return filter;
  }

  /// H by central differences of the innovation, which is minus the measurement's prediction.
  /// Good to 2e-6: rounding of a position, 1 nm, over the step.
  Matrix3x15 numerical_H() const {
    Matrix3x15 H;
    for (int i = 0; i < kSize; ++i) {
      const Vector step = 1e-3 * Vector::Unit(kSize, i);
      H.col(i) =
          (innovation_from(corrected(state, -step)) - innovation_from(corrected(state, step))) /
          2e-3;
    }
    return H;
  }

  Eigen::Vector3d innovation_from(const FullState& from) const {
    EkfNavigator filter(adis16465(), EkfOptions{});
    filter.start(test::to_epoch(from, prior));
    return filter.innovation(fix).value_n;
  }
};

/// P+ = (P^-1 + H' R^-1 H)^-1.
template <int kRows>
Matrix15d information_update(const Matrix15d& prior, const Eigen::Matrix<double, kRows, kSize>& H,
                             const Eigen::Matrix<double, kRows, kRows>& R) {
  const Matrix15d information = prior.inverse() + H.transpose() * R.inverse() * H;
  return information.inverse();
}

/// Largest deviation of `value` from `expected`, each element in units of the sigmas of `expected`.
double relative_deviation(const Matrix15d& value, const Matrix15d& expected) {
  const Vector15d scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix15d deviation = scale.asDiagonal() * (value - expected) * scale.asDiagonal();
  return deviation.cwiseAbs().maxCoeff();
}

TEST(Ekf, InnovationCovarianceFollowsFromDifferences) {
  const Fixture f;
  const Matrix3x15 H = f.numerical_H();
  const Eigen::Matrix3d expected =
      H * f.prior * H.transpose() + Eigen::Matrix3d(f.fix.position_covariance);
  const Eigen::Matrix3d found = f.navigator().innovation(f.fix).covariance;
  EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm());
  EXPECT_GT(H.middleCols<3>(error_state::kAttitude).norm(), 0.5) << "no lever arm seen";
}

TEST(Ekf, ExactFixOnLeverArmHasNoInnovation) {
  const Fixture f;
  // The radii at the IMU and at the antenna differ by 1e-7.
  EXPECT_LT(f.navigator().innovation(f.fix).value_n.norm(), 1e-6);
}

TEST(Ekf, LeverArmTurnedTheWrongWayIsSeen) {
  Fixture f;
  f.fix.p_b_a = -f.fix.p_b_a;
  EXPECT_GT(f.navigator().innovation(f.fix).value_n.norm(), kLeverArm.norm());
}

TEST(Ekf, JosephFormEqualsInformationForm) {
  const Fixture f;
  EkfNavigator filter = f.navigator();
  filter.update(f.fix);  // no innovation, hence no reset
  const Matrix15d expected =
      information_update<3>(f.prior, f.numerical_H(), Eigen::Matrix3d(f.fix.position_covariance));
  EXPECT_LT(relative_deviation(filter.epoch().covariance, expected), 1e-5);
}

TEST(Ekf, UpdateIsTheTextbookGain) {
  Fixture f;
  f.fix.antenna = displaced(f.fix.antenna, {0.05, -0.03, 0.04}, Place(f.fix.antenna));
  const Matrix3x15 H = f.numerical_H();
  const Eigen::Vector3d z = f.navigator().innovation(f.fix).value_n;
  const Eigen::Matrix3d S = H * f.prior * H.transpose() + f.fix.position_covariance;
  const Vector15d expected = f.prior * H.transpose() * S.inverse() * z;
  EkfNavigator filter = f.navigator();
  filter.update(f.fix);
  const Vector15d found = difference(f.state, filter.state(), kSize);
  const Vector15d sigmas = f.prior.diagonal().cwiseSqrt();
  EXPECT_LT((found - expected).cwiseQuotient(sigmas).norm(), 1e-5);
}

TEST(Ekf, AttitudeResetTurnsTheCovariance) {
  Fixture f;
  f.prior *= 400;  // 20 deg of heading: a correction that is not small
  f.fix.antenna = displaced(f.fix.antenna, {0.5, -0.5, 0}, Place(f.fix.antenna));
  EkfNavigator filter = f.navigator();
  filter.update(f.fix);
  const Vector15d d = difference(f.state, filter.state(), kSize);
  Matrix15d reset = Matrix15d::Identity();
  reset.block<3, 3>(6, 6) = so3::right_jacobian(d.segment<3>(6));
  const Matrix15d before_reset =
      information_update<3>(f.prior, f.numerical_H(), Eigen::Matrix3d(f.fix.position_covariance));
  const Matrix15d expected = reset * before_reset * reset.transpose();
  EXPECT_GT(d.segment<3>(6).norm(), 2 * kDeg);
  EXPECT_LT(relative_deviation(filter.epoch().covariance, expected), 1e-5);
  EXPECT_GT(relative_deviation(filter.epoch().covariance, before_reset), 1e-3);
}

/// Antenna velocity, written out from its definition.
Eigen::Vector3d antenna_velocity(const FullState& state, const Eigen::Vector3d& gyro_b) {
  const Eigen::Vector3d omega_b = gyro_b - state.bias.gyro;
  return state.motion.v_n + state.motion.q_n_b * omega_b.cross(kLeverArm);
}

TEST(Ekf, VelocityOfAFixActsThroughTheLeverArm) {
  Fixture f;
  EkfOptions options;
  options.use_velocity = true;
  EkfNavigator filter = f.navigator(options);
  ImuIncrement turning = f.trip.increments().front();
  turning.dtheta_b = Eigen::Vector3d(0.1, -0.2, 0.5) * turning.dt();
  filter.propagate(turning);
  const FullState now = filter.state();
  const Matrix15d prior = filter.epoch().covariance;
  const Eigen::Vector3d gyro_b = turning.dtheta_b / turning.dt();

  Eigen::Matrix<double, 6, kSize> H = Eigen::Matrix<double, 6, kSize>::Zero();
  for (int i = 0; i < kSize; ++i) {
    const Vector step = 1e-4 * Vector::Unit(kSize, i);
    const FullState plus = corrected(now, step);
    const FullState minus = corrected(now, -step);
    const Place place(now.motion.position);
    H.col(i).head<3>() = (displacement_n(minus.motion.position, plus.motion.position, place) +
                          plus.motion.q_n_b * kLeverArm - minus.motion.q_n_b * kLeverArm) /
                         2e-4;
    H.col(i).tail<3>() = (antenna_velocity(plus, gyro_b) - antenna_velocity(minus, gyro_b)) / 2e-4;
  }
  f.fix.antenna =
      displaced(now.motion.position, now.motion.q_n_b * kLeverArm, Place(now.motion.position));
  f.fix.velocity_n = antenna_velocity(now, gyro_b);
  f.fix.velocity_covariance = Eigen::Vector3d(1e-4, 4e-4, 9e-4).asDiagonal();
  filter.update(f.fix);

  Eigen::Matrix<double, 6, 6> R = Eigen::Matrix<double, 6, 6>::Zero();
  R.topLeftCorner<3, 3>() = f.fix.position_covariance;
  R.bottomRightCorner<3, 3>() = f.fix.velocity_covariance;
  EXPECT_LT(relative_deviation(filter.epoch().covariance, information_update<6>(prior, H, R)),
            1e-5);
}

TEST(Ekf, VelocityIsLeftAloneUnlessAskedFor) {
  Fixture f;
  f.fix.velocity_n = Eigen::Vector3d::Constant(std::nan(""));
  f.fix.velocity_covariance.setConstant(std::nan(""));
  EkfNavigator filter = f.navigator();
  filter.update(f.fix);
  EXPECT_TRUE(filter.epoch().covariance.allFinite());
  EXPECT_TRUE(filter.epoch().velocity_n.allFinite());
}

TEST(Ekf, AskingDoesNotChangeTheResult) {
  const Fixture f;
  EkfNavigator quiet = f.navigator();
  EkfNavigator asked = f.navigator();
  for (const ImuIncrement& increment : f.trip.increments()) {
    quiet.propagate(increment);
    asked.propagate(increment);
    asked.epoch();
    asked.innovation(f.fix);
  }
  EXPECT_EQ(quiet.epoch().covariance, asked.epoch().covariance);
}

TEST(Ekf, CovarianceStepHardlyMatters) {
  Trip trip({"city", 80, 60, 100});
  const auto run = [&](double cov_interval_s) {
    EkfOptions options;
    options.cov_interval_s = cov_interval_s;
    EkfNavigator filter(adis16465(), options);
    const Matrix15d prior = initial_sigmas().cwiseAbs2().asDiagonal();
    FullState state;
    state.motion = trip.truth(trip.begin_ns());
    filter.start(test::to_epoch(state, prior));
    for (const ImuIncrement& increment : trip.increments()) filter.propagate(increment);
    return filter.epoch().covariance;
  };
  const Matrix15d every_increment = run(0);
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

Consistency consistency_run(const Trip& trip, uint64_t seed, const ImuNoise& believed,
                            double gnss_end_s) {
  std::mt19937_64 rng{seed};
  const Eigen::Vector3d gnss_sigma(0.01, 0.01, 0.02);
  ImuErrors errors(adis16465(), 0, static_cast<int64_t>(seed));
  const Vector15d sigmas = initial_sigmas();
  FullState truth;
  truth.motion = trip.truth(trip.begin_ns());
  Vector15d deviation = sigmas.cwiseProduct(test::draw15(rng));
  deviation.tail<6>().setZero();  // the true biases are drawn, the first estimate is zero
  EkfNavigator filter(believed, EkfOptions{});
  filter.start(test::to_epoch(corrected(truth, deviation), sigmas.cwiseAbs2().asDiagonal()));

  Consistency result;
  const int64_t gnss_end_ns = trip.begin_ns() + nanoseconds(gnss_end_s);
  for (const ImuIncrement& exact : trip.increments()) {
    filter.propagate(errors.apply(exact));
    const int64_t now_ns = exact.t_end_ns;
    if (now_ns > gnss_end_ns || now_ns % kNanosecondsPerSecond != 0) continue;
    GnssFix fix = trip.exact_fix(now_ns, gnss_sigma);
    const Eigen::Vector3d noise_n = gnss_sigma.cwiseProduct(test::draw3(rng));
    fix.antenna = displaced(fix.antenna, noise_n, Place(fix.antenna));
    const Innovation innovation = filter.innovation(fix);
    result.nis += innovation.value_n.dot(innovation.covariance.llt().solve(innovation.value_n));
    ++result.fixes;
    filter.update(fix);
    if (now_ns == gnss_end_ns) {
      truth.motion = trip.truth(now_ns);
      truth.bias = errors.bias();
      const Vector15d error = difference(filter.state(), truth, kSize);
      const Matrix15d P = filter.epoch().covariance;
      result.nees = error.head<9>().dot(P.topLeftCorner<9, 9>().llt().solve(error.head<9>()));
      result.nees_bias =
          error.tail<6>().dot(P.bottomRightCorner<6, 6>().llt().solve(error.tail<6>()));
    }
  }
  truth.motion = trip.truth(filter.state().motion.t_ns);
  const Eigen::Vector2d drift = difference(filter.state(), truth, kSize).head<2>();
  const Eigen::Matrix2d P = filter.epoch().covariance.topLeftCorner<2, 2>();
  result.nees_outage = drift.dot(P.llt().solve(drift));
  result.horizontal_drift = drift.norm();
  result.nis /= result.fixes;
  return result;
}

Consistency mean_of_runs(const Trip& trip, int runs, const ImuNoise& believed) {
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
  ImuNoise believed = adis16465();
  believed.gyro_noise_density /= 2;
  const Consistency mean = mean_of_runs(trip_, kRuns, believed);
  EXPECT_GT(mean.nees, 9 + 2 * band(9, kRuns));
}

/// A drive of 400 s with fixes, by gyroscopes whose vertical scale is off by -2000 ppm. Only that
/// axis turns enough in a car to be seen.
EkfNavigator filter_that_found_scale_factors(const Trip& trip, const Eigen::Vector3d& gyro_scale) {
  std::mt19937_64 rng{3};
  ImuErrors errors(adis16465(), 0, 3);
  EkfOptions options;
  options.scale_factors = true;
  EkfNavigator filter(adis16465(), options);
  FullState begin;
  begin.motion = trip.truth(trip.begin_ns());
  filter.start(test::to_epoch(begin, initial_sigmas().cwiseAbs2().asDiagonal()));
  const Eigen::Vector3d gnss_sigma(0.01, 0.01, 0.02);
  for (const ImuIncrement& exact : trip.increments()) {
    ImuIncrement m = exact;
    m.dtheta_b.array() *= 1 + gyro_scale.array();
    filter.propagate(errors.apply(m));
    if (exact.t_end_ns % kNanosecondsPerSecond != 0) continue;
    GnssFix fix = trip.exact_fix(exact.t_end_ns, gnss_sigma);
    fix.antenna =
        displaced(fix.antenna, gnss_sigma.cwiseProduct(test::draw3(rng)), Place(fix.antenna));
    filter.update(fix);
  }
  return filter;
}

double vertical_gyro_scale_sigma(const EkfNavigator& filter) {
  return std::sqrt(filter.covariance()(ekf::kGyroScale + 2, ekf::kGyroScale + 2));
}

TEST(Ekf, FindsScaleFactors) {
  const Trip trip({"city", 60, 400, 50});
  const Eigen::Vector3d gyro_scale(1500e-6, -1000e-6, -2000e-6);
  const EkfNavigator filter = filter_that_found_scale_factors(trip, gyro_scale);
  const double sigma = vertical_gyro_scale_sigma(filter);
  EXPECT_LT(sigma, 500e-6);
  EXPECT_NEAR(filter.state().gyro_scale.z(), gyro_scale.z(), 3.3 * sigma);
}

TEST(Ekf, ScaleFactorsOutliveANewStart) {
  const Trip trip({"city", 60, 400, 50});
  EkfNavigator filter = filter_that_found_scale_factors(trip, {1500e-6, -1000e-6, -2000e-6});
  const FullState learned = filter.state();
  const Matrix before = filter.covariance();

  Epoch realigned = filter.epoch();
  constexpr double kHole = 60;
  realigned.t_ns += nanoseconds(kHole);
  realigned.covariance = initial_sigmas().cwiseAbs2().asDiagonal();
  filter.start(realigned);
  EXPECT_EQ(filter.state().gyro_scale, learned.gyro_scale);
  EXPECT_EQ(filter.state().accel_scale, learned.accel_scale);
  const Matrix after = filter.covariance();
  const Matrix15d of_motion = after.topLeftCorner<kSize, kSize>();
  EXPECT_EQ(of_motion, realigned.covariance);
  EXPECT_TRUE((after.topRightCorner<kSize, 6>().array() == 0).all());
  // They are Gauss-Markov processes of 1000 ppm and an hour while nobody looks.
  const double left = std::exp(-2 * kHole / 3600);
  Eigen::Matrix<double, 6, 6> expected = left * before.bottomRightCorner<6, 6>();
  expected.diagonal().array() += (1 - left) * 1e-6;
  EXPECT_LT((after.bottomRightCorner<6, 6>() - expected).norm(), 1e-9 * expected.norm());
  EXPECT_LT(vertical_gyro_scale_sigma(filter), 500e-6);
}

TEST(EkfOptions, FieldsAreReadFromTheirKeys) {
  EkfOptions options;
  set_config("scale_factors=true", options);
  set_config("gyro_scale_sigma_ppm=300", options);
  const ekf::ProcessNoise noise = options.process_noise(adis16465());
  EXPECT_EQ(noise.size(), 21);
  EXPECT_DOUBLE_EQ(noise.gyro_scale_sigma, 3e-4);
}

TEST(Ekf, OneAheadIsTheFilterWithOtherSigmas) {
  Fixture fixture;
  EkfNavigator filter = fixture.navigator();
  const std::unique_ptr<Navigator> doubtful = filter.ahead(2);
  EXPECT_LT((doubtful->epoch().covariance - 4 * fixture.prior).norm(), 1e-12);
  for (const ImuIncrement& increment : fixture.trip.increments()) {
    filter.propagate(increment);
    doubtful->propagate(increment);
  }
  const std::unique_ptr<Navigator> ahead = filter.ahead(1);
  const GnssFix fix = fixture.trip.exact_fix(filter.epoch().t_ns, {0.03, 0.02, 0.05});
  EXPECT_EQ(ahead->innovation(fix).value_n, filter.innovation(fix).value_n);
  EXPECT_LT((doubtful->innovation(fix).value_n - filter.innovation(fix).value_n).norm(), 1e-9);
  const Epoch before = filter.epoch();
  ahead->update(fix);
  EXPECT_EQ(filter.epoch().covariance, before.covariance);
}

/// What is learned beside the fifteen states stays, and so do correlations.
TEST(Ekf, LooseningAddsAndForgetsNothing) {
  Fixture fixture;
  EkfOptions options;
  options.scale_factors = true;
  EkfNavigator filter = fixture.navigator(options);
  for (const ImuIncrement& increment : fixture.trip.increments()) filter.propagate(increment);
  filter.update(fixture.trip.exact_fix(filter.epoch().t_ns, {0.03, 0.02, 0.05}));
  const Matrix before = filter.covariance();
  const FullState state = filter.state();
  Matrix15d added = Matrix15d::Zero();
  added.diagonal().head<3>() = Eigen::Vector3d(1, 4, 9);
  filter.loosen(added);
  Matrix expected = before;
  expected.topLeftCorner<15, 15>() += added;
  EXPECT_EQ(filter.covariance(), expected);
  EXPECT_GT(before.block(0, ekf::kGyroScale, 15, 6).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(filter.state().gyro_scale, state.gyro_scale);
}

}  // namespace
}  // namespace foucault
