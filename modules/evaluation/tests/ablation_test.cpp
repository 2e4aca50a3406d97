#include "foucault/evaluation/ablation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace foucault::evaluation {
namespace {

using testing::ElementsAre;

/// Drifts of three outages, each with half of it downward.
MethodOutages outages(const std::string& method, double scale) {
  return {"trip", method, {scale, 2 * scale, 3 * scale}, {scale / 2, scale, 1.5 * scale}};
}

class AblationTest : public testing::Test {
 protected:
  std::vector<MethodOutages> outages_{outages("ekf", 1), outages("ekf without wheel_speed", 2)};
};

TEST_F(AblationTest, DifferencesAreFromTheSameMethodAsItIs) {
  const std::vector<AblationRow> rows =
      ablation_rows(outages_, {{"ekf", ""}, {"ekf", "wheel_speed"}, {"ekf", "aids"}});
  ASSERT_EQ(rows.size(), 2u) << "one has no outages";
  EXPECT_DOUBLE_EQ(rows[1].horizontal_rms_m, 2 * rows[0].horizontal_rms_m);
  EXPECT_FALSE(rows[0].horizontal_relative);
  EXPECT_DOUBLE_EQ(rows[1].vertical_relative->value, 1);
  const TextTable table = ablation_table(rows);
  EXPECT_THAT(table.rows[0], ElementsAre("ekf", "2.160", "1.080", "", "", ""));
  EXPECT_THAT(table.rows[1], ElementsAre("ekf without wheel_speed", "4.320", "2.160", "+100.0",
                                         "[+100.0, +100.0]", "+100.0"));
}

TEST_F(AblationTest, WhatNoRecordingUsesHasNoRow) {
  outages_.push_back(outages("ekf without zero_velocity", 1));
  const std::vector<AblationRow> rows =
      ablation_rows(outages_, {{"ekf", ""}, {"ekf", "wheel_speed"}, {"ekf", "zero_velocity"}});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].what.without, "wheel_speed");
}

TEST_F(AblationTest, NoDifferenceFromAMethodThatFailed) {
  outages_.erase(outages_.begin());
  const std::vector<AblationRow> rows =
      ablation_rows(outages_, {{"ekf", ""}, {"ekf", "wheel_speed"}});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_FALSE(rows[0].horizontal_relative);
}

}  // namespace
}  // namespace foucault::evaluation
