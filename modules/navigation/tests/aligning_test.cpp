#include "../src/aligning.h"

#include <gtest/gtest.h>

#include "fake_run.h"
#include "foucault/core/constants.h"
#include "foucault/imu/imu_noise.h"
#include "test_drive.h"

namespace foucault::navigation {
namespace {

using testing::at;
using testing::DriveSimulator;
using testing::fix_at;
using testing::increment_between;

alignment::Aligner aligner(const char* mode) {
  alignment::AlignmentOptions options;
  options.mode = mode;
  if (options.mode == "given") options.roll_deg = options.pitch_deg = options.heading_deg = 0;
  return alignment::Aligner(options, imu::imu_preset("ADIS16465"), state::Mounting{});
}

/// The start lies in the rest; all that came later is given back, once and in order.
TEST(Aligning, GivesBackWhatCameAfterTheStart) {
  const DriveSimulator drive(testing::rest_and_drive(10, 30 * kDegree), testing::Sensors{});
  Aligning aligning(aligner("auto"), diagnosis::GnssOptions{});
  std::size_t taken = 0;
  std::optional<Start> start;
  for (const Measurement& measurement : drive.stream()) {
    ++taken;
    if ((start = aligning.take(measurement))) break;
  }
  ASSERT_TRUE(start);
  std::size_t later = 0;
  for (std::size_t i = 0; i < taken; ++i) later += stamp(drive.stream()[i]) > start->initial.t_ns;
  EXPECT_EQ(start->since.size(), later);
  int64_t last_ns = start->initial.t_ns;
  for (const Measurement& measurement : start->since) {
    EXPECT_GE(stamp(measurement), last_ns);
    last_ns = stamp(measurement);
  }
  EXPECT_FALSE(aligning.summary().empty());
}

/// The first fix passes the screen only when the next shows that it is in reach, or at the end.
TEST(Aligning, AFixWaitsForTheNextOrTheEnd) {
  Aligning aligning(aligner("given"), diagnosis::GnssOptions{});
  EXPECT_FALSE(aligning.take(increment_between(0, 10)));
  EXPECT_FALSE(aligning.take(fix_at(10)) && aligning.take(fix_at(10)));
  Aligning at_end(aligner("given"), diagnosis::GnssOptions{});
  at_end.take(increment_between(0, 10));
  const bool at_once = at_end.take(fix_at(10)).has_value();
  EXPECT_NE(at_once, at_end.finish().has_value());
}

TEST(Aligning, RestartForgetsEverything) {
  Aligning aligning(aligner("given"), diagnosis::GnssOptions{});
  aligning.take(increment_between(0, 10));
  aligning.restart();
  EXPECT_FALSE(aligning.finish());
  EXPECT_FALSE(aligning.why_not().empty());
}

}  // namespace
}  // namespace foucault::navigation
