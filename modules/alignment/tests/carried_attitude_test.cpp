#include "../src/carried_attitude.h"

#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/wgs84.h"

namespace foucault::alignment {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kLatitude = 48 * kDegree;
const Vector3d kBias(2e-3, -1e-3, 3e-3);

/// An IMU mounted askew, at rest and then in a car that turns and brakes.
class CarriedAttitudeTest : public ::testing::Test {
 protected:
  CarriedAttitudeTest() {
    RestMeans means;
    means.end_ns = 10 * kNanosecondsPerSecond;
    means.accel_b = q_n_b_.conjugate() * Vector3d(0, 0, -9.8);
    means.gyro_b = q_n_b_.conjugate() * earth_n_ + kBias;
    carried_.rest(means, kLatitude, noise_);
  }

  /// Turns and accelerates for some seconds.
  void drive(double seconds, double turn_rate, double forward_acceleration) {
    for (int k = 0; k < std::lround(seconds * 100); ++k) {
      const Quaterniond q_n_v = q_n_b_ * q_v_b_.conjugate();
      const Vector3d rate_b = q_n_b_.conjugate() * (earth_n_ + Vector3d(0, 0, turn_rate)) + kBias;
      ImuIncrement increment;
      increment.t_end_ns = 10'000'000;
      increment.dtheta_b = 0.01 * rate_b;
      const Quaterniond q_mid_b = so3::exp(Vector3d(0, 0, 0.005 * turn_rate)) * q_n_b_;
      const Vector3d force_n = q_n_v * Vector3d(forward_acceleration, 0, 0);
      increment.dvel_b = 0.01 * (q_mid_b.conjugate() * (force_n - Vector3d(0, 0, 9.8)));
      carried_.add(increment);
      q_n_b_ = so3::exp(Vector3d(0, 0, 0.01 * turn_rate)) * q_n_b_;
    }
  }

  double azimuth_l() const {
    const LevelAttitude& attitude = carried_.attitude();
    return geodesy::azimuth(attitude.q_l_b * attitude.forward_b);
  }

  imu::ImuNoise noise_ = imu::imu_preset("ADIS16465");
  Vector3d earth_n_ = geodesy::wgs84::earth_rate_n(kLatitude);
  Quaterniond q_v_b_ = so3::from_euler({0.3, -0.2, 1});
  Quaterniond q_n_b_ = so3::from_euler({0, 0, 0.7}) * q_v_b_;
  CarriedAttitude carried_{q_v_b_.conjugate() * Vector3d::UnitX()};
};

TEST_F(CarriedAttitudeTest, ARestLeavesItLevelAtAzimuthZero) {
  EXPECT_NEAR(azimuth_l(), 0, 1e-12);
  const Vector3d down_b = q_n_b_.conjugate() * Vector3d::UnitZ();
  EXPECT_LT((carried_.attitude().q_l_b * down_b - Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_FALSE(carried_.reverses());
}

TEST_F(CarriedAttitudeTest, FollowsTheGyroscopesLessBiasAndEarth) {
  drive(20, 0.1, 0);
  EXPECT_NEAR(carried_.since_rest(), 20, 1e-9);
  // What is horizontal of the Earth's rate counted as bias turns with the vehicle: 5e-5 rad/s.
  EXPECT_NEAR(azimuth_l(), 2, 2e-3);
  EXPECT_NEAR(carried_.attitude().omega_b.dot(q_n_b_.conjugate() * Vector3d::UnitZ()), 0.1, 1e-4);
  const double white = std::pow(noise_.gyro_noise_density, 2);
  EXPECT_NEAR(carried_.drift_variance(), white / 10 * 400 + white * 20 + std::pow(0.003 * 2, 2),
              1e-6);
}

TEST_F(CarriedAttitudeTest, KnowsForHalfAMinuteThatItReverses) {
  drive(2, 0, 1.0);
  EXPECT_FALSE(carried_.reverses());
  drive(4, 0, -1.0);
  EXPECT_TRUE(carried_.reverses());
  drive(25, 0, 0);
  EXPECT_FALSE(carried_.reverses()) << "after 30 s it is not to be believed";
}

}  // namespace
}  // namespace foucault::alignment
