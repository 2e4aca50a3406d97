#include "foucault/diagnosis/gnss_options.h"

#include <gtest/gtest.h>

#include <limits>

namespace foucault::diagnosis {
namespace {

GnssFix fix(double sigma) {
  GnssFix fix;
  fix.antenna = {0.5, 0.1, 100};
  fix.position_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
  return fix;
}

TEST(GnssOptions, ScalesSigmasAndKeepsThemOffTheFloor) {
  GnssOptions options;
  options.sigma_scale = 2;
  options.sigma_floor_m = 0.5;
  EXPECT_DOUBLE_EQ(options.weighted(fix(1)).position_covariance(0, 0), 4);
  EXPECT_DOUBLE_EQ(options.weighted(fix(0.1)).position_covariance(2, 2), 0.25);
  EXPECT_TRUE(options.allows(fix(0)));
  EXPECT_FALSE(GnssOptions().allows(fix(0)));
}

TEST(GnssOptions, AllowsFromAQualityOn) {
  const std::pair<const char*, FixQuality> qualities[] = {
      {"any", FixQuality::unknown},
      {"single", FixQuality::single},
      {"differential", FixQuality::differential},
      {"ppp", FixQuality::ppp},
      {"float_rtk", FixQuality::float_rtk},
      {"fixed_rtk", FixQuality::fixed_rtk}};
  GnssFix given = fix(1);
  given.quality = FixQuality::ppp;
  for (const auto& [name, quality] : qualities) {
    GnssOptions options;
    options.min_quality = name;
    EXPECT_EQ(options.lowest_quality(), quality);
    EXPECT_EQ(options.allows(given), quality <= FixQuality::ppp) << name;
  }
}

TEST(GnssOptions, ACovarianceIsFiniteAndPositiveDefinite) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  EXPECT_TRUE(is_valid_covariance(covariance));
  covariance(0, 1) = covariance(1, 0) = 2;
  EXPECT_FALSE(is_valid_covariance(covariance));
  covariance(0, 1) = covariance(1, 0) = 0;
  covariance(2, 2) = 0;
  EXPECT_FALSE(is_valid_covariance(covariance));
  covariance(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_valid_covariance(covariance));
  GnssFix none = fix(1);
  none.antenna = {0, 0, 0};
  EXPECT_FALSE(GnssOptions().allows(none));
}

TEST(GnssOptions, KeysAreThoseOfTheConfiguration) {
  GnssOptions options;
  EXPECT_NE(describe_config(options).find("gate_false_alarm"), std::string::npos);
}

}  // namespace
}  // namespace foucault::diagnosis
