#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "foucault/core/time.h"
#include "foucault/rawlog/import_csv.h"
#include "foucault/rawlog/import_i2nav.h"
#include "foucault/rawlog/rawlog_info.h"
#include "foucault/rawlog/rawlog_source.h"
#include "scratch.h"

/// Wheel speeds from files of their own.
namespace foucault::rawlog {
namespace {

using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

/// Second 100 of the GPS week 2200, on the UNIX scale.
constexpr int64_t kBegin = 1'646'524'882'000'000'000;
constexpr int64_t kMillisecond = 1'000'000;

using Speeds = std::vector<std::pair<int64_t, double>>;

/// Stamps [ms since kBegin] and speeds [m/s] of a log, in its order.
Speeds speeds_in(const std::string& path) {
  RawlogSource source(path, imu::SampleKind::interval_mean);
  Speeds speeds;
  while (const std::optional<Measurement> m = source.next()) {
    const auto* wheel = std::get_if<WheelSpeed>(&*m);
    if (wheel == nullptr) continue;
    EXPECT_EQ((wheel->t_ns - kBegin) % kMillisecond, 0);
    speeds.emplace_back((wheel->t_ns - kBegin) / kMillisecond, wheel->forward);
  }
  EXPECT_EQ(source.counts().late, 0);
  return speeds;
}

// i2nav -----------------------------------------------------------------------------------------

class I2navWheels : public ::testing::Test {
 protected:
  I2navWheels() {
    options_.imu = scratch_.path("imu.txt");
    options_.gnss = scratch_.text_file("gnss.pos", "100.01 30.5 114.5 20.25 0.01 0.02 0.03\n");
    options_.wheel = scratch_.path("wheel.csv");
    options_.out = scratch_.path("out.rawlog");
    options_.gps_week = 2200;
    imu_from(100);
  }

  /// 0.2 s at 200 Hz, over the end of the week too.
  void imu_from(double sow, const std::string& more = "") {
    std::string text;
    for (int i = 0; i < 40; ++i) {
      text += fmt::format("{:.4f} 1e-6 2e-6 3e-6 0.001 0.002 -0.049{}\n",
                          std::fmod(sow + 0.005 * i, 604'800), more);
    }
    scratch_.text_file("imu.txt", text);
  }

  ImportSummary with_wheel(const std::string& text) {
    scratch_.text_file("wheel.csv", text);
    return import_i2nav(options_);
  }
  std::string data_error(const std::string& text) {
    const std::string what = error_of<DataError>([&] { with_wheel(text); });
    EXPECT_FALSE(std::filesystem::exists(options_.out));
    return what;
  }

  Scratch scratch_;
  I2navImport options_;
};

TEST_F(I2navWheels, TextOrCsvWithAHeaderOrNot) {
  const char* files[] = {"gps_sow_s,speed_m_s\n100.001,7.25\n100.101,-0.5\n",
                         "100.001,7.25\n100.101,-0.5\n", "100.001, 7.25\r\n100.101, -0.5\r\n",
                         "# second of week, speed\n100.001 7.25\n\n100.101\t-5e-1\n",
                         "second of week [s], speed [m/s]\n100.001 7.25\n100.101 -0.5"};
  for (const char* file : files) {
    const ImportSummary summary = with_wheel(file);
    EXPECT_EQ(summary.wheel_speeds, 2) << file;
    EXPECT_EQ(summary.wheel->written, 2) << file;
    EXPECT_EQ(summary.wheel->file, *options_.wheel);
    EXPECT_EQ(summary.wheel->first_ns, kBegin + kMillisecond) << file;
    EXPECT_EQ(summary.wheel->last_ns, kBegin + 101 * kMillisecond) << file;
    EXPECT_THAT(speeds_in(options_.out), ElementsAre(Pair(1, 7.25), Pair(101, -0.5))) << file;
  }
}

TEST_F(I2navWheels, Gzip) {
  options_.wheel = scratch_.path("wheel.csv.gz");
  gzFile file = gzopen(options_.wheel->c_str(), "wb");
  gzputs(file, "sow,speed\n100.05,12.75\n");
  gzclose(file);
  import_i2nav(options_);
  EXPECT_THAT(speeds_in(options_.out), ElementsAre(Pair(50, 12.75)));
}

TEST_F(I2navWheels, WithoutAFileThereAreNone) {
  options_.wheel.reset();
  const ImportSummary summary = import_i2nav(options_);
  EXPECT_FALSE(summary.wheel);
  EXPECT_EQ(summary.wheel_speeds, 0);
}

/// The IMU begins with the week 2200, the wheels before it; then the IMU at its end, the wheels
/// behind it.
TEST_F(I2navWheels, TheWeekIsThatOfTheImu) {
  imu_from(0);
  scratch_.text_file("gnss.pos", "0.01 30.5 114.5 20.25 0.01 0.02 0.03\n");
  with_wheel("604799.9,1\n0,2\n0.1,3\n");
  EXPECT_THAT(speeds_in(options_.out),
              ElementsAre(Pair(-100'100, 1), Pair(-100'000, 2), Pair(-99'900, 3)));
  imu_from(604'799.9);
  const ImportSummary summary = with_wheel("0,5\n0.05,6\n");
  EXPECT_EQ(summary.wheel->first_ns, gps_to_unix_ns(2201, 0));
  EXPECT_EQ(summary.wheel->last_ns, gps_to_unix_ns(2201, 0.05));
}

TEST_F(I2navWheels, BlankSpeedsAreCounted) {
  const ImportSummary summary = with_wheel("100.0,1\n100.05,nan\n100.1,-\n100.15,2\n");
  EXPECT_EQ(summary.wheel->without_fix, 2);
  EXPECT_EQ(summary.wheel->written, 2);
  EXPECT_THAT(speeds_in(options_.out), ElementsAre(Pair(0, 1), Pair(150, 2)));
}

TEST_F(I2navWheels, BadRowsStopWithFileAndLine) {
  const std::map<std::string, std::string> rows{
      {"100.1,1,2\n", "wheel.csv:3: 3 columns, 2 expected"},
      {"100.1\n", "wheel.csv:3: 1 columns, 2 expected"},
      {"100.1,fast\n", "wheel.csv:3: column 2 is 'fast', not a number"},
      {"sow,speed\n", "wheel.csv:3: column 2 is 'speed', not a number"},  // not the first line
      {"nan,1\n", "wheel.csv:3: column 1 is 'nan', not finite"},
      {"100.05,1\n", "wheel.csv:3: the stamp 2022-03-06T00:01:22.050Z does not come after"},
      {"100.01,1\n", "wheel.csv:3: the stamp 2022-03-06T00:01:22.010Z does not come after"},
      {"700000,1\n", "wheel.csv:3: second of week 700000 lies outside"},
      {"5000,1\n", "wheel.csv:3: the stamp 2022-03-06T01:23:02.000Z lies ahead"}};
  for (const auto& [row, message] : rows) {
    const std::string text = "sow,speed\n100.05,1\n" + row + "100.15,2\n";
    EXPECT_THAT(data_error(text), AllOf(HasSubstr(message), HasSubstr("--skip-bad-rows")));
    I2navImport skipping = options_;
    skipping.skip_bad_rows = true;
    skipping.out = scratch_.path("skipped.rawlog");
    const ImportSummary summary = import_i2nav(skipping);
    EXPECT_EQ(summary.wheel->skipped, 1) << row;
    EXPECT_THAT(summary.wheel->first_skipped, HasSubstr(message));
    EXPECT_THAT(speeds_in(skipping.out), ElementsAre(Pair(50, 1), Pair(150, 2))) << row;
  }
}

TEST_F(I2navWheels, WhatCannotBeRightIsTold) {
  EXPECT_THAT(data_error("sow,speed\n"), HasSubstr("no usable wheel speed row"));
  EXPECT_THAT(data_error("sow,speed\n100.1,nan\n"),
              HasSubstr("no usable wheel speed row (0 skipped, 1 without values)"));
  EXPECT_THAT(data_error("9000,1\n9000.1,1\n"),
              AllOf(HasSubstr("IMU"), HasSubstr("and wheel speeds"), HasSubstr("do not overlap")));
  options_.wheel = scratch_.path("none.csv");
  EXPECT_THAT(error_of<DataError>([&] { import_i2nav(options_); }),
              HasSubstr("none.csv' does not exist"));
  options_.wheel = scratch_.path("wheel.csv");
  options_.out = *options_.wheel;
  EXPECT_THAT(error_of<UsageError>([&] { import_i2nav(options_); }),
              HasSubstr("is an input of the import"));
}

TEST_F(I2navWheels, OneFileHasThem) {
  imu_from(100, " 7.5");
  EXPECT_THAT(error_of<UsageError>([&] { with_wheel("100.05,1\n"); }),
              AllOf(HasSubstr("imu.txt"), HasSubstr("wheel.csv' both have wheel speeds")));
  EXPECT_FALSE(std::filesystem::exists(options_.out));
  options_.wheel.reset();
  EXPECT_EQ(import_i2nav(options_).wheel_speeds, 40);
}

// CSV -------------------------------------------------------------------------------------------

class CsvWheels : public ::testing::Test {
 protected:
  CsvWheels() {
    options_.mapping = scratch_.path("mapping.yaml");
    options_.out = scratch_.path("out.rawlog");
    std::string text = "sow,gx,gy,gz,ax,ay,az,w\n";
    for (int i = 0; i < 20; ++i) {
      text += fmt::format("{:.2f},1,2,3,0.1,0.2,-9.8,4\n", 100 + 0.01 * i);
    }
    scratch_.text_file("imu.csv", text);
    scratch_.text_file("gnss.csv", "100.01,47,8,400\n");
  }

  ImportSummary run(const std::string& wheel, const std::string& table,
                    const std::string& imu_column = "") {
    scratch_.text_file("wheel.csv", table);
    scratch_.text_file(
        "mapping.yaml",
        "imu:\n  file: imu.csv\n  columns: {time: sow, gyro_x: gx, gyro_y: gy, gyro_z: gz, "
        "accel_x: ax, accel_y: ay, accel_z: az" +
            imu_column +
            "}\n  time: {system: gps_sow, gps_week: 2200}\n"
            "gnss:\n  file: gnss.csv\n  header: false\n"
            "  columns: {time: 1, latitude: 2, longitude: 3, height: 4}\n"
            "  sigma_m: [1, 2, 3]\n  time: {system: gps_sow, gps_week: 2200}\n" +
            wheel);
    return import_csv(options_);
  }
  template <class Error>
  std::string error(const std::string& wheel, const std::string& table) {
    const std::string what = error_of<Error>([&] { run(wheel, table); });
    EXPECT_FALSE(std::filesystem::exists(options_.out));
    return what;
  }

  static constexpr const char* kWheel =
      "wheel:\n  file: wheel.csv\n  columns: {time: t, speed: v}\n"
      "  time: {system: gps_sow, gps_week: 2200}\n";

  Scratch scratch_;
  CsvImport options_;
};

TEST_F(CsvWheels, TheirOwnRate) {
  const ImportSummary summary = run(kWheel, "t,v\n100.003,7.25\n100.103,-0.5\n");
  EXPECT_EQ(summary.imu.written, 20);
  EXPECT_EQ(summary.wheel->written, 2);
  EXPECT_EQ(summary.wheel_speeds, 2);
  EXPECT_THAT(speeds_in(options_.out), ElementsAre(Pair(3, 7.25), Pair(103, -0.5)));
}

/// Each says the same.
TEST_F(CsvWheels, ClocksUnitsAndDialects) {
  const std::string file = "wheel:\n  file: wheel.csv\n";
  const std::pair<std::string, std::string> tables[] = {
      {file + "  columns: {week: wn, time: sow, speed: v}\n",
       "sow,wn,v\n100.003,2200,7.25\n100.103,2200,-0.5\n"},
      {file + "  columns: {time: t, speed: v}\n  time: {system: unix, unit: ms}\n"
              "  speed_unit: mm_s\n",
       "t,v\n1646524882003,7250\n1646524882103,-500\n"},
      {file + "  header: false\n  columns: {time: 2, speed: 3}\n"
              "  rows: {column: 1, value: ODO}\n  time: {system: iso8601}\n",
       "ODO;2022-03-06T00:01:22.003Z;7,25\nGPS;1;2\nODO;2022-03-06T00:01:22.103Z;-0,5\n"},
      {file + "  columns: {time: t, speed: v}\n"
              "  time: {system: seconds_of_day, date: 2022-03-06, offset_s: -0.5}\n",
       "t v\n[s] [m/s]\n000122.503 7.25\n000122.603 -0.5\n000259.9 nan\n000300 nan\n"},
  };
  for (const auto& [wheel, table] : tables) {
    run(wheel, table);
    EXPECT_THAT(speeds_in(options_.out), ElementsAre(Pair(3, 7.25), Pair(103, -0.5))) << wheel;
  }
  run(file +
          "  columns: {time: t, speed: v}\n  time: {system: gps_sow, gps_week: 2200}\n"
          "  speed_unit: km_h\n",
      "t,v\n100.003,36\n");
  EXPECT_THAT(speeds_in(options_.out), ElementsAre(Pair(3, 36 * (1 / 3.6))));
}

TEST_F(CsvWheels, BlankSpeedsAreCounted) {
  const ImportSummary summary = run(kWheel, "t,v\n100,\n100.01,NaN\n100.02,3\n");
  EXPECT_EQ(summary.wheel->without_fix, 2);
  EXPECT_THAT(speeds_in(options_.out), ElementsAre(Pair(20, 3)));
}

TEST_F(CsvWheels, BadRowsStopWithFileAndLine) {
  const std::map<std::string, std::string> rows{
      {"100.1,1,2\n", "wheel.csv:3: 3 columns, 2 expected"},
      {"100.1,x\n", "wheel.csv:3: column 2 is 'x', not a number"},
      {",1\n", "wheel.csv:3: column 1 is '', not a number"},
      {"100.05,1\n", "wheel.csv:3: the stamp 2022-03-06T00:01:22.050Z does not come after"},
      {"100.01,1\n", "wheel.csv:3: the stamp 2022-03-06T00:01:22.010Z does not come after"},
      {"5000,1\n", "wheel.csv:3: the stamp 2022-03-06T01:23:02.000Z lies ahead"}};
  for (const auto& [row, message] : rows) {
    const std::string table = "t,v\n100.05,1\n" + row + "100.15,2\n";
    options_.skip_bad_rows = false;
    EXPECT_THAT(error<DataError>(kWheel, table), HasSubstr(message));
    options_.skip_bad_rows = true;
    EXPECT_EQ(run(kWheel, table).wheel->skipped, 1) << row;
    EXPECT_THAT(speeds_in(options_.out), ElementsAre(Pair(50, 1), Pair(150, 2))) << row;
    std::filesystem::remove(options_.out);
  }
}

TEST_F(CsvWheels, WrongMappingsNameTheKey) {
  const std::string file = "wheel:\n  file: wheel.csv\n";
  const std::string time = "  time: {system: gps_sow, gps_week: 2200}\n";
  const std::map<std::string, std::string> mappings{
      {"  columns: {time: t}\n" + time, "wheel.columns.speed is missing"},
      {"  columns: {speed: v}\n" + time, "wheel.columns.time is missing"},
      {"  columns: {time: t, speed: v}\n", "wheel.columns.week is missing"},
      {"  columns: {time: t, speed: v, latitude: v}\n" + time,
       "wheel.columns: 'latitude' is no role"},
      {"  columns: {time: t, speed: w}\n" + time, "has no column 'w'"},
      {"  columns: {time: t, speed: v}\n  time: {system: gps_sow}\n",
       "wheel.time.gps_week is missing"},
      {"  columns: {time: t, speed: v}\n  speed_unit: mph\n" + time, "wheel.speed_unit"},
      {"  columns: {time: t, speed: v}\n  unit: m_s\n" + time, "wheel.unit"}};
  for (const auto& [mapping, message] : mappings) {
    EXPECT_THAT(error<UsageError>(file + mapping, "t,v\n100.05,1\n"), HasSubstr(message));
  }
}

TEST_F(CsvWheels, OneFileHasThem) {
  const auto both = [&] { run(kWheel, "t,v\n100.05,1\n", ", wheel_speed: w"); };
  EXPECT_THAT(error_of<UsageError>(both),
              AllOf(HasSubstr("both have wheel speeds"), HasSubstr("imu.columns.wheel_speed")));
  EXPECT_FALSE(std::filesystem::exists(options_.out));
  EXPECT_EQ(run("", "", ", wheel_speed: w").wheel_speeds, 20);
}

TEST_F(CsvWheels, TheFileOfTheCommandLineWins) {
  options_.wheel = scratch_.text_file("other.csv", "t,v\n100.05,9\n");
  run(kWheel, "t,v\n100.05,1\n");
  EXPECT_THAT(speeds_in(options_.out), ElementsAre(Pair(50, 9)));
}

// Recordings ------------------------------------------------------------------------------------

/// The table as it is written, read without our importers: hundredths of m/s every 0.1 s.
TEST(WheelRecordings, SimulatedVehicle) {
  const std::string folder = test::data_dir() + "/sim_vehicle_adis16465/";
  const std::string table = folder + "wheel_speed.csv";
  // Not in the repository for its size; the tests above import what they write.
  if (!std::filesystem::exists(table)) {
    GTEST_SKIP() << "no " << table << "; set FOUCAULT_DATA_DIR";
  }
  const Scratch scratch;
  I2navImport options;
  options.imu = folder + "clean/imu.txt.gz";
  options.gnss = folder + "clean/gnss.pos";
  options.wheel = table;
  options.out = scratch.path("out.rawlog");
  options.gps_week = 2200;
  EXPECT_EQ(import_i2nav(options).wheel_speeds, 16'171);
  std::istringstream lines(test::contents(table));
  std::string line;
  std::getline(lines, line);
  Speeds expected;
  while (std::getline(lines, line)) {
    const size_t comma = line.find(',');
    expected.emplace_back(std::llround((std::stod(line) - 100) * 1000),
                          std::stod(line.substr(comma + 1)));
  }
  EXPECT_TRUE(speeds_in(options.out) == expected);
  const RawlogInfo info = read_rawlog_info(options.out);
  const auto wheels =
      std::find_if(info.streams.begin(), info.streams.end(),
                   [](const StreamInfo& s) { return s.type == "CObservationOdometry"; });
  ASSERT_NE(wheels, info.streams.end());
  EXPECT_EQ(wheels->count, 16'171);
  EXPECT_NEAR(wheels->median_interval, 0.1, 1e-4);
  EXPECT_EQ(wheels->gap_count, 0);
}

}  // namespace
}  // namespace foucault::rawlog
