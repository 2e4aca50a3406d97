#include "../src/sound_epoch.h"

#include <gtest/gtest.h>

#include <limits>

namespace foucault::navigation {
namespace {

TEST(SoundEpoch, NamesTheFirstPartThatIsNoNumber) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const state::Epoch sound;
  EXPECT_EQ(unsound_part(sound), std::nullopt);
  state::Epoch epoch = sound;
  epoch.covariance(4, 2) = kNan;
  EXPECT_EQ(unsound_part(epoch), "covariance");
  epoch.bias.gyro.y() = kNan;
  EXPECT_EQ(unsound_part(epoch), "IMU biases");
  epoch.q_n_b.w() = kNan;
  EXPECT_EQ(unsound_part(epoch), "attitude");
  epoch.velocity_n.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(unsound_part(epoch), "velocity");
  epoch.position.height = kNan;
  EXPECT_EQ(unsound_part(epoch), "position");
}

TEST(SoundEpoch, AVarianceBelowZeroIsNone) {
  state::Epoch epoch;
  epoch.covariance(3, 3) = -1e-300;
  EXPECT_EQ(unsound_part(epoch), "covariance");
}

}  // namespace
}  // namespace foucault::navigation
