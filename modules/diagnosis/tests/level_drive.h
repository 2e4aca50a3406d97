#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/wgs84.h"

namespace foucault::diagnosis {

/// A way over level ground that does not feel the Earth turn, in the order of its stamps.
struct LevelDrive {
  std::function<double(double)> speed = [](double) { return 10.0; };   ///< [m/s] at t [s]
  std::function<double(double)> heading = [](double) { return 0.0; };  ///< [rad]
  std::function<double(double)> crab = [](double) { return 0.0; };  ///< heading less course [rad]
  double bank = 0;                                                  ///< [rad], right down
  double seconds = 60;
  double fix_interval = 1;  ///< [s]
  double fix_sigma = 0.01;  ///< [m], each axis
  double accel_factor = 1, gyro_factor = 1;
  double accel_right_factor = 1;   ///< of the axis that looks right, beside accel_factor
  Eigen::Vector3d arm{0, 0, 0};    ///< IMU to antenna, which fixes tell [m]
  double untold_arm = 0;           ///< of the antenna ahead of it [m]
  bool is_track_mirrored = false;  ///< north and east are swapped
  double clock_fast = 0;           ///< [s/s], of the IMU's
  double imu_late = 0;             ///< [s] that stamps of the IMU are after those of GNSS

  static constexpr double kStep = 0.01;                                     // [s]
  static constexpr int64_t kStart = 1'600'000'000 * kNanosecondsPerSecond;  // at t = 0

  std::vector<Measurement> measurements() const {
    const Geodetic origin{0.7, 0.2, 100};
    const geodesy::LocalFrame frame(origin);
    const double gravity = geodesy::wgs84::normal_gravity(origin.latitude, origin.height);
    std::mt19937 rng{7};
    std::normal_distribution<double> normal(0, fix_sigma);
    std::vector<Measurement> out;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    const auto steps = static_cast<int64_t>(std::lround(seconds / kStep));
    const auto fix_steps = static_cast<int64_t>(std::lround(fix_interval / kStep));
    for (int64_t k = 0; k < steps; ++k) {
      const double t = kStep * static_cast<double>(k);
      if (k % fix_steps == 0) {
        GnssFix fix;
        fix.t_ns = kStart + nanoseconds(t);
        const Eigen::Vector3d error(normal(rng), normal(rng), normal(rng));
        Eigen::Vector3d antenna =
            p + attitude(t) * (arm + untold_arm * Eigen::Vector3d::UnitX()) + error;
        if (is_track_mirrored) std::swap(antenna.x(), antenna.y());
        fix.antenna = frame.to_geodetic(antenna);
        fix.p_b_a = arm;
        fix.position_covariance = fix_sigma * fix_sigma * Eigen::Matrix3d::Identity();
        out.emplace_back(fix);
      }
      const Eigen::Vector3d v0 = velocity(t), v1 = velocity(t + kStep);
      const Eigen::Quaterniond q0 = attitude(t), q1 = attitude(t + kStep);
      const Eigen::AngleAxisd turn(q0.conjugate() * q1);
      ImuIncrement increment;
      increment.t_begin_ns = kStart + nanoseconds(t * (1 + clock_fast) + imu_late);
      increment.t_end_ns = kStart + nanoseconds((t + kStep) * (1 + clock_fast) + imu_late);
      increment.dtheta_b = gyro_factor * turn.angle() * turn.axis();
      const Eigen::Vector3d dv = v1 - v0 - gravity * kStep * Eigen::Vector3d::UnitZ();
      increment.dvel_b = accel_factor * (attitude(t + kStep / 2).conjugate() * dv);
      increment.dvel_b.y() *= accel_right_factor;
      out.emplace_back(increment);
      p += kStep * velocity(t + kStep / 2);
    }
    std::stable_sort(out.begin(), out.end(), [](const Measurement& a, const Measurement& b) {
      return stamp(a) < stamp(b);
    });
    return out;
  }

  template <class Watch>
  void feed(Watch& watch) const {
    for (const Measurement& m : measurements()) {
      if (const auto* increment = std::get_if<ImuIncrement>(&m)) watch.add(*increment);
      if (const auto* fix = std::get_if<GnssFix>(&m)) watch.add(*fix);
    }
  }

 private:
  Eigen::Vector3d velocity(double t) const {
    return speed(t) * Eigen::Vector3d(std::cos(heading(t)), std::sin(heading(t)), 0);
  }
  Eigen::Quaterniond attitude(double t) const {
    return Eigen::AngleAxisd(heading(t) + crab(t), Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(bank, Eigen::Vector3d::UnitX());
  }
};

/// Bends to both sides, at 10 m/s and up to half a radian a second.
inline LevelDrive winding() {
  LevelDrive drive;
  drive.seconds = 200;
  drive.heading = [](double t) { return 0.8 * std::sin(0.31 * t) + 0.5 * std::sin(0.53 * t); };
  return drive;
}

/// Bends at speeds between 4 and 12 m/s.
inline LevelDrive town() {
  LevelDrive drive = winding();
  drive.seconds = 300;
  drive.speed = [](double t) { return 8 + 4 * std::sin(0.17 * t); };
  return drive;
}

/// Speeds up and slows down on a straight road.
inline LevelDrive surging() {
  LevelDrive drive;
  drive.seconds = 120;
  drive.speed = [](double t) { return 10 + 5 * std::sin(0.3 * t); };
  return drive;
}

/// An airplane that turns steadily at 6 g: 200 m/s, 58 m/s^2 to the side.
inline LevelDrive six_g_turn() {
  constexpr double kLoad = 6, kSpeed = 200, kGravity = 9.80;
  LevelDrive drive;
  const double side = kGravity * std::sqrt(kLoad * kLoad - 1);
  drive.speed = [](double) { return kSpeed; };
  drive.heading = [side](double t) { return side / kSpeed * t; };
  drive.bank = std::acos(1 / kLoad);
  drive.fix_sigma = 1;
  return drive;
}

}  // namespace foucault::diagnosis
