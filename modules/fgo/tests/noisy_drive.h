#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../preintegration/tests/closed_form_motion.h"
#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/fgo/fgo_options.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/measurement/navigator.h"
#include "foucault/preintegration/motion.h"

namespace foucault::testing {

using Eigen::Matrix3d;
using Eigen::Vector3d;

inline const Geodetic kOrigin{30.45 * kDegree, 114.47 * kDegree, 20};

inline imu::ImuNoise test_noise() {
  imu::ImuNoise noise;
  noise.gyro_noise_density = 5e-5;
  noise.accel_noise_density = 5e-4;
  noise.gyro_bias_sigma = 1e-5;
  noise.accel_bias_sigma = 1e-4;
  noise.bias_tau = 3600;
  return noise;
}

/// A minute of closed-form motion with noisy increments and fixes of a GNSS antenna.
class NoisyDrive : public ::testing::Test {
 protected:
  NoisyDrive() : frame_(kOrigin), motion_(wuhan_earth()) {}

  void reseed(unsigned seed) {
    rng_.seed(seed);
    normal_.reset();  // it keeps the second of each pair it makes
  }

  Vector3d draw(double sigma) {
    return sigma * Vector3d(normal_(rng_), normal_(rng_), normal_(rng_));
  }

  state::Epoch initial(double scale) {
    const state::NodeState x = motion_.state(0);
    const state::NodeVector sigma = initial_sigma();
    state::NodeVector error;
    for (int i = 0; i < state::kNodeSize; ++i) error[i] = scale * sigma[i] * normal_(rng_);
    const state::NodeState start = state::boxplus(x, error);
    state::Epoch epoch;
    epoch.position = frame_.to_geodetic(start.p_w_b);
    epoch.velocity_n = start.v_w_b;
    epoch.q_n_b = start.q_w_b;
    epoch.bias = start.bias;
    epoch.covariance = sigma.array().square().matrix().asDiagonal();
    return epoch;
  }

  static state::NodeVector initial_sigma() {
    state::NodeVector sigma;
    sigma << Vector3d::Constant(0.05), Vector3d::Constant(0.05), Vector3d(5e-3, 5e-3, 2e-2),
        Vector3d::Constant(2e-4), Vector3d::Constant(1e-2);
    return sigma;
  }

  ImuIncrement noisy_increment(int64_t begin_ns, int64_t end_ns) {
    ImuIncrement out = motion_.increment(begin_ns, end_ns);
    const double root = std::sqrt(out.dt());
    out.dtheta_b += draw(test_noise().gyro_noise_density * root);
    out.dvel_b += draw(test_noise().accel_noise_density * root);
    return out;
  }

  GnssFix fix_at(double t, double sigma) {
    GnssFix fix;
    fix.t_ns = static_cast<int64_t>(std::llround(t * 1e9));
    fix.p_b_a = {0.3, -0.4, -0.9};
    const Vector3d antenna = motion_.p(t) + motion_.q(t) * fix.p_b_a + draw(sigma);
    fix.antenna = frame_.to_geodetic(antenna);
    fix.position_covariance = sigma * sigma * Matrix3d::Identity();
    return fix;
  }

  /// Runs to `seconds` with a fix every second but in [outage_begin, outage_end).
  template <class Each>
  void run(measurement::Navigator& navigator, int seconds, double outage_begin, double outage_end,
           const Each& each) {
    constexpr int64_t kStep = 10'000'000;
    for (int second = 1; second <= seconds; ++second) {
      for (int64_t t = (second - 1) * 1'000'000'000LL; t < second * 1'000'000'000LL; t += kStep)
        navigator.propagate(noisy_increment(t, t + kStep));
      if (second >= outage_begin && second < outage_end)
        navigator.hold();
      else
        navigator.update(measurement::gnss_position(fix_at(second, 0.02)));
      each(second);
    }
  }

  state::NodeVector error(const state::Epoch& epoch) const {
    state::NodeState x;
    const Matrix3d R_w_n = frame_.R_w_n(epoch.position);
    x.p_w_b = frame_.to_local(epoch.position);
    x.v_w_b = R_w_n * epoch.velocity_n;
    x.q_w_b = Eigen::Quaterniond(R_w_n) * epoch.q_n_b;
    x.bias = epoch.bias;
    return state::boxminus(motion_.state(to_seconds_of(epoch)), x);
  }
  static double to_seconds_of(const state::Epoch& epoch) {
    return 1e-9 * static_cast<double>(epoch.t_ns);
  }

  geodesy::LocalFrame frame_;
  ClosedFormMotion motion_;
  std::mt19937 rng_{42};
  std::normal_distribution<double> normal_;
};

inline fgo::FgoOptions window_of(double seconds) {
  fgo::FgoOptions options;
  options.window_s = seconds;
  return options;
}

}  // namespace foucault::testing
