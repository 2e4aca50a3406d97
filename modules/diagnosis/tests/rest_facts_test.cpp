#include "foucault/diagnosis/rest_facts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "level_drive.h"

namespace foucault::diagnosis {
namespace {

LevelDrive standing(double sigma, double seconds) {
  LevelDrive drive;
  drive.speed = [](double) { return 0.0; };
  drive.fix_sigma = sigma;
  drive.seconds = seconds;
  return drive;
}

/// Three seconds pass before the fourth is known to be one of rest.
TEST(RestWatch, CountsSecondsAtRestAndTheirMean) {
  RestWatch watch;
  for (const Measurement& m : standing(0.1, 30.5).measurements()) {
    if (const auto* fix = std::get_if<GnssFix>(&m)) watch.add(*fix);
    if (auto increment = m; auto* i = std::get_if<ImuIncrement>(&increment)) {
      i->dtheta_b.y() -= 0.002 * i->dt();
      watch.add(*i);
    }
  }
  const RestFacts facts = watch.facts();
  EXPECT_EQ(facts.seconds, 27);
  EXPECT_NEAR(facts.gyro_mean, 0.002, 1e-9);
  EXPECT_NEAR(facts.gyro_noise_density, 0, 1e-9);
  EXPECT_NEAR(facts.accel_noise_density, 0, 1e-9);
}

/// White fixes: the median of a Rayleigh distribution, 27 of them.
TEST(RestWatch, FixesScatterAsTheirSigmasSay) {
  RestWatch watch;
  standing(0.1, 400).feed(watch);
  EXPECT_GT(watch.facts().fix_pairs, 380);
  EXPECT_NEAR(watch.facts().fix_scatter, 1, 0.15);  // 1.25 * 0.8 / sqrt(390): 3 sigmas
}

TEST(RestWatch, OutliersAreNoScatter) {
  RestWatch watch;
  int fixes = 0;
  for (Measurement& m : standing(0.01, 200).measurements()) {
    if (auto* fix = std::get_if<GnssFix>(&m)) {
      if (++fixes % 10 == 5) fix->antenna.latitude += 20 / 6.4e6;
      watch.add(*fix);
    } else if (const auto* i = std::get_if<ImuIncrement>(&m)) {
      watch.add(*i);
    }
  }
  EXPECT_GT(watch.facts().seconds, 50);
  EXPECT_LT(watch.facts().fix_scatter, 2);
}

TEST(RestWatch, AMovingVehicleIsNotAtRest) {
  RestWatch watch;
  LevelDrive().feed(watch);  // straight and steady: only the fixes move
  EXPECT_EQ(watch.facts().seconds, 0);
  EXPECT_EQ(watch.facts().gyro_mean, 0);
  RestWatch winding_watch;
  winding().feed(winding_watch);
  EXPECT_EQ(winding_watch.facts().seconds, 0);
}

/// Honest sigmas against which the way from a fix to the next is short: 14 m/s at 10 Hz, with 0.06
/// and 1.5 m. Scatter about a mean is not a way that grows.
TEST(RestWatch, ASteadyDriveIsNoRestHoweverLargeTheSigmas) {
  for (const double sigma : {0.06, 0.3, 1.5}) {
    for (const double interval : {0.1, 0.2, 1.0}) {
      LevelDrive drive;
      drive.speed = [](double) { return 14.0; };
      drive.seconds = 100;
      drive.fix_sigma = sigma;
      drive.fix_interval = interval;
      RestWatch watch;
      drive.feed(watch);
      EXPECT_EQ(watch.facts().seconds, 0) << sigma << " m, " << interval << " s";
    }
  }
}

/// Between drives, told by fixes of 1.5 m: nothing but the rest, and all of it.
TEST(RestWatch, AStopAmidADrive) {
  LevelDrive drive;
  drive.speed = [](double t) { return 10 * std::max(0.0, std::abs(t - 60) / 20 - 1); };
  drive.seconds = 120;
  drive.fix_sigma = 1.5;
  RestWatch watch;
  drive.feed(watch);
  EXPECT_NEAR(watch.facts().seconds, 37, 2);       // of 40, three to know it
  EXPECT_NEAR(watch.facts().fix_scatter, 1, 0.6);  // of some 35 values: three sigmas
}

/// Of 40 s from 40 s on: without the three seconds that show it and without its end.
TEST(RestWatch, TellsWhereARestLies) {
  LevelDrive drive;
  drive.speed = [](double t) { return 10 * std::max(0.0, std::abs(t - 60) / 20 - 1); };
  drive.seconds = 120;
  drive.fix_sigma = 0.1;
  RestWatch watch;
  drive.feed(watch);
  const std::vector<Rest> rests = watch.rests();
  ASSERT_EQ(rests.size(), 1u);
  const double begin = seconds_between(LevelDrive::kStart, rests[0].begin_ns);
  const double end = seconds_between(LevelDrive::kStart, rests[0].end_ns);
  EXPECT_GT(begin, 40);
  EXPECT_LT(begin, 45);
  EXPECT_LT(end, 80);
  EXPECT_GT(end, 76);
}

/// However many stretches it is told by.
TEST(RestWatch, ALongRestIsOne) {
  RestWatch watch;
  standing(0.1, 400).feed(watch);
  const std::vector<Rest> rests = watch.rests();
  ASSERT_EQ(rests.size(), 1u);
  EXPECT_NEAR(seconds_between(rests[0].begin_ns, rests[0].end_ns), 400 - 5, 1.1);
  RestWatch moving;
  winding().feed(moving);
  EXPECT_TRUE(moving.rests().empty());
}

/// Sigmas that are too small by 14 do not hide that it rests, and show.
TEST(RestWatch, FixesThatScatterMoreThanTheySayStillRest) {
  LevelDrive drive = standing(0.28, 200);
  RestWatch watch;
  for (Measurement& m : drive.measurements()) {
    if (auto* fix = std::get_if<GnssFix>(&m)) {
      fix->position_covariance /= 14 * 14;
      watch.add(*fix);
    }
    if (const auto* increment = std::get_if<ImuIncrement>(&m)) watch.add(*increment);
  }
  EXPECT_GT(watch.facts().seconds, 150);
  EXPECT_NEAR(watch.facts().fix_scatter, 14, 3);
}

/// Fixes that would not show a walk do not show rest.
TEST(RestWatch, CoarseFixesTellNoShortRest) {
  RestWatch watch;
  standing(10, 12).feed(watch);
  EXPECT_EQ(watch.facts().seconds, 0);
}

TEST(RestWatch, WithoutFixesOrSigmasThereIsNoRest) {
  RestWatch watch;
  LevelDrive drive = standing(0, 60);
  drive.feed(watch);
  EXPECT_EQ(watch.facts().seconds, 0);
  EXPECT_EQ(watch.facts().fix_pairs, 0);
}

}  // namespace
}  // namespace foucault::diagnosis
