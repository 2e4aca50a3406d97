#include "foucault/diagnosis/rest_facts.h"

#include <gtest/gtest.h>

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

TEST(RestWatch, AMovingVehicleIsNotAtRest) {
  RestWatch watch;
  LevelDrive().feed(watch);  // straight and steady: only the fixes move
  EXPECT_EQ(watch.facts().seconds, 0);
  EXPECT_EQ(watch.facts().gyro_mean, 0);
  RestWatch winding_watch;
  winding().feed(winding_watch);
  EXPECT_EQ(winding_watch.facts().seconds, 0);
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
