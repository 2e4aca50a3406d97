#include "foucault/geodesy/local_frame.h"

#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/NormalGravity.hpp>
#include <cmath>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/wgs84.h"

namespace foucault::geodesy {
namespace {

Geodetic degrees(double latitude, double longitude, double height) {
  return {latitude * kDegree, longitude * kDegree, height};
}

const std::vector<Eigen::Vector3d> kOrigins{{0, 0, 0},       {30.5, 114.3, 23},     {-35, 149, 700},
                                            {52, 180, 1500}, {89.999, -70, 10e3},   {90, 0, -500},
                                            {-90, 45, 2800}, {60, -179.99999, 20e3}};

/// East, north, up offsets in degrees and metres: from a step to the other end of a country.
const std::vector<Eigen::Vector3d> kOffsets{
    {0, 0, 0}, {1e-8, 2e-8, 0.001}, {0.01, -0.02, 30}, {-1, 2, 9000}, {5, 5, -400}};

TEST(LocalFrame, AgreesWithGeographicLib) {
  for (const Eigen::Vector3d& o : kOrigins) {
    const LocalFrame frame(degrees(o[0], o[1], o[2]));
    const GeographicLib::LocalCartesian reference(o[0], o[1], o[2]);
    for (const Eigen::Vector3d& d : kOffsets) {
      const double lat = std::clamp(o[0] + d[0], -90.0, 90.0);
      const double lon = o[1] + d[1];
      const double height = o[2] + d[2];
      double east = 0, north = 0, up = 0;
      reference.Forward(lat, lon, height, east, north, up);
      const Eigen::Vector3d p_w = frame.to_local(degrees(lat, lon, height));
      // Differences of numbers near 6.4e6, each good to 1 nm, on both sides.
      EXPECT_LT((p_w - Eigen::Vector3d(north, east, -up)).norm(), 1e-8) << o << "\n" << d;
    }
  }
}

TEST(LocalFrame, BackIsTheInverse) {
  for (const Eigen::Vector3d& o : kOrigins) {
    const LocalFrame frame(degrees(o[0], o[1], o[2]));
    for (const Eigen::Vector3d& p_w : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(10, -20, 3),
                                       Eigen::Vector3d(-3e4, 5e4, -8e3)}) {
      const Eigen::Vector3d back = frame.to_local(frame.to_geodetic(p_w));
      EXPECT_LT((back - p_w).norm(), 1e-8) << o << "\n" << p_w;
    }
  }
}

TEST(LocalFrame, OriginIsZeroAndUnturned) {
  const LocalFrame frame(degrees(45, -180, 100));
  EXPECT_EQ(frame.to_local(frame.origin()), Eigen::Vector3d::Zero());
  EXPECT_LT((frame.R_w_n(frame.origin()) - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
            1e-15);
  EXPECT_NEAR(frame.to_geodetic(Eigen::Vector3d::Zero()).longitude, kPi, 1e-15);
}

TEST(LocalFrame, GoesAcrossThe180DegreeMeridian) {
  const LocalFrame frame(degrees(52, 179.9999, 0));
  const Eigen::Vector3d p_w = frame.to_local(degrees(52, -179.9999, 0));
  EXPECT_NEAR(p_w.y(),
              0.0002 * kDegree * wgs84::transverse_radius(52 * kDegree) * std::cos(52 * kDegree),
              1e-6);
  EXPECT_NEAR(frame.to_geodetic(p_w).longitude, -179.9999 * kDegree, 1e-14);
}

TEST(LocalFrame, TurnsNedOfAPlaceIntoW) {
  const LocalFrame frame(degrees(48, 11, 500));
  const Geodetic place = degrees(48.7, 12.5, 900);
  // A metre up at the place, seen from the origin.
  const Geodetic higher = degrees(48.7, 12.5, 901);
  const Eigen::Vector3d up_w = frame.to_local(higher) - frame.to_local(place);
  EXPECT_LT((frame.R_w_n(place) * Eigen::Vector3d(0, 0, -1) - up_w).norm(), 1e-8);
}

TEST(LocalFrame, EarthRateIsTheSameAxisEverywhere) {
  const LocalFrame frame(degrees(48, 11, 500));
  const Geodetic place = degrees(-20, 80, 0);
  const Eigen::Vector3d turned = frame.R_w_n(place) * wgs84::earth_rate_n(place.latitude);
  EXPECT_LT((turned - frame.earth_rate_w()).norm(), 1e-19);
  EXPECT_EQ(frame.earth_rate_w().y(), 0);  // paper (10)
}

TEST(NedOffset, IsMetresAlongTheHorizonAndHeights) {
  const Geodetic from = degrees(52, 179.9999, 100);
  Geodetic to = from;
  to.latitude += 100 / (wgs84::meridian_radius(from.latitude) + 100);
  to.longitude = so3::wrap(from.longitude + 50 / ((wgs84::transverse_radius(from.latitude) + 100) *
                                                  std::cos(from.latitude)));
  to.height = 97;
  // Radii instead of the horizon: 100 m * 100 m / R, and 3 m of height on 6400 km.
  EXPECT_LT((ned_offset(from, to) - Eigen::Vector3d(100, 50, 3)).norm(), 3e-3);
  EXPECT_EQ(ned_offset(from, to).z(), 3);
  EXPECT_EQ(ned_offset(from, from), Eigen::Vector3d::Zero());
}

TEST(LocalFrame, GravityAtTheOriginPointsDown) {
  const LocalFrame frame(degrees(30.5, 114.3, 23));
  EXPECT_EQ(frame.gravity_w().x(), 0);
  EXPECT_EQ(frame.gravity_w().y(), 0);
  EXPECT_LT((frame.gravity_w(Eigen::Vector3d::Zero()) - frame.gravity_w()).norm(), 1e-13);
}

TEST(LocalFrame, GravityTurnsWithThePlace) {
  const LocalFrame frame(degrees(30.5, 114.3, 23));
  const Eigen::Vector3d north = frame.gravity_w({1000, 0, 0});
  // 1 km north the plumb line leans back by 1 km / M = 0.157 mrad.
  const double lean = 1000 / (wgs84::meridian_radius(30.5 * kDegree) + 23);
  EXPECT_NEAR(-north.x() / north.z(), lean, 1e-9);
  EXPECT_NEAR(lean, 0.157e-3, 0.001e-3);
}

TEST(LocalFrame, GravityGradientIsTheDerivativeOfGravity) {
  const LocalFrame frame(degrees(30.5, 114.3, 23));
  constexpr double kStep = 100;  // [m]
  for (const Geodetic& place : {degrees(30.5, 114.3, 23), degrees(32, 117, 10000),
                                degrees(-70, -120, 300), degrees(89, 10, 0)}) {
    const Eigen::Vector3d p_w = frame.to_local(place);
    Eigen::Matrix3d differences;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
      differences.col(i) =
          (frame.gravity_w(p_w + step) - frame.gravity_w(p_w - step)) / (2 * kStep);
    }
    // Of 1.5e-6 / s^2; near the pole north turns, and the differences are of second order.
    EXPECT_LT((frame.gravity_gradient_w(p_w) - differences).norm(), 1e-14);
  }
}

TEST(LocalFrame, GravityVectorAgreesWithGeographicLib) {
  const Geodetic origin = degrees(30.5, 114.3, 23);
  const LocalFrame frame(origin);
  for (const Geodetic& place :
       {degrees(30.5, 114.3, 3000), degrees(31.2, 113, 400), degrees(28, 118, 20)}) {
    Eigen::Vector3d g_e;
    const Eigen::Vector3d p_e = wgs84::geodetic_to_ecef(place);
    GeographicLib::NormalGravity::WGS84().U(p_e.x(), p_e.y(), p_e.z(), g_e.x(), g_e.y(), g_e.z());
    const Eigen::Vector3d expected =
        wgs84::R_e_n(origin.latitude, origin.longitude).transpose() * g_e;
    // The plumb line's curvature is left out: 8.2e-9 1/s^2 times height, plus 1e-8 of magnitude.
    EXPECT_LT((frame.gravity_w(frame.to_local(place)) - expected).norm(),
              2e-8 + 8.2e-9 * place.height);
  }
}

}  // namespace
}  // namespace foucault::geodesy
