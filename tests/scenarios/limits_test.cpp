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
  ImuNoise noise;
  double outage_s;
  double imu_rate_hz = 20;

  ScenarioOptions options() const {
    constexpr double kAfter = 60;
    ScenarioOptions o;
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
Epoch initial(const Drive& drive, const SimulatedSource& source) {
  Epoch epoch = source.truth(drive.options().start_ns());
  epoch.bias = {};
  NodeVector sigma;
  sigma << Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.1),
      Eigen::Vector3d(1e-3, 1e-3, 1e-2),
      Eigen::Vector3d::Constant(gyro_markov_bias(drive.noise).sigma),
      Eigen::Vector3d::Constant(accel_markov_bias(drive.noise).sigma);
  epoch.covariance = sigma.cwiseAbs2().asDiagonal();
  return epoch;
}

/// True minus estimated.
NodeVector error_of(const Epoch& epoch, const Epoch& truth) {
  NodeVector error;
  error << displacement_n(epoch.position, truth.position, Place(truth.position)),
      truth.velocity_n - epoch.velocity_n, so3::log(epoch.q_n_b.conjugate() * truth.q_n_b),
      truth.bias.gyro - epoch.bias.gyro, truth.bias.accel - epoch.bias.accel;
  return error;
}

struct Outcome {
  Innovation back;  ///< of the first fix after the outage
  Epoch end;
  NodeVector error;  ///< of `end`
};

Outcome run(const Drive& drive, Navigator& navigator) {
  SimulatedSource source(drive.options(), drive.noise);
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
    if (fix->t_ns == drive.outage_end_ns()) outcome.back = navigator.innovation(GnssPosition(*fix));
    navigator.update(gnss_position(*fix));
  }
  outcome.end = navigator.epoch();
  outcome.error = error_of(outcome.end, source.truth(outcome.end.t_ns));
  return outcome;
}

Outcome run_filter(const Drive& drive) {
  EkfNavigator filter(drive.noise, Layout{}, EkfOptions{});
  return run(drive, filter);
}

Outcome run_window(const Drive& drive, PreintegrationModel model) {
  WindowNavigator window(FgoOptions{}, model, drive.noise);
  return run(drive, window);
}

/// Largest deviation, each element in units of the sigmas of `expected`.
template <class Matrix>
double relative_deviation(const Matrix& value, const Matrix& expected) {
  const Eigen::MatrixXd scale = expected.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  return (scale * (value - expected) * scale).cwiseAbs().maxCoeff();
}

Eigen::Matrix2d horizontal(const Innovation& innovation) {
  return innovation.covariance.topLeftCorner<2, 2>();
}

/// In sigmas.
double largest_horizontal_error(const Outcome& outcome) {
  const NodeVector sigma = outcome.end.covariance.diagonal().cwiseSqrt();
  return outcome.error.cwiseQuotient(sigma).head<2>().cwiseAbs().maxCoeff();
}

/// Heights are unstable, and 47 km up they are no longer linear: only horizontally do two models
/// agree before the return.
TEST(LongOutage, OfAnHourInACity) {
  const Drive drive{"city", imu_preset("ADIS16465"), 3600};
  const Outcome ekf = run_filter(drive);
  const Outcome full = run_window(drive, PreintegrationModel::full);
  EXPECT_GT(horizontal(ekf.back)(0, 0), 1e8);
  EXPECT_LT(relative_deviation(horizontal(full.back), horizontal(ekf.back)), 0.01);
  EXPECT_LT(relative_deviation(full.end.covariance, ekf.end.covariance), 0.01);
  EXPECT_LT(largest_horizontal_error(full), 4);
  const Outcome refined = run_window(drive, PreintegrationModel::refined);
  EXPECT_LT(largest_horizontal_error(refined), 4);
}

TEST(LongOutage, OfTwoHoursAtRest) {
  const Drive drive{"static", imu_preset("navigation"), 7200};
  const Outcome ekf = run_filter(drive);
  const Outcome full = run_window(drive, PreintegrationModel::full);
  EXPECT_LT(relative_deviation(full.end.covariance, ekf.end.covariance), 0.01);
  EXPECT_LT(largest_horizontal_error(full), 4);
  const Outcome refined = run_window(drive, PreintegrationModel::refined);
  EXPECT_LT(largest_horizontal_error(refined), 4);
}

/// What a smoother says afterwards, one a node.
template <class Recorder>
std::deque<SmoothedEpoch> smoothed(const Drive& drive, Recorder recorder) {
  run(drive, recorder);
  return recorder.smoothed();
}

std::deque<SmoothedEpoch> rts(const Drive& drive) {
  return smoothed(drive, RtsRecorder(drive.noise, Layout{}, EkfOptions{}));
}

std::deque<SmoothedEpoch> batch(const Drive& drive) {
  return smoothed(drive,
                  BatchRecorder(std::make_unique<EkfNavigator>(drive.noise, Layout{}, EkfOptions{}),
                                FgoOptions{}, PreintegrationModel::full, drive.noise));
}

double smallest_eigenvalue_in_sigmas(const NodeMatrix& P) {
  const NodeMatrix scale = P.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  return Eigen::SelfAdjointEigenSolver<NodeMatrix>(scale * P * scale, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .minCoeff();
}

double nees(const Eigen::Vector3d& error, const Epoch& epoch) {
  const Eigen::Matrix3d P = epoch.covariance.topLeftCorner<3, 3>();
  return error.dot(P.llt().solve(error));
}

/// Half an hour, in which the filter's errors of 10 km are still linear.
TEST(LongOutage, SmoothersAreSoundInTheMiddleOfIt) {
  const Drive drive{"city", imu_preset("ADIS16465"), 1800};
  constexpr double kNeesOfOneInAMillion = 30.7;  // chi-square of 3
  const SimulatedSource source(drive.options(), drive.noise);
  const std::deque<SmoothedEpoch> filtered = rts(drive);
  const std::deque<SmoothedEpoch> optimized = batch(drive);
  ASSERT_EQ(filtered.size(), optimized.size());
  for (std::size_t k = 0; k < filtered.size(); ++k) {
    for (const Epoch& epoch : {filtered[k].epoch(), optimized[k].epoch()}) {
      EXPECT_GT(smallest_eigenvalue_in_sigmas(epoch.covariance), 1e-4) << k;
      const NodeVector error = error_of(epoch, source.truth(epoch.t_ns));
      EXPECT_LT(nees(error.head<3>(), epoch), kNeesOfOneInAMillion) << k;
    }
  }
}

ImuNoise with_constant_biases() {
  ImuNoise noise = imu_preset("ADIS16465");
  noise.gyro_bias_sigma = noise.accel_bias_sigma = 0;
  return noise;
}

ImuNoise with_a_constant_gyro_bias() {
  ImuNoise noise = imu_preset("ADIS16465");
  noise.gyro_bias_sigma = 0;
  return noise;
}

ImuNoise with_biases_of_a_century() {
  ImuNoise noise = imu_preset("ADIS16465");
  noise.bias_tau = 3e9;
  return noise;
}

class ConstantBias : public ::testing::TestWithParam<ImuNoise (*)()> {};
INSTANTIATE_TEST_SUITE_P(Noises, ConstantBias,
                         ::testing::Values(with_constant_biases, with_a_constant_gyro_bias,
                                           with_biases_of_a_century));

TEST_P(ConstantBias, WindowAndFilterAgree) {
  const Drive drive{"city", GetParam()(), 60, 50};
  const Outcome ekf = run_filter(drive);
  const Outcome full = run_window(drive, PreintegrationModel::full);
  EXPECT_LT(relative_deviation(full.back.covariance, ekf.back.covariance), 0.005);
  EXPECT_LT((full.back.value - ekf.back.value).norm(), 0.005 * ekf.back.value.norm());
  EXPECT_LT(relative_deviation(full.end.covariance, ekf.end.covariance), 0.005);
  EXPECT_LT(largest_horizontal_error(run_window(drive, PreintegrationModel::refined)), 4);
}

TEST_P(ConstantBias, SmoothersAgree) {
  const Drive drive{"city", GetParam()(), 60, 50};
  const std::deque<SmoothedEpoch> filtered = rts(drive);
  const std::deque<SmoothedEpoch> optimized = batch(drive);
  ASSERT_EQ(filtered.size(), optimized.size());
  for (std::size_t k = 200; k < filtered.size(); ++k) {
    const Epoch a = filtered[k].epoch();
    const Epoch b = optimized[k].epoch();
    EXPECT_LT(relative_deviation(b.covariance, a.covariance), 0.005) << k;
    const NodeVector sigma = a.covariance.diagonal().cwiseSqrt();
    EXPECT_LT(error_of(b, a).cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.1) << k;
  }
}

/// Simulations may be without any noise; the filter and its smoother take that as it is.
TEST(NoNoise, IsTakenByTheFilter) {
  const Drive drive{"city", ImuNoise{}, 60};
  const Outcome ekf = run_filter(drive);
  EXPECT_LT(ekf.back.value.norm(), 0.1);
  EXPECT_TRUE(ekf.end.covariance.allFinite());
  for (const SmoothedEpoch& node : rts(drive)) {
    EXPECT_TRUE(node.covariance.full().allFinite());
    EXPECT_GE(node.covariance.full().diagonal().minCoeff(), 0);
    EXPECT_TRUE(node.after.allFinite());
  }
}

TEST(NoNoise, IsRefusedByGraphsWithItsKey) {
  const auto refusal = [](double ImuNoise::*a, double ImuNoise::*b) -> std::string {
    ImuNoise noise = imu_preset("ADIS16465");
    noise.*a = noise.*b = 0;
    try {
      WindowNavigator(FgoOptions{}, PreintegrationModel::full, noise);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal(&ImuNoise::gyro_noise_density, &ImuNoise::gyro_noise_density),
              HasSubstr("imu.arw_deg_sqrt_h is 0"));
  EXPECT_THAT(refusal(&ImuNoise::accel_noise_density, &ImuNoise::accel_noise_density),
              HasSubstr("imu.vrw_m_s_sqrt_h is 0"));
  EXPECT_THAT(refusal(&ImuNoise::gyro_bias_sigma, &ImuNoise::gyro_turn_on_sigma),
              HasSubstr("imu.gyro_bias_deg_h and imu.gyro_turn_on_deg_h are both 0"));
  EXPECT_THAT(refusal(&ImuNoise::accel_bias_sigma, &ImuNoise::accel_turn_on_sigma),
              HasSubstr("imu.accel_bias_mgal and imu.accel_turn_on_mgal are both 0"));
}

}  // namespace
}  // namespace foucault
