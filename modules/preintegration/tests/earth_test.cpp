#include "foucault/preintegration/earth.h"

#include <gtest/gtest.h>

#include "foucault/core/constants.h"

namespace foucault::preintegration {
namespace {

const geodesy::LocalFrame kFrame(Geodetic{48 * kDegree, 9 * kDegree, 300});
const Eigen::Vector3d kAway(20e3, -30e3, -500);

TEST(EarthModel, RefinedHasTheGravityOfTheOriginEverywhere) {
  const EarthModel earth = earth_model(PreintegrationModel::refined, kFrame, kAway);
  EXPECT_EQ(earth.omega_ie_w, kFrame.earth_rate_w());
  EXPECT_EQ(earth.gravity(kAway), kFrame.gravity_w());
  EXPECT_EQ(earth.gravity({0, 0, 0}), kFrame.gravity_w());
}

TEST(EarthModel, RoughDoesNotTurnAndIsElseTheSame) {
  const EarthModel earth = earth_model(PreintegrationModel::rough, kFrame, kAway);
  EXPECT_EQ(earth.omega_ie_w, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(earth.gravity(kAway), kFrame.gravity_w());
}

TEST(EarthModel, FullHasTheGravityOfThePlaceAndAround) {
  const EarthModel earth = earth_model(PreintegrationModel::full, kFrame, kAway);
  EXPECT_EQ(earth.omega_ie_w, kFrame.earth_rate_w());
  EXPECT_EQ(earth.gravity(kAway), kFrame.gravity_w(kAway));
  const Eigen::Vector3d near = kAway + Eigen::Vector3d(300, 200, -100);
  // The second order of gravity, 3 g (d / R)^2, is 1e-7 m/s^2 there; without a gradient 6e-4.
  EXPECT_LT((earth.gravity(near) - kFrame.gravity_w(near)).norm(), 2e-7);
  EXPECT_GT((earth.g_w - kFrame.gravity_w(near)).norm(), 4e-4);
}

}  // namespace
}  // namespace foucault::preintegration
