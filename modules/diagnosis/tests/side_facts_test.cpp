#include "foucault/diagnosis/side_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "foucault/diagnosis/plausibility.h"
#include "level_drive.h"

namespace foucault::diagnosis {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string said(const WrongForce& wrong) { return wrong.text + " -> " + wrong.remedy; }

std::string said_of(const LevelDrive& drive,
                    const Eigen::Quaterniond& q_v_b = Eigen::Quaterniond::Identity()) {
  Plausibility plausibility(q_v_b);
  for (const Measurement& m : drive.measurements()) {
    if (const auto* increment = std::get_if<ImuIncrement>(&m)) plausibility.watch(*increment);
    if (const auto* fix = std::get_if<GnssFix>(&m)) plausibility.watch(*fix);
  }
  const std::optional<TurnMatch> turns = plausibility.turns();
  if (!turns) return "no turns";
  const std::optional<WrongForce> wrong =
      wrong_side(*turns, plausibility.accelerations(), plausibility.force().mean);
  return wrong ? said(*wrong) : "";
}

TEST(SideFacts, NothingIsMirrored) {
  EXPECT_EQ(said_of(town()), "");
  EXPECT_EQ(said_of(winding()), "");
  // Nor if axes are merely turned.
  EXPECT_EQ(said_of(town(), Eigen::Quaterniond(0, 1, 0, 0)), "");
  EXPECT_EQ(said_of(town(), Eigen::Quaterniond(0, 0, 0, 1)), "");
}

TEST(SideFacts, AMirroredTrack) {
  LevelDrive swapped = town();
  swapped.is_track_mirrored = true;
  EXPECT_THAT(said_of(swapped), AllOf(HasSubstr("the track is mirrored"),
                                      HasSubstr("latitude and longitude"), Not(HasSubstr("axes"))));
}

TEST(SideFacts, AnAccelerometerOfTheOppositeSign) {
  LevelDrive phone = town();
  phone.accel_factor = -1;
  EXPECT_THAT(said_of(phone),
              AllOf(HasSubstr("opposite sign"), HasSubstr("accel_sign: -1"), HasSubstr("leave")));
  // With axes that make up of down.
  EXPECT_THAT(said_of(phone, Eigen::Quaterniond(0, 1, 0, 0)),
              AllOf(HasSubstr("opposite sign"), HasSubstr("axes that then have up upwards")));
}

TEST(SideFacts, ALeftHandedPair) {
  LevelDrive drive = town();
  drive.accel_right_factor = -1;
  EXPECT_THAT(said_of(drive), HasSubstr("on the other side than turns"));
}

TEST(SideFacts, WithoutForcesBothAreNamed) {
  TurnMatch turns;
  turns.correlation = -0.95;
  turns.samples = 30;
  EXPECT_THAT(said(*wrong_side(turns, std::nullopt, {0, 0, -9.8})),
              AllOf(HasSubstr("latitude and longitude"), HasSubstr("axes are wrong")));
  turns.samples = 4;  // by chance
  turns.correlation = -0.6;
  EXPECT_FALSE(wrong_side(turns, std::nullopt, {0, 0, -9.8}));
}

}  // namespace
}  // namespace foucault::diagnosis
