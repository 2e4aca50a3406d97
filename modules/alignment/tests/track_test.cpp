#include "../src/track.h"

#include <gtest/gtest.h>

#include "foucault/core/time.h"

namespace foucault::alignment {
namespace {

constexpr int64_t kMs = 1'000'000;

ImuIncrement increment(int64_t begin_ms, int64_t end_ms) {
  ImuIncrement result;
  result.t_begin_ns = begin_ms * kMs;
  result.t_end_ns = end_ms * kMs;
  const double dt = result.dt();
  result.dtheta_b = dt * Eigen::Vector3d(0.1, 0.2, 0.3);
  result.dvel_b = dt * Eigen::Vector3d(1, 2, -10);
  return result;
}

GnssFix fix_at(int64_t ms) {
  GnssFix fix;
  fix.t_ns = ms * kMs;
  return fix;
}

TEST(Track, MergesIncrementsAndCutsThemAtFixes) {
  Track track(100);
  for (int64_t ms = 0; ms < 1000; ms += 5) {
    if (ms == 500) track.add(fix_at(502));
    track.add(increment(ms, ms + 5));
  }
  double dt = 0;
  Eigen::Vector3d turned = Eigen::Vector3d::Zero();
  int64_t end_ns = 0;
  int increments = 0, fixes = 0;
  for (const Step& step : track.steps()) {
    if (const auto* inc = std::get_if<ImuIncrement>(&step)) {
      EXPECT_EQ(inc->t_begin_ns, end_ns);
      end_ns = inc->t_end_ns;
      dt += inc->dt();
      turned += inc->dtheta_b;
      ++increments;
    } else {
      EXPECT_EQ(end_ns, 502 * kMs);
      ++fixes;
    }
  }
  EXPECT_EQ(fixes, 1);
  EXPECT_LE(increments, 51);
  EXPECT_GT(dt, 0.97);
  EXPECT_LT((turned - dt * Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-12);
}

TEST(Track, GoesOnOverAHole) {
  Track track(100);
  track.add(increment(0, 20));
  const std::vector<Step> complete = track.add(increment(60, 80));
  ASSERT_EQ(complete.size(), 1u);
  const ImuIncrement& over = std::get<ImuIncrement>(complete[0]);
  EXPECT_EQ(over.t_begin_ns, 20 * kMs);
  EXPECT_NEAR(over.dvel_b.z(), -10 * 0.06, 1e-12);
}

TEST(Track, KeepsFiveFixesASecondAndForgetsWhatIsOld) {
  Track track(2);
  for (int64_t ms = 0; ms < 5000; ms += 10) {
    if (ms % 50 == 0) track.add(fix_at(ms + 5));
    track.add(increment(ms, ms + 10));
  }
  EXPECT_NEAR(static_cast<double>(track.begin_ns()) * 1e-9, 3, 0.05);
  EXPECT_NEAR(static_cast<double>(track.first_fixes(100).size()), 10, 1);
  EXPECT_GE(track.first_fixes(0.5, 4000 * kMs).front().t_ns, 4000 * kMs);
  EXPECT_NEAR(track.mean_force_b().y(), 2, 1e-9);
}

/// Those that the IMU has not seen are of no use.
TEST(Track, FixesBeforeTheImuAreLeftOut) {
  Track track(10);
  track.add(fix_at(0));
  track.add(fix_at(300));
  track.add(increment(250, 270));
  for (int64_t ms = 270; ms < 400; ms += 10) track.add(increment(ms, ms + 10));
  ASSERT_EQ(track.first_fixes(1).size(), 1u);
  EXPECT_EQ(track.first_fixes(1)[0].t_ns, 300 * kMs);
}

}  // namespace
}  // namespace foucault::alignment
