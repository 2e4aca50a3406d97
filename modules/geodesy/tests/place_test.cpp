#include "foucault/geodesy/place.h"

#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/wgs84.h"

namespace foucault::geodesy {
namespace {

const Geodetic kHere{-52 * kDegree, 179.999999 * kDegree, 8000};
const Eigen::Vector3d kVelocity(180, -120, 7);

Eigen::Matrix3d R_e_n(const Geodetic& position) {
  return wgs84::R_e_n(position.latitude, position.longitude);
}

TEST(Place, TransportRateIsHowNedTurnsOnTheWay) {
  constexpr double kStep = 1;  // [s]
  const Place place(kHere);
  const Geodetic ahead = displaced(kHere, kStep * kVelocity, place);
  const Geodetic behind = displaced(kHere, -kStep * kVelocity, place);
  const Eigen::Quaterniond turned(R_e_n(behind).transpose() * R_e_n(ahead));
  const Eigen::Vector3d rate = so3::log(turned) / (2 * kStep);
  // The radii change by 1e-5 within 200 m.
  EXPECT_LT((rate - place.omega_en_n(kVelocity)).norm(), 1e-5 * rate.norm());
}

/// Along a free fall, in Cartesian coordinates of the turning Earth.
TEST(Place, FreeAccelerationIsThatOfAFallSeenFromNed) {
  constexpr double kStep = 0.1;  // [s]
  const Place place(kHere);
  const Eigen::Vector3d p_e = wgs84::geodetic_to_ecef(kHere);
  const Eigen::Vector3d v_e = R_e_n(kHere) * kVelocity;
  const Eigen::Vector3d gravity_e = R_e_n(kHere) * Eigen::Vector3d(0, 0, place.gravity);
  const Eigen::Vector3d a_e = gravity_e - 2 * Eigen::Vector3d(0, 0, wgs84::kEarthRate).cross(v_e);
  const auto velocity_n = [&](double t) -> Eigen::Vector3d {
    const Geodetic there = wgs84::ecef_to_geodetic(p_e + t * v_e + 0.5 * t * t * a_e);
    return R_e_n(there).transpose() * (v_e + t * a_e);
  };
  const Eigen::Vector3d acceleration = (velocity_n(kStep) - velocity_n(-kStep)) / (2 * kStep);
  // A step of third order, v^3 dt^2 / R^2, and nanometres of rounding over 0.1 s.
  EXPECT_LT((acceleration - place.free_acceleration_n(kVelocity)).norm(), 1e-7);
  EXPECT_GT((acceleration - Eigen::Vector3d(0, 0, place.gravity)).norm(), 1e-2);
}

TEST(Place, DisplacedIsMetresAlongTheEllipsoid) {
  const Place place(kHere);
  const Eigen::Vector3d d(3, 4, -2);
  const Geodetic there = displaced(kHere, d, place);
  EXPECT_LT(there.longitude, 0);  // over the date line
  const Eigen::Vector3d way_e = wgs84::geodetic_to_ecef(there) - wgs84::geodetic_to_ecef(kHere);
  // 25 m^2 / 2R is 2 um, latitudes and heights change the radii by as much.
  EXPECT_LT((R_e_n(kHere).transpose() * way_e - d).norm(), 5e-6);
  EXPECT_LT((displacement_n(kHere, there, place) - d).norm(), 1e-8);
}

}  // namespace
}  // namespace foucault::geodesy
