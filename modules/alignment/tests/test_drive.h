#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/measurement.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"

namespace foucault::testing {

/// A drive in the plane of w, known in closed form: speed and heading over time, level vehicle.
struct Drive {
  std::function<double(double)> speed = [](double) { return 0.0; };         ///< [m/s]
  std::function<double(double)> heading = [](double) { return 0.7; };       ///< [rad]
  std::function<double(double)> acceleration = [](double) { return 0.0; };  ///< of speed [m/s^2]
  std::function<double(double)> turn_rate = [](double) { return 0.0; };     ///< of heading [rad/s]
  double duration = 60;                                                     ///< [s]
};

/// Rest, straight acceleration, cruise, then turns to both sides.
inline Drive rest_and_drive(double rest_s, double heading, double acceleration = 1.5,
                            double cruise = 12) {
  const double ramp = cruise / acceleration;
  const double turn_at = rest_s + ramp + 8, rate = 15 * kDegree;
  Drive drive;
  drive.speed = [=](double t) { return std::clamp(acceleration * (t - rest_s), 0.0, cruise); };
  drive.acceleration = [=](double t) {
    return t > rest_s && t < rest_s + ramp ? acceleration : 0.0;
  };
  drive.heading = [=](double t) { return heading + rate * std::clamp(t - turn_at, 0.0, 6.0); };
  drive.turn_rate = [=](double t) { return t > turn_at && t < turn_at + 6 ? rate : 0.0; };
  drive.duration = turn_at + 20;
  return drive;
}

struct Sensors {
  Eigen::Quaterniond q_v_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d lever_v = Eigen::Vector3d(0.4, -0.3, -1.2);  ///< IMU to antenna, FRD [m]
  state::ImuBias bias;
  double gyro_density = 0, accel_density = 0;
  double gnss_sigma = 0.01;  ///< [m]
  bool gnss_noise = true;
  double gnss_interval = 1;  ///< [s]
  std::optional<double> velocity_sigma;
  unsigned seed = 42;
  /// Changes a fix before it is given out (quality, offsets).
  std::function<void(double, GnssFix&)> spoil = [](double, GnssFix&) {};
};

/// The true state of the IMU.
struct Truth {
  Geodetic position;
  Eigen::Vector3d velocity_n;
  Eigen::Quaterniond q_n_b;
};

/// The ordered stream of a drive, and the truth at any increment's end.
class DriveSimulator {
 public:
  static constexpr int64_t kStart = 1'700'000'000'000'000'000;
  static constexpr int64_t kStep = 10'000'000;  ///< [ns]

  DriveSimulator(const Drive& drive, const Sensors& sensors) : drive_(drive), sensors_(sensors) {
    run();
  }

  const std::vector<Measurement>& stream() const { return stream_; }

  Truth truth(int64_t t_ns) const {
    const std::size_t i = static_cast<std::size_t>((t_ns - kStart) / kStep);
    const Eigen::Vector3d p = positions_.at(i);
    const double t = seconds_between(kStart, t_ns);
    const Geodetic place = frame_.to_geodetic(p);
    const Eigen::Matrix3d R_n_w = frame_.R_w_n(place).transpose();
    return {place, R_n_w * velocity(t), Eigen::Quaterniond(R_n_w) * attitude(t) * sensors_.q_v_b};
  }

 private:
  Eigen::Vector3d forward(double t) const {
    return {std::cos(drive_.heading(t)), std::sin(drive_.heading(t)), 0};
  }
  Eigen::Vector3d velocity(double t) const { return drive_.speed(t) * forward(t); }
  Eigen::Quaterniond attitude(double t) const { return so3::from_euler({0, 0, drive_.heading(t)}); }

  /// Rates that an ideal sensor on b feels.
  void add_rates(double t, const Eigen::Vector3d& p, double dt, ImuIncrement& sum) const {
    const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(forward(t));
    const Eigen::Vector3d a =
        drive_.acceleration(t) * forward(t) + drive_.speed(t) * drive_.turn_rate(t) * right;
    const Eigen::Vector3d f_w =
        a + 2 * frame_.earth_rate_w().cross(velocity(t)) - frame_.gravity_w(p);
    const Eigen::Vector3d w_w = frame_.earth_rate_w() + Eigen::Vector3d(0, 0, drive_.turn_rate(t));
    const Eigen::Quaterniond q_b_w = (attitude(t) * sensors_.q_v_b).conjugate();
    sum.dtheta_b += dt * (q_b_w * w_w);
    sum.dvel_b += dt * (q_b_w * f_w);
  }

  Eigen::Vector3d noise(double sigma) {
    return sigma * Eigen::Vector3d(normal_(rng_), normal_(rng_), normal_(rng_));
  }

  void run() {
    rng_.seed(sensors_.seed);
    const int64_t steps = static_cast<int64_t>(drive_.duration * 100);
    const int64_t fix_steps = std::llround(sensors_.gnss_interval * 100);
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    positions_.push_back(p);
    add_fix(0, p);
    for (int64_t step = 0; step < steps; ++step) {
      ImuIncrement increment;
      increment.t_begin_ns = kStart + step * kStep;
      increment.t_end_ns = increment.t_begin_ns + kStep;
      constexpr int kParts = 4;  // midpoints: 1e-7 of an increment at these turn rates
      const double h = increment.dt() / kParts;
      for (int part = 0; part < kParts; ++part) {
        const double t = 0.01 * static_cast<double>(step) + (part + 0.5) * h;
        add_rates(t, p, h, increment);
        p += h * velocity(t);
      }
      positions_.push_back(p);
      const double dt = increment.dt();
      increment.dtheta_b += sensors_.bias.gyro * dt + noise(sensors_.gyro_density * std::sqrt(dt));
      increment.dvel_b += sensors_.bias.accel * dt + noise(sensors_.accel_density * std::sqrt(dt));
      if ((step + 1) % fix_steps == 0) add_fix(step + 1, p);
      stream_.push_back(increment);
    }
  }

  void add_fix(int64_t step, const Eigen::Vector3d& p) {
    const double t = 0.01 * static_cast<double>(step);
    GnssFix fix;
    fix.t_ns = kStart + step * kStep;
    const double sigma = sensors_.gnss_sigma;
    const Eigen::Vector3d antenna = p + attitude(t) * sensors_.lever_v;
    const Eigen::Vector3d error = sensors_.gnss_noise ? noise(sigma) : Eigen::Vector3d::Zero();
    fix.antenna = frame_.to_geodetic(antenna + error);
    fix.position_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    if (sensors_.velocity_sigma) {
      const double sv = *sensors_.velocity_sigma;
      const Eigen::Vector3d swing =
          Eigen::Vector3d(0, 0, drive_.turn_rate(t)).cross(attitude(t) * sensors_.lever_v);
      fix.velocity_n = velocity(t) + swing + noise(sv);
      fix.velocity_covariance = sv * sv * Eigen::Matrix3d::Identity();
    }
    fix.quality = FixQuality::fixed_rtk;
    fix.p_b_a = sensors_.q_v_b.conjugate() * sensors_.lever_v;
    sensors_.spoil(t, fix);
    stream_.push_back(fix);
  }

  Drive drive_;
  Sensors sensors_;
  geodesy::LocalFrame frame_{Geodetic{48 * kDegree, 9 * kDegree, 300}};
  std::mt19937 rng_;
  std::normal_distribution<double> normal_;
  std::vector<Eigen::Vector3d> positions_;  ///< of the IMU in w, a step apart
  std::vector<Measurement> stream_;
};

}  // namespace foucault::testing
