#include "foucault/evaluation/drift_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace foucault::evaluation {
namespace {

using testing::ElementsAre;

std::vector<MethodOutages> some_drifts() {
  return {{"ADIS16465", "ekf", {3, 4}, {1, 1}},
          {"ADIS16465", "rough", {6, 8}, {2, 2}},
          {"ICM20602", "ekf", {10, 10}, {5, 5}}};
}

TEST(DriftTable, RmsHasTheFormOfTableThree) {
  EXPECT_EQ(to_markdown(drift_rms_table(some_drifts())),
            "**RMSEs of horizontal and vertical drifts in meters**\n"
            "\n"
            "| IMU | ekf Hor | ekf Ver | rough Hor | rough Ver |\n"
            "|---|---:|---:|---:|---:|\n"
            "| ADIS16465 | 3.54 | 1.00 | 7.07 | 2.00 |\n"
            "| ICM20602 | 10.00 | 5.00 | - | - |\n");
}

TEST(DriftTable, DifferencesHaveTheFormOfTableFour) {
  EXPECT_EQ(to_csv(drift_difference_table(some_drifts(), "ekf")),
            "Difference,ADIS16465,ICM20602\n"
            "rough - ekf (m),3.54,-\n"
            "rough - ekf (%),100.00,-\n"
            "95 % interval (%),\"[100.00, 100.00]\",-\n");
}

TEST(DriftTable, ATinyDifferenceHasNoSign) {
  const TextTable table = drift_difference_table(
      {{"A", "ekf", {3, 4}, {1, 1}}, {"A", "full", {3, 3.9999}, {1, 1}}}, "ekf");
  EXPECT_EQ(table.rows[0][1], "0.00");
  EXPECT_EQ(table.rows[1][1], "0.00");
}

TEST(DriftTable, PlainTextIsInLine) {
  EXPECT_EQ(to_plain_text({"Title", {"IMU", "a", "long"}, {{"ADIS", "1.25", "-"}}}),
            "Title\n"
            "IMU      a  long\n"
            "ADIS  1.25     -\n");
}

TEST(DriftTable, StatisticsHaveARowADirection) {
  const TextTable table = drift_statistics_table(some_drifts());
  ASSERT_EQ(table.rows.size(), 6u);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size());
  EXPECT_THAT(table.rows[4],
              ElementsAre("ICM20602", "ekf", "horizontal", "2", "10.00 [10.00, 10.00]",
                          "10.00 [10.00, 10.00]", "10.00 [10.00, 10.00]", "10.00 [10.00, 10.00]",
                          "10.00 [10.00, 10.00]", "10.00 [10.00, 10.00]"));
}

std::vector<std::string> last_cells(const DriftRecord& record) {
  const std::vector<std::string> cells = drift_record_table({record}, {10, 20}).rows[0];
  return {cells.end() - 4, cells.end()};
}

TEST(DriftTable, OneRowAnOutage) {
  DriftRecord record;
  record.recording = "trip, first.rawlog";
  record.imu = "ADIS16465";
  record.method = "ekf";
  record.shift_s = 75;
  const Outage outage{1, 1'646'881'782'300'000'000, 1'646'881'842'300'000'000};
  record.drift = outage_drift(outage, {{10, {3, 4, -1}}, {60, {6, 8, 2}}}, {10, 20});
  EXPECT_EQ(to_csv(drift_record_table({record}, {10, 20})),
            "recording,imu,method,shift_s,outage,begin_unix_s,begin_gps_week,begin_gps_s,length_s,"
            "max_horizontal_m,"
            "max_vertical_m,end_horizontal_m,end_vertical_m,horizontal_10s_m,vertical_10s_m,"
            "horizontal_20s_m,vertical_20s_m,distance_km,return_rms_horizontal_m,"
            "return_max_horizontal_m,return_settled_s\n"
            "\"trip, "
            "first.rawlog\",ADIS16465,ekf,75,2,1646881782.300000000,2200,357000.300000000,60,10."
            "0000,2.0000,"
            "10.0000,2.0000,5.0000,1.0000,,,,,,\n");
  record.drift.distance_m = 12345.6;
  record.drift.after_return = ReturnError{0.25, 1.5, std::nullopt};
  EXPECT_EQ(last_cells(record), (std::vector<std::string>{"12.346", "0.2500", "1.5000", "inf"}));
  record.drift.after_return->settled_s = 2.25;
  EXPECT_EQ(last_cells(record).back(), "2.250");
}

TEST(TextTable, QuotesWhatItMust) {
  const TextTable table{"", {"a|b", "c"}, {{"x\"y", "1,5"}}};
  EXPECT_EQ(to_csv(table), "a|b,c\n\"x\"\"y\",\"1,5\"\n");
  EXPECT_EQ(to_markdown(table), "| a\\|b | c |\n|---|---:|\n| x\"y | 1,5 |\n");
}

}  // namespace
}  // namespace foucault::evaluation
