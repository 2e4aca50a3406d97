#include "foucault/geodesy/wgs84.h"

#include <gtest/gtest.h>

#include <GeographicLib/Ellipsoid.hpp>
#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/NormalGravity.hpp>
#include <algorithm>
#include <cmath>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"

namespace foucault::geodesy::wgs84 {
namespace {

const std::vector<double> kLatitudesDeg{-90,  -89.999999, -89.9, -60, -45,  -1e-7,       0, 1e-3,
                                        30.5, 45,         52.4,  80,  89.9, 89.99999999, 90};
const std::vector<double> kLongitudesDeg{-179.9999999, -120, -90,   -0.25, 0,
                                         9.7,          90,   114.3, 179.5, 180};
const std::vector<double> kHeights{-500, 0, 21.5, 1500, 9000, 20e3, 100e3};

Eigen::Vector3d geographiclib_ecef(double latitude_deg, double longitude_deg, double height) {
  Eigen::Vector3d p;
  GeographicLib::Geocentric::WGS84().Forward(latitude_deg, longitude_deg, height, p.x(), p.y(),
                                             p.z());
  return p;
}

template <class Body>
void for_places(Body body) {
  for (const double lat : kLatitudesDeg) {
    for (const double lon : kLongitudesDeg) {
      for (const double h : kHeights) {
        SCOPED_TRACE(testing::Message() << lat << " " << lon << " " << h);
        body(lat, lon, h);
      }
    }
  }
}

TEST(Wgs84, EcefAgreesWithGeographicLib) {
  for_places([](double lat, double lon, double h) {
    const Eigen::Vector3d p = geodetic_to_ecef({lat * kDegree, lon * kDegree, h});
    // 4 nm: two roundings of numbers near 6.4e6 a coordinate, and the angles' conversion.
    EXPECT_LT((p - geographiclib_ecef(lat, lon, h)).norm(), 4e-9);
  });
}

TEST(Wgs84, GeodeticAgreesWithGeographicLib) {
  for_places([](double lat, double lon, double h) {
    const Geodetic place = ecef_to_geodetic(geographiclib_ecef(lat, lon, h));
    EXPECT_NEAR(place.height, h, 4e-9);
    EXPECT_NEAR((place.latitude - lat * kDegree) * kSemiMajorAxis, 0, 4e-9);
    const double east = so3::wrap(place.longitude - lon * kDegree) * std::cos(lat * kDegree);
    EXPECT_NEAR(east * kSemiMajorAxis, 0, 4e-9);
    EXPECT_GT(place.longitude, -kPi);
    EXPECT_LE(place.longitude, kPi);
  });
}

TEST(Wgs84, GeodeticAtExactPolesAndAxes) {
  const double b = kSemiMajorAxis * (1 - kFlattening);
  const Geodetic north = ecef_to_geodetic({0, 0, b + 100});
  EXPECT_EQ(north.latitude, kPi / 2);
  EXPECT_NEAR(north.height, 100, 2e-9);
  const Geodetic south = ecef_to_geodetic({0, 0, -b - 100});
  EXPECT_EQ(south.latitude, -kPi / 2);
  EXPECT_NEAR(south.height, 100, 2e-9);
  EXPECT_EQ(ecef_to_geodetic({-kSemiMajorAxis, -0.0, 0}).longitude, kPi);
}

TEST(Wgs84, GeodeticIsExactHighAboveToo) {
  for (const double height : {1e6, 2e7, 4e8}) {
    const Geodetic place = ecef_to_geodetic(geographiclib_ecef(47, 11, height));
    EXPECT_NEAR(place.latitude, 47 * kDegree, 4e-16);
    EXPECT_NEAR(place.height / height, 1, 1e-14);
  }
}

TEST(Wgs84, NorthEastDownAreTheDerivativesOfPosition) {
  constexpr double d = 1e-6;  // rad; differences of 6 m, so 1e-9 m of rounding is 2e-10
  for_places([](double lat_deg, double lon_deg, double h) {
    const double lat = lat_deg * kDegree;
    const double lon = lon_deg * kDegree;
    const Eigen::Matrix3d R = R_e_n(lat, lon);
    EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_NEAR(R.determinant(), 1, 1e-15);
    const Eigen::Vector3d by_lat =
        (geodetic_to_ecef({lat + d, lon, h}) - geodetic_to_ecef({lat - d, lon, h})) / (2 * d);
    const Eigen::Vector3d by_lon =
        (geodetic_to_ecef({lat, lon + d, h}) - geodetic_to_ecef({lat, lon - d, h})) / (2 * d);
    const Eigen::Vector3d by_height =
        (geodetic_to_ecef({lat, lon, h + 50}) - geodetic_to_ecef({lat, lon, h - 50})) / 100;
    EXPECT_LT((by_lat / (meridian_radius(lat) + h) - R.col(0)).norm(), 1e-9);
    EXPECT_LT((by_lon - (transverse_radius(lat) + h) * std::cos(lat) * R.col(1)).norm(), 6e-3);
    EXPECT_LT((by_height + R.col(2)).norm(), 1e-10);
  });
}

TEST(Wgs84, RadiiAgreeWithGeographicLib) {
  const GeographicLib::Ellipsoid& ellipsoid = GeographicLib::Ellipsoid::WGS84();
  for (const double lat : kLatitudesDeg) {
    EXPECT_NEAR(meridian_radius(lat * kDegree), ellipsoid.MeridionalCurvatureRadius(lat), 1e-8);
    EXPECT_NEAR(transverse_radius(lat * kDegree), ellipsoid.TransverseCurvatureRadius(lat), 1e-8);
  }
}

double exact_gravity(double latitude_deg, double height) {
  double north = 0;
  double up = 0;
  GeographicLib::NormalGravity::WGS84().Gravity(latitude_deg, height, north, up);
  return std::hypot(north, up);
}

TEST(Wgs84, NormalGravityAgreesWithGeographicLib) {
  for (const double lat : kLatitudesDeg) {
    // What the formula leaves out, with g the value on the ellipsoid: 4 f^2 in the factor of
    // 2 g h/a, flattening in 3 g (h/a)^2, and 4 g (h/a)^3. At 1 km 1e-7, at 20 km 3e-6 m/s^2. The
    // tabulated gamma_e and k are good to 1e-10.
    for (const double h : {-500.0, 0.0, 100.0, 1500.0, 9000.0, 20e3}) {
      const double r = std::abs(h) / kSemiMajorAxis;
      const double f = kFlattening;
      const double tolerance = 1e-9 + 9.9 * (8 * f * f * r + 6 * f * r * r + 4 * r * r * r);
      EXPECT_NEAR(normal_gravity(lat * kDegree, h), exact_gravity(lat, h), tolerance)
          << lat << " " << h;
    }
  }
}

TEST(Wgs84, NormalGravityHasTheKnownValues) {
  EXPECT_NEAR(normal_gravity(0, 0), 9.7803253359, 1e-12);
  EXPECT_NEAR(normal_gravity(kPi / 2, 0), 9.8321849378, 2e-10);  // TR8350.2 table 3.4
}

TEST(Wgs84, EarthRateIsTheAxisOfTheEarth) {
  for (const double lat : {-1.2, 0.0, 0.7}) {
    const Eigen::Vector3d rate_e = R_e_n(lat, 2.1) * earth_rate_n(lat);
    EXPECT_LT((rate_e - Eigen::Vector3d(0, 0, kEarthRate)).norm(), 1e-19);
  }
}

}  // namespace
}  // namespace foucault::geodesy::wgs84
