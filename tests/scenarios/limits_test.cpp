/// Where time and noise go to their limits: outages of hours, in which covariances grow by ten
/// orders of magnitude, and biases that are constant. All methods go on, and know what the filter
/// in covariance form knows.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <deque>
#include <memory>
#include <optional>

#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/ekf/rts.h"
#include "foucault/fgo/batch.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/geodesy/place.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault {
namespace {

/// Fixes, an outage, and a minute of fixes again.
struct Drive {
  const char* scenario;
  imu::ImuNoise noise;
  double outage_s;
  double imu_rate_hz = 20;

  simulation::ScenarioOptions options() const {
    constexpr double kAfter = 60;
    simulation::ScenarioOptions o;
    o.name = scenario;
    o.duration_s = kBefore + outage_s + kAfter;
    o.seed = 5;
    o.imu_rate_hz = imu_rate_hz;
    o.reference_rate_hz = 0;
    return o;
  }
  int64_t outage_begin_ns() const { return options().start_ns() + nanoseconds(kBefore); }
  int64_t outage_end_ns() const { return outage_begin_ns() + nanoseconds(outage_s); }

  static constexpr double kBefore = 200;
};

/// The true state with a coarse alignment's covariance.
state::Epoch initial(const Drive& drive, const simulation::SimulatedSource& source) {
  state::Epoch epoch = source.truth(drive.options().start_ns());
  epoch.bias = {};
  state::NodeVector sigma;
  sigma << Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.1),
      Eigen::Vector3d(1e-3, 1e-3, 1e-2),
      Eigen::Vector3d::Constant(imu::gyro_markov_bias(drive.noise).sigma),
      Eigen::Vector3d::Constant(imu::accel_markov_bias(drive.noise).sigma);
  epoch.covariance = sigma.cwiseAbs2().asDiagonal();
  return epoch;
}

/// True minus estimated.
state::NodeVector error_of(const state::Epoch& epoch, const state::Epoch& truth) {
  state::NodeVector error;
  error << geodesy::displacement_n(epoch.position, truth.position, geodesy::Place(truth.position)),
      truth.velocity_n - epoch.velocity_n, so3::log(epoch.q_n_b.conjugate() * truth.q_n_b),
      truth.bias.gyro - epoch.bias.gyro, truth.bias.accel - epoch.bias.accel;
  return error;
}

struct Outcome {
  state::Innovation back;  ///< of the first fix after the outage
  state::Epoch end;
  state::NodeVector error;  ///< of `end`
};

Outcome run(const Drive& drive, measurement::Navigator& navigator) {
  simulation::SimulatedSource source(drive.options(), drive.noise);
  navigator.start(initial(drive, source));
  Outcome outcome;
  std::optional<GnssFix> fix;
  while (const std::optional<Measurement> measurement = source.next()) {
    if (const auto* next = std::get_if<GnssFix>(&*measurement)) fix = *next;
    const auto* increment = std::get_if<ImuIncrement>(&*measurement);
    if (increment == nullptr) continue;
    navigator.propagate(*increment);
    if (!fix || fix->t_ns != increment->t_end_ns) continue;
    if (fix->t_ns > drive.outage_begin_ns() && fix->t_ns < drive.outage_end_ns()) {
      navigator.hold();
      continue;
    }
    if (fix->t_ns == drive.outage_end_ns())
      outcome.back = navigator.innovation(measurement::GnssPosition(*fix));
    navigator.update(measurement::gnss_position(*fix));
  }
  outcome.end = navigator.epoch();
  outcome.error = error_of(outcome.end, source.truth(outcome.end.t_ns));
  return outcome;
}

Outcome run_filter(const Drive& drive) {
  ekf::EkfNavigator filter(drive.noise, state::Layout{}, ekf::EkfOptions{});
  return run(drive, filter);
}

Outcome run_window(const Drive& drive, preintegration::PreintegrationModel model) {
  fgo::WindowNavigator window(fgo::FgoOptions{}, model, drive.noise);
  return run(drive, window);
}

/// Largest deviation, each element in units of the sigmas of `expected`.
template <class Matrix>
double relative_deviation(const Matrix& value, const Matrix& expected) {
  const Eigen::MatrixXd scale = expected.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  return (scale * (value - expected) * scale).cwiseAbs().maxCoeff();
}

Eigen::Matrix2d horizontal(const state::Innovation& innovation) {
  return innovation.covariance.topLeftCorner<2, 2>();
}

/// In sigmas.
double largest_horizontal_error(const Outcome& outcome) {
  const state::NodeVector sigma = outcome.end.covariance.diagonal().cwiseSqrt();
  return outcome.error.cwiseQuotient(sigma).head<2>().cwiseAbs().maxCoeff();
}

/// Heights are unstable, and 47 km up they are no longer linear: only horizontally do two models
/// agree before the return.
TEST(LongOutage, OfAnHourInACity) {
  const Drive drive{"city", imu::imu_preset("ADIS16465"), 3600};
  const Outcome ekf = run_filter(drive);
  const Outcome full = run_window(drive, preintegration::PreintegrationModel::full);
  EXPECT_GT(horizontal(ekf.back)(0, 0), 1e8);
  EXPECT_LT(relative_deviation(horizontal(full.back), horizontal(ekf.back)), 0.01);
  EXPECT_LT(relative_deviation(full.end.covariance, ekf.end.covariance), 0.01);
  EXPECT_LT(largest_horizontal_error(full), 4);
  const Outcome refined = run_window(drive, preintegration::PreintegrationModel::refined);
  EXPECT_LT(largest_horizontal_error(refined), 4);
}

TEST(LongOutage, OfTwoHoursAtRest) {
  const Drive drive{"static", imu::imu_preset("navigation"), 7200};
  const Outcome ekf = run_filter(drive);
  const Outcome full = run_window(drive, preintegration::PreintegrationModel::full);
  EXPECT_LT(relative_deviation(full.end.covariance, ekf.end.covariance), 0.01);
  EXPECT_LT(largest_horizontal_error(full), 4);
  const Outcome refined = run_window(drive, preintegration::PreintegrationModel::refined);
  EXPECT_LT(largest_horizontal_error(refined), 4);
}

/// What a smoother says afterwards, one a node.
template <class Recorder>
std::deque<measurement::SmoothedEpoch> smoothed(const Drive& drive, Recorder recorder) {
  run(drive, recorder);
  return recorder.smoothed();
}

std::deque<measurement::SmoothedEpoch> rts(const Drive& drive) {
  return smoothed(drive, ekf::RtsRecorder(drive.noise, state::Layout{}, ekf::EkfOptions{}));
}

std::deque<measurement::SmoothedEpoch> batch(const Drive& drive) {
  return smoothed(
      drive,
      fgo::BatchRecorder(
          std::make_unique<ekf::EkfNavigator>(drive.noise, state::Layout{}, ekf::EkfOptions{}),
          fgo::FgoOptions{}, preintegration::PreintegrationModel::full, drive.noise));
}

double smallest_eigenvalue_in_sigmas(const state::NodeMatrix& P) {
  const state::NodeMatrix scale = P.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  return Eigen::SelfAdjointEigenSolver<state::NodeMatrix>(scale * P * scale, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .minCoeff();
}

double nees(const Eigen::Vector3d& error, const state::Epoch& epoch) {
  const Eigen::Matrix3d P = epoch.covariance.topLeftCorner<3, 3>();
  return error.dot(P.llt().solve(error));
}

/// Half an hour, in which the filter's errors of 10 km are still linear.
TEST(LongOutage, SmoothersAreSoundInTheMiddleOfIt) {
  const Drive drive{"city", imu::imu_preset("ADIS16465"), 1800};
  constexpr double kNeesOfOneInAMillion = 30.7;  // chi-square of 3
  const simulation::SimulatedSource source(drive.options(), drive.noise);
  const std::deque<measurement::SmoothedEpoch> filtered = rts(drive);
  const std::deque<measurement::SmoothedEpoch> optimized = batch(drive);
  ASSERT_EQ(filtered.size(), optimized.size());
  for (std::size_t k = 0; k < filtered.size(); ++k) {
    for (const state::Epoch& epoch : {filtered[k].epoch(), optimized[k].epoch()}) {
      EXPECT_GT(smallest_eigenvalue_in_sigmas(epoch.covariance), 1e-4) << k;
      const state::NodeVector error = error_of(epoch, source.truth(epoch.t_ns));
      EXPECT_LT(nees(error.head<3>(), epoch), kNeesOfOneInAMillion) << k;
    }
  }
}

imu::ImuNoise with_constant_biases() {
  imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  noise.gyro_bias_sigma = noise.accel_bias_sigma = 0;
  return noise;
}

imu::ImuNoise with_a_constant_gyro_bias() {
  imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  noise.gyro_bias_sigma = 0;
  return noise;
}

imu::ImuNoise with_biases_of_a_century() {
  imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  noise.bias_tau = 3e9;
  return noise;
}

class ConstantBias : public ::testing::TestWithParam<imu::ImuNoise (*)()> {};
INSTANTIATE_TEST_SUITE_P(Noises, ConstantBias,
                         ::testing::Values(with_constant_biases, with_a_constant_gyro_bias,
                                           with_biases_of_a_century));

TEST_P(ConstantBias, WindowAndFilterAgree) {
  const Drive drive{"city", GetParam()(), 60, 50};
  const Outcome ekf = run_filter(drive);
  const Outcome full = run_window(drive, preintegration::PreintegrationModel::full);
  EXPECT_LT(relative_deviation(full.back.covariance, ekf.back.covariance), 0.005);
  EXPECT_LT((full.back.value - ekf.back.value).norm(), 0.005 * ekf.back.value.norm());
  EXPECT_LT(relative_deviation(full.end.covariance, ekf.end.covariance), 0.005);
  EXPECT_LT(
      largest_horizontal_error(run_window(drive, preintegration::PreintegrationModel::refined)), 4);
}

TEST_P(ConstantBias, SmoothersAgree) {
  const Drive drive{"city", GetParam()(), 60, 50};
  const std::deque<measurement::SmoothedEpoch> filtered = rts(drive);
  const std::deque<measurement::SmoothedEpoch> optimized = batch(drive);
  ASSERT_EQ(filtered.size(), optimized.size());
  for (std::size_t k = 200; k < filtered.size(); ++k) {
    const state::Epoch a = filtered[k].epoch();
    const state::Epoch b = optimized[k].epoch();
    EXPECT_LT(relative_deviation(b.covariance, a.covariance), 0.005) << k;
    const state::NodeVector sigma = a.covariance.diagonal().cwiseSqrt();
    EXPECT_LT(error_of(b, a).cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.1) << k;
  }
}

/// Simulations may be without any noise; the filter and its smoother take that as it is.
TEST(NoNoise, IsTakenByTheFilter) {
  const Drive drive{"city", imu::ImuNoise{}, 60};
  const Outcome ekf = run_filter(drive);
  EXPECT_LT(ekf.back.value.norm(), 0.1);
  EXPECT_TRUE(ekf.end.covariance.allFinite());
  for (const measurement::SmoothedEpoch& node : rts(drive)) {
    EXPECT_TRUE(node.covariance.full().allFinite());
    EXPECT_GE(node.covariance.full().diagonal().minCoeff(), 0);
    EXPECT_TRUE(node.after.allFinite());
  }
}

TEST(NoNoise, IsRefusedByGraphsWithItsKey) {
  const auto refusal = [](double imu::ImuNoise::*a, double imu::ImuNoise::*b) -> std::string {
    imu::ImuNoise noise = imu::imu_preset("ADIS16465");
    noise.*a = noise.*b = 0;
    try {
      fgo::WindowNavigator(fgo::FgoOptions{}, preintegration::PreintegrationModel::full, noise);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal(&imu::ImuNoise::gyro_noise_density, &imu::ImuNoise::gyro_noise_density),
              HasSubstr("imu.arw_deg_sqrt_h is 0"));
  EXPECT_THAT(refusal(&imu::ImuNoise::accel_noise_density, &imu::ImuNoise::accel_noise_density),
              HasSubstr("imu.vrw_m_s_sqrt_h is 0"));
  EXPECT_THAT(refusal(&imu::ImuNoise::gyro_bias_sigma, &imu::ImuNoise::gyro_turn_on_sigma),
              HasSubstr("imu.gyro_bias_deg_h and imu.gyro_turn_on_deg_h are both 0"));
  EXPECT_THAT(refusal(&imu::ImuNoise::accel_bias_sigma, &imu::ImuNoise::accel_turn_on_sigma),
              HasSubstr("imu.accel_bias_mgal and imu.accel_turn_on_mgal are both 0"));
}

}  // namespace
}  // namespace foucault
