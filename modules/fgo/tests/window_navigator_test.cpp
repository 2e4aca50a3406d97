#include "foucault/fgo/window_navigator.h"

#include <gtest/gtest.h>

#include "cartesian_fix.h"
#include "noisy_drive.h"

namespace foucault::fgo {
namespace {

using namespace testing;

class WindowNavigatorTest : public NoisyDrive {};

TEST_F(WindowNavigatorTest, ErrorsStayWithinTheirCovariance) {
  double nees_sum = 0;
  int count = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    reseed(seed);
    WindowNavigator navigator(window_of(10), preintegration::PreintegrationModel::refined,
                              test_noise());
    navigator.start(initial(1));
    run(navigator, 30, 20, 28, [&](int) {});
    const state::Epoch last = navigator.epoch();
    const state::NodeVector e = error(last);
    nees_sum += e.dot(last.covariance.ldlt().solve(e));
    ++count;
  }
  // Sum of `count` chi-squares of 15: 300 +- 24.5; 99.9 %.
  EXPECT_NEAR(nees_sum, 15.0 * count, 3.3 * std::sqrt(2 * 15.0 * count));
}

TEST_F(WindowNavigatorTest, MarginalizedWindowIsTheBatch) {
  WindowNavigator window(window_of(5), preintegration::PreintegrationModel::refined, test_noise());
  WindowNavigator batch(window_of(1e9), preintegration::PreintegrationModel::refined, test_noise());
  reseed(1);
  window.start(initial(0.1));
  run(window, 25, 10, 15, [](int) {});
  reseed(1);
  batch.start(initial(0.1));
  run(batch, 25, 10, 15, [](int) {});
  EXPECT_LE(window.nodes(), 6u);
  EXPECT_EQ(batch.nodes(), 26u);

  // The problem is linear but for the attitude's error, so what marginalization loses is of second
  // order in it: a hundredth of a sigma; and nothing in the covariance.
  const state::Epoch a = window.epoch();
  const state::Epoch b = batch.epoch();
  const state::NodeVector sigma = b.covariance.diagonal().cwiseSqrt();
  const state::NodeVector difference = error(a) - error(b);
  EXPECT_LT(difference.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 1e-2);
  EXPECT_LT(
      (a.covariance.diagonal().cwiseSqrt() - sigma).cwiseQuotient(sigma).cwiseAbs().maxCoeff(),
      1e-3);
}

/// Iterated EKF on the same models, in covariance form with textbook formulas.
class IteratedEkf {
 public:
  IteratedEkf(const state::NodeState& x, const state::NodeMatrix& P,
              const preintegration::EarthModel& earth)
      : x_(x), P_(P), earth_(earth) {}

  void predict(const preintegration::Preintegration& pre) {
    const state::NodeState next = preintegration::predict(x_, pre, earth_);
    P_ = preintegration::predict_covariance(x_, next, pre, earth_, P_);
    x_ = next;
  }

  void update(const CartesianFix& fix) {
    const state::NodeState prior = x_;
    Eigen::Matrix<double, 3, state::kNodeSize> H;
    Eigen::Matrix<double, state::kNodeSize, 3> K;
    state::NodeMatrix at_prior = state::NodeMatrix::Identity();
    for (int i = 0; i < 10; ++i) {
      const state::NodeVector moved = state::boxminus(x_, prior);
      // Prior covariance in the tangent of the current iterate.
      state::part(at_prior, state::block::attitude, state::block::attitude) =
          so3::right_jacobian(state::part(moved, state::block::attitude));
      const state::NodeMatrix P = at_prior * P_ * at_prior.transpose();
      H = antenna_jacobian(x_, fix);
      K = P * H.transpose() * (H * P * H.transpose() + fix.covariance_w).inverse();
      const state::NodeVector back = at_prior * moved;
      x_ = state::boxplus(x_, K * (antenna_innovation(x_, fix) + H * back) - back);
    }
    P_ = (state::NodeMatrix::Identity() - K * H) * (at_prior * P_ * at_prior.transpose());
  }

  const state::NodeState& x() const { return x_; }
  const state::NodeMatrix& P() const { return P_; }

 private:
  state::NodeState x_;
  state::NodeMatrix P_;
  preintegration::EarthModel earth_;
};

TEST_F(WindowNavigatorTest, OneStateWindowIsAnIteratedEkf) {
  FgoOptions options = window_of(0);
  options.max_iterations = 50;
  WindowNavigator navigator(options, preintegration::PreintegrationModel::refined, test_noise());
  const state::Epoch begin = initial(1);
  navigator.start(begin);
  // Within an update the window moves both its nodes, the filter only the last; with intervals as
  // short as one sample nothing is left between them.
  const geodesy::LocalFrame frame(begin.position);
  state::NodeState x;
  x.v_w_b = begin.velocity_n;
  x.q_w_b = begin.q_n_b;
  x.bias = begin.bias;
  IteratedEkf ekf(x, begin.covariance, wuhan_earth());
  std::optional<ImuIncrement> before;
  for (int k = 0; k < 300; ++k) {
    const ImuIncrement increment = noisy_increment(k * 10'000'000LL, (k + 1) * 10'000'000LL);
    const GnssFix fix = fix_at(0.01 * (k + 1), 0.02);
    navigator.propagate(increment);
    navigator.update(measurement::gnss_position(fix));
    preintegration::Preintegrator pre(test_noise(), ekf.x().bias, increment.t_begin_ns, before);
    pre.add(increment);
    ekf.predict(pre.result());
    ekf.update(cartesian(fix, frame));
    before = increment;
    ASSERT_EQ(navigator.nodes(), 1u);
  }
  const state::Epoch end = navigator.epoch();
  state::NodeState window;
  const Matrix3d R_w_n = frame.R_w_n(end.position);
  window.p_w_b = frame.to_local(end.position);
  window.v_w_b = R_w_n * end.velocity_n;
  window.q_w_b = Eigen::Quaterniond(R_w_n) * end.q_n_b;
  window.bias = end.bias;
  const state::NodeVector sigma = ekf.P().diagonal().cwiseSqrt();
  const state::NodeVector difference = state::boxminus(window, ekf.x()).cwiseQuotient(sigma);
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 0.01) << difference.transpose();
  const state::NodeVector window_sigma = end.covariance.diagonal().cwiseSqrt();
  EXPECT_LT((window_sigma - sigma).cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.01);
}

TEST_F(WindowNavigatorTest, RoughLosesWhatTheEarthTurns) {
  // Long enough for the difference to leave the noise; the same code, the Earth's rate zero.
  double drift[2] = {0, 0};
  int which = 0;
  for (const preintegration::PreintegrationModel model :
       {preintegration::PreintegrationModel::refined, preintegration::PreintegrationModel::rough}) {
    reseed(3);
    imu::ImuNoise noise = test_noise();
    noise.gyro_bias_sigma = 1e-7;  // a gyro so stable that it cannot hide the Earth
    WindowNavigator navigator(window_of(20), model, noise);
    state::Epoch begin = initial(0);
    state::part(begin.covariance, state::block::gyro_bias, state::block::gyro_bias) =
        1e-12 * Matrix3d::Identity();
    navigator.start(begin);
    run(navigator, 80, 20, 81, [](int) {});
    drift[which++] = error(navigator.epoch()).head<2>().norm();
  }
  EXPECT_GT(drift[1], 5 * drift[0]);
}

TEST_F(WindowNavigatorTest, RobustLossShrugsOffAnOutlier) {
  double error_with[2];
  int which = 0;
  for (const char* robust : {"none", "cauchy"}) {
    reseed(4);
    FgoOptions options = window_of(10);
    options.robust = robust;
    WindowNavigator navigator(options, preintegration::PreintegrationModel::refined, test_noise());
    navigator.start(initial(0.1));
    run(navigator, 30, 99, 99, [](int) {});
    navigator.propagate(noisy_increment(30'000'000'000, 30'010'000'000));
    GnssFix outlier = fix_at(30.01, 0.02);
    outlier.antenna.height += 10;
    navigator.update(measurement::gnss_position(outlier));
    error_with[which++] = error(navigator.epoch()).head<3>().norm();
  }
  EXPECT_GT(error_with[0], 0.3);
  EXPECT_LT(error_with[1], 0.05);
}

TEST_F(WindowNavigatorTest, PredictsBetweenNodes) {
  WindowNavigator navigator(window_of(10), preintegration::PreintegrationModel::refined,
                            test_noise());
  navigator.start(initial(0.1));
  run(navigator, 15, 99, 99, [](int) {});
  const double before =
      navigator.epoch().covariance(state::block::position.offset, state::block::position.offset);
  for (int k = 0; k < 50; ++k)
    navigator.propagate(noisy_increment(15'000'000'000 + k * 10'000'000LL,
                                        15'000'000'000 + (k + 1) * 10'000'000LL));
  const state::Epoch half = navigator.epoch();
  EXPECT_EQ(half.t_ns, 15'500'000'000);
  EXPECT_LT(error(half).head<3>().norm(), 0.1);
  EXPECT_GT(half.covariance(state::block::position.offset, state::block::position.offset), before);
}

TEST_F(WindowNavigatorTest, InnovationIsWhiteWithItsCovariance) {
  WindowNavigator navigator(window_of(10), preintegration::PreintegrationModel::refined,
                            test_noise());
  reseed(6);
  navigator.start(initial(1));
  double nis = 0;
  int count = 0;
  for (int second = 1; second <= 60; ++second) {
    for (int64_t t = (second - 1) * 100LL; t < second * 100LL; ++t)
      navigator.propagate(noisy_increment(t * 10'000'000, (t + 1) * 10'000'000));
    const GnssFix fix = fix_at(second, 0.02);
    const state::Innovation innovation = navigator.innovation(*measurement::gnss_position(fix));
    nis += innovation.value.dot(innovation.covariance.ldlt().solve(innovation.value));
    ++count;
    navigator.update(measurement::gnss_position(fix));
  }
  EXPECT_NEAR(nis, 3.0 * count, 3.3 * std::sqrt(2 * 3.0 * count));
}

/// Attitudes off by tens of degrees and increments known to 1e-5 m/s: the valley of the cost is
/// curved, and a plain Gauss-Newton step climbs out of it.
TEST_F(WindowNavigatorTest, ConvergesFromAttitudesFarOff) {
  imu::ImuNoise noise = test_noise();
  noise.gyro_noise_density = 1e-6;
  noise.accel_noise_density = 1e-5;
  for (unsigned seed = 0; seed < 20; ++seed) {
    reseed(seed);
    state::Epoch begin = initial(1);
    const Vector3d sigma(0.1, 0.1, 0.4);
    begin.q_n_b = begin.q_n_b * so3::exp(draw(1).cwiseProduct(sigma));
    state::part(begin.covariance, state::block::attitude, state::block::attitude).diagonal() +=
        sigma.cwiseAbs2();
    WindowNavigator navigator(window_of(10), preintegration::PreintegrationModel::refined, noise);
    navigator.start(begin);
    for (int second = 1; second <= 20; ++second) {
      const int64_t begin_ns = (second - 1) * 1'000'000'000LL;
      for (int64_t t = begin_ns; t < begin_ns + 1'000'000'000LL; t += 10'000'000) {
        navigator.propagate(motion_.increment(t, t + 10'000'000));
      }
      navigator.update(measurement::gnss_position(fix_at(second, 0.02)));
      const state::NodeVector e = error(navigator.epoch());
      if (second < 5) continue;  // the lever arm turns with the attitude
      EXPECT_LT(state::part(e, state::block::position).norm(), 0.15) << seed << " " << second;
    }
    EXPECT_LT(state::part(error(navigator.epoch()), state::block::attitude).norm(), 0.02) << seed;
  }
}

TEST_F(WindowNavigatorTest, ALargeBiasIsIntegratedAnew) {
  // A phone's gyro bias of 0.05 rad/s, not known at the start: first-order updates alone would
  // leave errors of second order in 0.05 rad.
  reseed(8);
  WindowNavigator navigator(window_of(10), preintegration::PreintegrationModel::refined,
                            test_noise());
  state::Epoch begin = initial(0.1);
  state::part(begin.covariance, state::block::gyro_bias, state::block::gyro_bias) =
      0.0025 * Matrix3d::Identity();
  const Vector3d bias(0.05, -0.03, 0.04);
  navigator.start(begin);
  for (int second = 1; second <= 30; ++second) {
    for (int64_t t = (second - 1) * 100LL; t < second * 100LL; ++t) {
      ImuIncrement increment = noisy_increment(t * 10'000'000, (t + 1) * 10'000'000);
      increment.dtheta_b += bias * increment.dt();
      navigator.propagate(increment);
    }
    navigator.update(measurement::gnss_position(fix_at(second, 0.02)));
  }
  const state::Epoch end = navigator.epoch();
  EXPECT_LT((end.bias.gyro - bias).norm(), 3e-4);
  const state::NodeVector e = error(end);
  EXPECT_LT(e.head<3>().norm(), 0.1);
}

TEST_F(WindowNavigatorTest, OneAheadForeseesWhatItselfWillSay) {
  WindowNavigator navigator(window_of(10), preintegration::PreintegrationModel::refined,
                            test_noise());
  navigator.start(initial(1));
  run(navigator, 12, 99, 99, [](int) {});
  navigator.propagate(noisy_increment(12'000'000'000, 12'010'000'000));
  const state::Epoch before = navigator.epoch();
  const std::unique_ptr<measurement::Navigator> ahead = navigator.ahead(1);
  const std::unique_ptr<measurement::Navigator> doubtful = navigator.ahead(3);
  for (int64_t t = 12'010'000'000; t < 14'000'000'000; t += 10'000'000) {
    const ImuIncrement increment = noisy_increment(t, t + 10'000'000);
    for (measurement::Navigator* n :
         {static_cast<measurement::Navigator*>(&navigator), ahead.get(), doubtful.get()}) {
      n->propagate(increment);
    }
  }
  const measurement::ObservationPtr fix = measurement::gnss_position(fix_at(14, 0.02));
  const state::Innovation own = navigator.innovation(*fix);
  EXPECT_LT((ahead->innovation(*fix).value - own.value).norm(), 1e-6);
  EXPECT_LT((ahead->innovation(*fix).covariance - own.covariance).norm(),
            1e-6 * own.covariance.norm());
  EXPECT_LT((doubtful->innovation(*fix).value - own.value).norm(), 1e-6);
  ahead->update(fix);  // its own affair
  EXPECT_EQ(navigator.innovation(*fix).value, own.value);
  // Three times the sigma, but for the noise of two seconds and of the fix.
  const double grown =
      doubtful->epoch().covariance(state::block::attitude.offset, state::block::attitude.offset);
  EXPECT_NEAR(grown / navigator.epoch().covariance(state::block::attitude.offset,
                                                   state::block::attitude.offset),
              9, 0.5);
  EXPECT_EQ(before.t_ns, 12'010'000'000);
}

TEST_F(WindowNavigatorTest, WhatLoosensItIsAddedToItsCovariance) {
  WindowNavigator navigator(window_of(10), preintegration::PreintegrationModel::refined,
                            test_noise());
  navigator.start(initial(1));
  run(navigator, 12, 10, 99, [](int) {});
  const state::Epoch before = navigator.epoch();
  state::NodeMatrix added = state::NodeMatrix::Zero();
  added.diagonal().head<3>() = Vector3d(1, 4, 9);
  navigator.loosen(added);
  const state::Epoch after = navigator.epoch();
  EXPECT_LT((after.covariance - before.covariance - added).norm(), 1e-6);
  EXPECT_LT((error(after) - error(before)).norm(), 1e-6);
  navigator.update(measurement::gnss_position(fix_at(12, 0.02)));
  EXPECT_LT(error(navigator.epoch()).head<3>().norm(), 0.1);
}

}  // namespace
}  // namespace foucault::fgo
