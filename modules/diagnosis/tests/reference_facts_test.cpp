#include "foucault/diagnosis/reference_facts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {
namespace {

GnssFix fix_at(double t, const Geodetic& position) {
  GnssFix fix;
  fix.t_ns = nanoseconds(t);
  fix.antenna = position;
  return fix;
}

TEST(ReferenceWatch, PosesBesideFixes) {
  const Geodetic origin{0.8, 0.2, 300};
  const geodesy::LocalFrame frame(origin);
  ReferenceWatch watch;
  const auto pose = [&](double t, double east) {
    ReferencePose pose;
    pose.t_ns = nanoseconds(t);
    pose.position = frame.to_geodetic({0, east, 0});
    watch.add(pose);
  };
  pose(0, 1);  // before any fix
  watch.add(fix_at(1, origin));
  pose(1.2, 40);
  pose(1.3, -250);
  pose(1.9, 2);  // too late to compare
  EXPECT_EQ(watch.facts().compared, 2);
  EXPECT_EQ(watch.facts().far, 1);
  EXPECT_NEAR(watch.facts().rms_m, std::hypot(40, 250) / std::sqrt(2), 0.1);
  ReferencePose bad;
  bad.t_ns = nanoseconds(1);
  bad.position.latitude = std::nan("");
  watch.add(bad);
  EXPECT_EQ(watch.facts().compared, 2);
  EXPECT_EQ(ReferenceWatch().facts().compared, 0);
}

/// An airliner is 125 m further half a second later, which says nothing of its reference.
TEST(ReferenceWatch, AMovingPoseIsComparedAtTheStampOfTheFix) {
  const Geodetic origin{0.8, 0.2, 300};
  const geodesy::LocalFrame frame(origin);
  const auto facts = [&](bool with_velocity) {
    ReferenceWatch watch;
    watch.add(fix_at(1, origin));
    ReferencePose pose;
    pose.t_ns = nanoseconds(1.5);
    pose.position = frame.to_geodetic({125, 0.8, 0});
    if (with_velocity) pose.velocity_n = Eigen::Vector3d(250, 0, 0);
    watch.add(pose);
    return watch.facts();
  };
  EXPECT_NEAR(facts(true).rms_m, 0.8, 0.01);
  EXPECT_TRUE(facts(true).moved);
  EXPECT_NEAR(facts(false).rms_m, 125, 0.1);
  EXPECT_FALSE(facts(false).moved);
}

}  // namespace
}  // namespace foucault::diagnosis
