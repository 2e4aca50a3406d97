#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calendar_text.h"
#include "foucault/core/config.h"
#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/rawlog/import_csv.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/rawlog/recording_notes.h"
#include "scratch.h"
#include "text_table.h"

/// Tables as loggers write them: each dialect gives what the plain table gives.
namespace foucault::rawlog {
namespace {

using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int64_t kMs = kNanosecondsPerSecond / 1000;

class Dialects : public ::testing::Test {
 protected:
  Dialects() {
    options_.mapping = scratch_.path("mapping.yaml");
    options_.out = scratch_.path("out.rawlog");
    imu(kImuRows);
    gnss(kGnssRows);
  }

  void imu(const std::string& text) { scratch_.text_file("imu.csv", text); }
  void gnss(const std::string& text) { scratch_.text_file("gnss.csv", text); }

  ImportSummary run(const std::string& imu_keys = "", const std::string& gnss_keys = kTime,
                    const std::string& gnss_columns = "height: h") {
    scratch_.text_file(
        "mapping.yaml",
        fmt::format("imu:\n  file: imu.csv\n  columns: {{time: t, gyro_x: gx, gyro_y: "
                    "gy, gyro_z: gz, accel_x: ax, accel_y: ay, accel_z: az}}\n{}{}"
                    "gnss:\n  file: gnss.csv\n  columns: {{time: t, latitude: lat, "
                    "longitude: lon, {}}}\n  sigma_m: [1, 2, 3]\n{}{}",
                    imu_keys.find("time:") == std::string::npos ? kTime : "", imu_keys,
                    gnss_columns, gnss_keys, reference_));
    return import_csv(options_);
  }

  template <class Kind>
  std::vector<Kind> all() const {
    RawlogSource source(options_.out, imu::SampleKind::interval_mean);
    std::vector<Kind> found;
    while (const std::optional<Measurement> m = source.next()) {
      if (const Kind* one = std::get_if<Kind>(&*m)) found.push_back(*one);
    }
    return found;
  }
  GnssFix fix() const { return all<GnssFix>().at(0); }

  /// What the tables of the constructor say.
  void expect_plain() const {
    const auto increments = all<ImuIncrement>();
    ASSERT_EQ(increments.size(), 2U);
    EXPECT_EQ(increments[0].t_end_ns, gps_to_unix_ns(2200, 100.01));
    EXPECT_TRUE(increments[0].dtheta_b.isApprox(0.01 * Eigen::Vector3d(0.5, -1.5, 2), 1e-9));
    EXPECT_TRUE(increments[1].dvel_b.isApprox(0.01 * Eigen::Vector3d(0.25, 0.5, -9.5), 1e-9));
    expect_fix();
  }
  void expect_fix() const {
    EXPECT_EQ(fix().t_ns, gps_to_unix_ns(2200, 100.01));
    EXPECT_NEAR(fix().antenna.latitude, 47.5 * kDegree, 1e-12);
    EXPECT_NEAR(fix().antenna.longitude, -8.25 * kDegree, 1e-12);
    EXPECT_NEAR(fix().antenna.height, 400.5, 1e-9);
  }

  static constexpr const char* kTime = "  time: {system: gps_sow, gps_week: 2200}\n";
  static constexpr const char* kImuRows =
      "t,gx,gy,gz,ax,ay,az\n100.00,0.5,-1.5,2,0.25,0.5,-9.5\n100.01,0.5,-1.5,2,0.25,0.5,-9.5\n"
      "100.02,0.5,-1.5,2,0.25,0.5,-9.5\n";
  static constexpr const char* kGnssRows = "t,lat,lon,h\n100.01,47.5,-8.25,400.5\n";

  std::string reference_;
  Scratch scratch_;
  CsvImport options_;
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

std::string after_header(std::string text, const std::string& line) {
  return text.insert(text.find('\n') + 1, line);
}

TEST_F(Dialects, SeparatorsAndDecimalCommasAreFound) {
  run();
  expect_plain();
  for (const char* separator : {";", "\t", " ", ", ", " ; "}) {
    imu(replaced(kImuRows, ",", separator));
    run();
    expect_plain();
  }
  imu(replaced(replaced(kImuRows, ",", ";"), ".", ","));
  gnss(replaced(replaced(kGnssRows, ",", "\t"), ".", ","));
  run();
  expect_plain();
}

TEST_F(Dialects, TablesWithoutAHeaderToo) {
  gnss("# a comment\n100,01;47,5;-8,25;400,5\n");
  scratch_.text_file(
      "mapping.yaml",
      fmt::format(
          "imu:\n  file: imu.csv\n  columns: {{time: t, gyro_x: gx, gyro_y: gy, gyro_z: gz, "
          "accel_x: ax, accel_y: ay, accel_z: az}}\n{0}gnss:\n  file: gnss.csv\n  header: "
          "false\n  columns: {{time: 1, latitude: 2, longitude: 3, height: 4}}\n  sigma_m: "
          "[1, 2, 3]\n{0}",
          kTime));
  import_csv(options_);
  expect_plain();
}

TEST_F(Dialects, DecimalCommasBetweenCommasNeedTheKey) {
  gnss("t,lat,lon,h\n\"100,01\",\"47,5\",\"-8,25\",\"400,5\"\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }),
              HasSubstr("'400,5', not a number; if that is a decimal comma, give decimal: comma"));
  run("", std::string(kTime) + "  decimal: comma\n");
  expect_plain();
}

TEST_F(Dialects, CommasThatMayBeOfThousandsAreRefused) {
  gnss("t;lat;lon;h\n100.01;47.5;-8.25;1,400\n");
  EXPECT_THAT(error_of<UsageError>([&] { run(); }),
              AllOf(HasSubstr("comma of '1,400' may be decimal or stand between thousands"),
                    HasSubstr("gnss.decimal: point")));
  run("", std::string(kTime) + "  decimal: point\n");
  EXPECT_NEAR(fix().antenna.height, 1400, 1e-9);
  gnss("t;lat;lon;h\n100,01;47,5;-8,25;1,400\n");  // others have no three decimals
  run();
  EXPECT_NEAR(fix().antenna.height, 1.4, 1e-9);
  gnss("t,lat,lon,h\n100.01,47.5,-8.25,\"1,400\"\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }),
              HasSubstr("if its comma stands between thousands, give decimal: point"));
}

TEST_F(Dialects, PointsBetweenThousandsNeedTheKey) {
  gnss("t;lat;lon;h\n100,01;47,5;-8,25;1.400,25\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("give decimal: comma"));
  run("", std::string(kTime) + "  decimal: comma\n");
  EXPECT_NEAR(fix().antenna.height, 1400.25, 1e-9);
  EXPECT_FALSE(has_thousands("0.400,25", '.'));
  EXPECT_FALSE(has_thousands("1.400", '.'));
  EXPECT_FALSE(has_thousands("1,40", ','));
  EXPECT_FALSE(has_thousands("1234,400", ','));
  EXPECT_TRUE(has_thousands("-1,234,400.5", ','));
}

TEST_F(Dialects, NumbersOfFortranAndOfTypesetters) {
  gnss(
      "t,lat,lon,h\n1.0001D+02,0.475d+02,\xE2\x88\x92"
      "8.25,4.005D2\n");
  run();
  expect_plain();
  gnss("t,lat,lon,h\n100.01,47.5,-8.25,00D6\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("if it is hexadecimal"));
}

TEST_F(Dialects, ANameThatStandsTwiceIsNoName) {
  gnss("t,h,lat,lon,h\n100.01,0,47.5,-8.25,400.5\n");
  EXPECT_THAT(error_of<UsageError>([&] { run(); }),
              HasSubstr("gnss.csv' has two columns 'h', 2 and 5; give the number"));
  run("", kTime, "height: 5");
  expect_plain();
}

TEST_F(Dialects, SeparatorsThatTheRowsHave) {
  imu(replaced(kImuRows, ",", ";").replace(0, 19, "t ; gx ; gy ; gz ; ax ; ay ; az"));
  run();
  expect_plain();
  imu("t , gx , gy , gz , ax , ay , az\n" + std::string(kImuRows).substr(20));
  run();
  expect_plain();
}

TEST_F(Dialects, TheRowsTellTheWidth) {
  const std::string row_names = "1," + replaced(std::string(kImuRows).substr(20), "\n1", "\n1,1");
  imu("t,gx,gy,gz,ax,ay,az\n" + row_names);
  EXPECT_THAT(error_of<UsageError>([&] { run(); }),
              AllOf(HasSubstr("7 names in its header, line 1, and 8 columns in its rows"),
                    HasSubstr("header: false")));
  const std::string numbers =
      "imu:\n  file: imu.csv\n  header: {}\n  columns: {{time: 2, gyro_x: 3, gyro_y: 4, gyro_z: 5, "
      "accel_x: 6, accel_y: 7, accel_z: 8}}\n{}gnss:\n  file: gnss.csv\n  columns: {{time: t, "
      "latitude: lat, longitude: lon, height: h}}\n  sigma_m: [1, 2, 3]\n{}";
  for (const char* header : {"true", "false"}) {
    scratch_.text_file("mapping.yaml", fmt::format(fmt::runtime(numbers), header, kTime, kTime));
    import_csv(options_);
    expect_plain();
  }
}

TEST_F(Dialects, RowsOfOneKind) {
  const std::string imu_rows = replaced(std::string(kImuRows).substr(19), "\n100", "\n$IMU,100");
  imu("$GPS,100.01,47.5,-8.25,400.5" + imu_rows);
  const std::string mapping =
      "imu:\n  file: imu.csv\n  header: false\n  columns: {time: 2, gyro_x: 3, gyro_y: 4, gyro_z: "
      "5, accel_x: 6, accel_y: 7, accel_z: 8}\nROWSIMU" +
      std::string(kTime) +
      "gnss:\n  file: imu.csv\n  header: false\n  columns: {time: 2, latitude: 3, longitude: 4, "
      "height: 5}\n  sigma_m: [1, 2, 3]\nROWSGPS" +
      kTime;
  const auto chosen = [](const char* kind) {
    return fmt::format("  rows: {{column: 1, value: ${}}}\n", kind);
  };
  scratch_.text_file("mapping.yaml", replaced(replaced(mapping, "ROWSIMU", chosen("IMU")),
                                              "ROWSGPS", chosen("GPS")));
  import_csv(options_);
  expect_plain();
  scratch_.text_file("mapping.yaml", replaced(replaced(mapping, "ROWSIMU", ""), "ROWSGPS", ""));
  EXPECT_THAT(error_of<DataError>([&] { import_csv(options_); }), HasSubstr("imu.rows: {column"));
}

TEST_F(Dialects, TwoSensorsInATableAreTold) {
  std::string rows = "t,id,gx,gy,gz,ax,ay,az\n";
  for (int i = 0; i < 20; ++i) {
    rows +=
        fmt::format("{0:.2f},A,0.5,-1.5,2,0.25,0.5,-9.5\n{0:.2f},B,1,1,1,1,1,1\n", 100 + 0.01 * i);
  }
  imu(rows);
  EXPECT_THAT(run().imu.notices.at(0),
              HasSubstr("choose one with imu.rows: {column: 2, value: \"A\"}"));
  EXPECT_TRUE(run("  rows: {column: id, value: A}\n").imu.notices.empty());
  EXPECT_EQ(all<ImuIncrement>().size(), 19U);
  EXPECT_TRUE(all<ImuIncrement>()[0].dtheta_b.isApprox(0.01 * Eigen::Vector3d(0.5, -1.5, 2), 1e-9));
}

TEST_F(Dialects, LineEndsEncodingsAndZeros) {
  imu(replaced(kImuRows, "\n", "\r"));
  run();
  expect_plain();
  for (const bool little : {true, false}) {
    std::string wide = little ? "\xFF\xFE" : "\xFE\xFF";
    for (const char c : std::string(kImuRows)) {
      wide += little ? std::string{c, '\0'} : std::string{'\0', c};
    }
    imu(wide);
    run();
    expect_plain();
  }
  imu(kImuRows + std::string(200'000, '\0'));
  EXPECT_THAT(run().imu.notices.at(0), HasSubstr("200000 bytes of zeros"));
  expect_plain();
  imu("PK\x03\x04 and so on\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("is a zip archive"));
}

TEST_F(Dialects, ManyLinesBeforeTheHeader) {
  std::string before;
  for (int i = 0; i < 400; ++i) before += fmt::format("setting {}: value\n", i);
  imu(before + kImuRows);
  run();
  expect_plain();
}

TEST_F(Dialects, LinesBeforeTheHeaderAndComments) {
  for (const char* before : {"# Logger v1.2\n", "# Logger v1.2\n\n# t, of what\n", "Logger;v1.2\n",
                             "\xEF\xBB\xBF% made by\nSensor,7\n"}) {
    imu(before + std::string(kImuRows));
    gnss(before + after_header(kGnssRows, "# begins\n"));
    run();
    expect_plain();
  }
  imu("# Logger\n# " + std::string(kImuRows));
  run();
  expect_plain();
  imu("# Logger\n" + replaced(kImuRows, "gz", "rz"));
  EXPECT_THAT(error_of<UsageError>([&] { run(); }),
              AllOf(HasSubstr("no column 'gz'"), HasSubstr("it has t, gx, gy, rz")));
}

TEST_F(Dialects, AHeaderMayBeOfColumnsThatTheMappingNumbers) {
  imu("# Logger\n" + replaced(kImuRows, ",", ";"));
  scratch_.text_file(
      "mapping.yaml",
      fmt::format(
          "imu:\n  file: imu.csv\n  columns: {{time: 1, gyro_x: 2, gyro_y: 3, gyro_z: 4, "
          "accel_x: 5, accel_y: 6, accel_z: 7}}\n{0}gnss:\n  file: gnss.csv\n  columns: "
          "{{time: t, latitude: lat, longitude: lon, height: h}}\n  sigma_m: [1, 2, 3]\n{0}",
          kTime));
  import_csv(options_);
  expect_plain();
}

TEST_F(Dialects, LinesAreCountedFromTheFirst) {
  imu("# Logger\n" + after_header(kImuRows, "s,rad/s,rad/s,rad/s,m/s2,m/s2,m/s2\n") + "100.03,1\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("imu.csv:7: 2 columns, 7 expected"));
}

TEST_F(Dialects, UnitsUnderTheHeader) {
  imu(after_header(kImuRows, "s,rad/s,rad/s,rad/s,m/s2,m/s2,m/s2\n"));
  gnss(after_header(kGnssRows, "[s],[\xC2\xB0],[\xC2\xB0],\n"));
  run();
  expect_plain();
  imu(kImuRows + std::string("s,rad/s,rad/s,rad/s,m/s2,m/s2,m/s2\n"));
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("imu.csv:5: column 2 is 'rad/s'"));
  imu(after_header(kImuRows, "100.00,nan,x,x,x,x,x\n"));
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("imu.csv:2: "));
}

TEST_F(Dialects, QuotesAndTrailingSeparators) {
  imu(replaced(replaced(kImuRows, "gx,", "\"gx\","), ",0.5,-1.5", ", \"0.5\",\" -1.5\" "));
  gnss("t,\"lat\",lon,h,\"of, what\",\n100.01,47.5,-8.25,400.5,\"a, b\",\n");
  run();
  expect_plain();
  imu(replaced(kImuRows, "\n", ",\n"));
  gnss("t,lat,lon,h\n100.01,47.5,-8.25,400.5,\n");
  run();
  expect_plain();
  gnss("t,lat,lon,h\n100.01,47.5,-8.25,400.5,1\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("5 columns, 4 expected"));
}

TEST_F(Dialects, BlankCellsOfMergedTables) {
  gnss("t,lat,lon,h\n100.00,,,\n100.01,47.5,-8.25,400.5\n100.02,nan,NaN,null\n");
  imu(after_header(kImuRows, "99.99,,,,,,\n"));
  const ImportSummary summary = run();
  EXPECT_EQ(summary.gnss.without_fix, 2);
  EXPECT_EQ(summary.gnss.skipped, 0);
  EXPECT_EQ(summary.imu.without_fix, 1);
  expect_plain();
  gnss("t,lat,lon,h\n100.00,47.5,,400\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("column 3 is '', not a number"));
  imu(after_header(kImuRows, "99.99,1,2,,3,4,5\n"));
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("column 4 is ''"));
}

TEST_F(Dialects, SpellingsOfNoNumber) {
  const std::string keys = std::string(kTime) + "  velocity_sigma_m_s: [1, 1, 1]\n";
  const std::string columns = "height: h, velocity_north: n, velocity_east: n, velocity_down: n";
  for (const char* blank : {"", "NaN", "-nan(ind)", "1.#QNAN", "-1.#IND00", "inf", "-Inf", "***",
                            "#N/A", "---.-", "NULL", "none", "#DIV/0!"}) {
    gnss(fmt::format("t,lat,lon,h,n\n100.01,47.5,-8.25,400.5,{}\n", blank));
    EXPECT_EQ(run("", keys, columns).with_velocity, 0) << blank;
    expect_plain();
  }
  for (const char* word : {"north", "1.5m", "infra", "-x", "1.2.3"}) {
    EXPECT_FALSE(is_blank_text(word)) << word;
  }
}

TEST_F(Dialects, FixesKeepTheirPositionWithoutAVelocity) {
  const std::string keys = std::string(kTime) + "  velocity_sigma_m_s: [1, 1, 1]\n";
  const std::string columns = "height: h, velocity_north: n, velocity_east: e, velocity_down: d";
  gnss("t,lat,lon,h,n,e,d\n100.01,47.5,-8.25,400.5,nan,nan,nan\n100.02,47.5,-8.25,400,1,2,3\n");
  EXPECT_EQ(run("", keys, columns).with_velocity, 1);
  EXPECT_FALSE(fix().velocity_n);
  expect_plain();
  EXPECT_EQ(all<GnssFix>().at(1).velocity_n->y(), 2);
  gnss("t,lat,lon,h,n,e,d\n100.01,47.5,-8.25,400.5,1,x,3\n");
  EXPECT_THAT(error_of<DataError>([&] { run("", keys, columns); }), HasSubstr("'x', not a number"));
}

// Clocks ----------------------------------------------------------------------------------------

TEST(CalendarText, DatesAndTimes) {
  const int64_t expected = 1707307182'020'000'000;
  for (const char* text :
       {"2024-02-07T11:59:42.020Z", "2024-02-07 11:59:42.02", "2024/02/07 11:59:42,020",
        "20240207T115942.020Z", "07.02.2024 11:59:42.020", "2024-02-07T12:59:42.020+01:00",
        "2024-02-07T06:29:42.020 -0530", "2024-02-07  11:59:42.0200000009 UTC",
        "2024-02-07 11:59:42.020 GMT", "2024-02-07 11:59:42:020", "07.02.24 11:59:42.020",
        "07-Feb-2024 11:59:42.020", "2024-FEB-07T11:59:42.020", "2024.02.07 11:59:42.020 AM"}) {
    EXPECT_EQ(calendar_ns(text), expected) << text;
  }
  EXPECT_EQ(calendar_ns("2024-02-29T00:00:00"), date_ns("2024-02-29"));
  EXPECT_EQ(time_of_day_ns("23:59:60.5"), 86400 * kNanosecondsPerSecond + 500 * kMs);
  for (const char* text :
       {"", "2024-02-07", "2024-02-30T00:00:00", "2023-02-29T00:00:00", "02/07/2024 11:59:42",
        "2024-02-07T24:00:00", "2024-02-07T11:60:00", "2024-02-07T11:59", "2024-02-07T11:59:42 CET",
        "2024-02-07T11:59:42Zx", "24-02-07T11:59:42", "2024-02/07T11:59:42", "T", "2024-02-07T"}) {
    EXPECT_FALSE(calendar_ns(text)) << text;
  }
}

TEST(CalendarText, DaysAndMonths) {
  EXPECT_EQ(date_ns("13/02/2024"), date_ns("2024-02-13"));
  EXPECT_EQ(date_ns("02/13/2024"), date_ns("2024-02-13"));
  EXPECT_EQ(date_ns("02-02-2024"), date_ns("2024-02-02"));
  EXPECT_FALSE(date_ns("02/07/2024"));
  EXPECT_EQ(date_ns("02/07/2024", "%m/%d/%Y"), date_ns("2024-02-07"));
  EXPECT_EQ(date_ns("070224", "%d%m%y"), date_ns("2024-02-07"));
  for (const char* none : {"070224", "02/07/24", "13/13/2024", "30-Feb-2024", "07-Fxb-2024"}) {
    EXPECT_FALSE(date_ns(none)) << none;
  }
  EXPECT_TRUE(is_date_format("%d/%m/%Y"));
  for (const char* none : {"", "d/m/y", "%H:%M", "%d/%", "%d %T"}) {
    EXPECT_FALSE(is_date_format(none)) << none;
  }
}

TEST(CalendarText, HalvesOfTheDay) {
  const int64_t hour = 3600 * kNanosecondsPerSecond;
  EXPECT_EQ(time_of_day_ns("12:00:00 AM"), 0);
  EXPECT_EQ(time_of_day_ns("12:00:00.0 pm"), 12 * hour);
  EXPECT_EQ(time_of_day_ns("1:00:00PM"), 13 * hour);
  EXPECT_EQ(time_of_day_ns("13:00:00Z"), 13 * hour);
  EXPECT_EQ(time_of_day_ns("00:00:00:020"), 20 * kMs);
  for (const char* none : {"13:00:00 PM", "0:00:00 AM", "1:00:00 XM", "00:00:00:20"}) {
    EXPECT_FALSE(time_of_day_ns(none)) << none;
  }
}

TEST_F(Dialects, DatesOfAFormat) {
  gnss("t,lat,lon,h\n03/06/2022 00:01:22.01,47.5,-8.25,400.5\n");
  const std::string time = "  time: {system: iso8601";
  EXPECT_THAT(error_of<DataError>([&] { run("", time + "}\n"); }),
              HasSubstr("tell gnss.time.date_format"));
  run("", time + ", date_format: \"%m/%d/%Y\"}\n");
  expect_plain();
  EXPECT_THAT(error_of<UsageError>([&] { run("", time + ", date_format: \"%H\"}\n"); }),
              HasSubstr("'%H' is no format of a date"));
  gnss("d,t,lat,lon,h\n060322,000122.01,47.5,-8.25,400.5\n");
  run("", time + ", date_format: \"%d%m%y\"}\n", "height: h, date: d");
  expect_plain();
}

TEST_F(Dialects, TimesInParts) {
  gnss("y,mo,d,h24,mi,t,lat,lon,h\n2022,03,06,0,1,22.01,47.5,-8.25,400.5\n");
  const std::string parts =
      "height: h, year: y, month: mo, day: d, hour: h24, minute: mi, second: t";
  run("", "  time: {system: iso8601}\n", parts);
  expect_plain();
  EXPECT_THAT(error_of<UsageError>([&] { run("", kTime, parts); }), HasSubstr("system: iso8601"));
  gnss("y,mo,d,h24,mi,t,lat,lon,h\n2022,02,30,0,1,22.01,47.5,-8.25,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run("", "  time: {system: iso8601}\n", parts); }),
              HasSubstr("are no date"));
  gnss("t,ns,lat,lon,h\n1646524882,10000000,47.5,-8.25,400.5\n");
  run("", "  time: {system: unix}\n", "height: h, nanosecond: ns");
  expect_plain();
}

TEST_F(Dialects, DayNumbers) {
  // 2022-03-06T00:01:22.01Z
  gnss("t,lat,lon,h\n44626.000949189815,47.5,-8.25,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run("", "  time: {system: unix}\n"); }),
              AllOf(HasSubstr("gnss.csv:2: column 1 is '44626"), HasSubstr("system: excel")));
  run("", "  time: {system: excel}\n");
  EXPECT_NEAR(static_cast<double>(fix().t_ns - gps_to_unix_ns(2200, 100.01)), 0, 1000);
  gnss("t,lat,lon,h\n738586.000949189815,47.5,-8.25,400.5\n");
  run("", "  time: {system: matlab_datenum}\n");
  EXPECT_NEAR(static_cast<double>(fix().t_ns - gps_to_unix_ns(2200, 100.01)), 0, 1000);
}

TEST_F(Dialects, UnitsOfTimesThatAreOutOfRange) {
  gnss("t,lat,lon,h\n1646524882010,47.5,-8.25,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run("", "  time: {system: unix}\n"); }),
              HasSubstr("if it is in ms, give gnss.time.unit: ms"));
  gnss("t,lat,lon,h\n100010000000,47.5,-8.25,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("if it is in us"));
}

TEST_F(Dialects, WeeksModulo1024) {
  gnss("w,t,lat,lon,h\n152,100.01,47.5,-8.25,400.5\n");
  run("", "  time: {system: gps_week_sow, add_weeks: 2048}\n", "height: h, week: w");
  expect_plain();
}

TEST_F(Dialects, CountersOf32BitsGoOn) {
  const std::string time =
      "  time: {system: boot, unit: us, gps_week: 2200, boot_sow: -4194.9672}\n";
  const auto rows = [](const char* second, const char* third) {
    return replaced(replaced(replaced(kImuRows, "\n100.00", "\n4294957296"), "\n100.01",
                             std::string("\n") + second),
                    "\n100.02", std::string("\n") + third);
  };
  imu(rows("10000", "20000"));
  run(time);
  const auto increments = all<ImuIncrement>();
  ASSERT_EQ(increments.size(), 2U);
  EXPECT_EQ(increments[1].t_end_ns - increments[0].t_end_ns, 10 * kMs);
  EXPECT_NEAR(increments[0].dt(), 0.02, 1e-6);
  imu(rows("100000000", "100010000"));  // 100 s: switched on again
  EXPECT_THAT(error_of<DataError>([&] { run(time); }), HasSubstr("does not come after"));
}

TEST_F(Dialects, HoursMinutesAndSecondsAsANumber) {
  const std::string time = "  time: {system: seconds_of_day, date: 2022-03-05}\n";
  const auto rows = [](const char* first, const char* second, const char* third) {
    const std::string line = "\n";
    return replaced(
        replaced(replaced(kImuRows, "\n100.00", line + first), "\n100.01", line + second),
        "\n100.02", line + third);
  };
  imu(rows("80659.98", "80659.99", "80700.00"));
  gnss("t,lat,lon,h\n080659.99,47.5,-8.25,400.5\n080700.00,47.5,-8.25,400.5\n");
  EXPECT_THAT(run(time, time).imu.notices.at(0), HasSubstr("are read as hhmmss"));
  const int64_t end = *date_ns("2022-03-05") + *time_of_day_ns("08:07:00");
  EXPECT_EQ(all<ImuIncrement>().at(1).t_end_ns, end);
  EXPECT_EQ(fix().t_ns, end - 10 * kMs);
  // A row of 60 seconds or more: they are seconds of the day.
  gnss("t,lat,lon,h\n80659.99,47.5,-8.25,400.5\n80700,47.5,-8.25,400.5\n80760,47.5,-8.25,400.5\n");
  imu(rows("80659.98", "80659.99", "80660.00"));
  EXPECT_TRUE(run(time, time).imu.notices.empty());
  EXPECT_EQ(fix().t_ns, *date_ns("2022-03-05") + 80'659'990 * kMs);
  // No day has so many, and nothing jumps.
  gnss("t,lat,lon,h\n115942.00,47.5,-8.25,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run(time, time); }),
              HasSubstr("if it is hhmmss, give gnss.time.unit: hhmmss"));
}

TEST_F(Dialects, DateAndTimeAsText) {
  // 2022-03-06T00:01:22.00Z is second 100 of week 2200.
  const std::string unix_or = replaced(kImuRows, "\n100", "\n2022-03-06T00:01:22");
  imu(unix_or);
  gnss(replaced(kGnssRows, "\n100.01", "\n06.03.2022 01:01:22.01+01:00"));
  for (const char* system : {"iso8601", "unix"}) {
    const std::string time = fmt::format("  time: {{system: {}}}\n", system);
    run(time, time);
    expect_plain();
  }
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("give time: {system: iso8601}"));
}

TEST_F(Dialects, DateAndTimeInTwoColumns) {
  gnss("d,t,lat,lon,h\n2022-03-06,00:01:22.01,47.5,-8.25,400.5\n");
  const std::string time = "  time: {system: iso8601}\n";
  run("", time, "height: h, date: d");
  expect_plain();
  EXPECT_THAT(error_of<DataError>([&] { run("", time); }),
              AllOf(HasSubstr("gnss.csv:2: '00:01:22.01' is no date and time"),
                    HasSubstr("name a column `date`")));
}

TEST_F(Dialects, SecondsOfDayGoOnBehindMidnight) {
  const std::string time = "  time: {system: seconds_of_day, date: 2022-03-05}\n";
  imu(replaced(replaced(replaced(kImuRows, "\n100.00", "\n86399.99"), "\n100.01", "\n0.00"),
               "\n100.02", "\n0.01"));
  gnss("t,lat,lon,h\n23:59:59.99,47.5,-8.25,400.5\n00:00:00.00,47.5,-8.25,400.5\n");
  run(time, time);
  const int64_t midnight = *date_ns("2022-03-06");
  const auto increments = all<ImuIncrement>();
  ASSERT_EQ(increments.size(), 2U);
  EXPECT_EQ(increments[0].t_end_ns, midnight);
  EXPECT_EQ(increments[1].t_end_ns, midnight + 10 * kMs);
  EXPECT_EQ(fix().t_ns, midnight - 10 * kMs);
  EXPECT_EQ(all<GnssFix>().at(1).t_ns, midnight);
  gnss("t,lat,lon,h\n23:59:59.99,47.5,-8.25,400.5\n23:59:61.00,47.5,-8.25,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run(time, time); }), HasSubstr("'23:59:61.00' is no time"));
}

TEST_F(Dialects, SecondsOfWeekGoOnBehindItsEnd) {
  imu(replaced(replaced(replaced(kImuRows, "\n100.00", "\n604799.99"), "\n100.01", "\n0.00"),
               "\n100.02", "\n0.01"));
  gnss("t,lat,lon,h\n604799.99,47.5,-8.25,400.5\n0.01,47.5,-8.25,400.5\n");
  run();
  EXPECT_EQ(all<ImuIncrement>().at(1).t_end_ns, gps_to_unix_ns(2201, 0.01));
  EXPECT_EQ(all<GnssFix>().at(1).t_ns, gps_to_unix_ns(2201, 0.01));
  // Back by less than a week is an error, as it was.
  gnss("t,lat,lon,h\n604799.99,47.5,-8.25,400.5\n604700,47.5,-8.25,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run(); }), HasSubstr("does not come after"));
}

TEST_F(Dialects, AStampInTheLastDayOfTheWeekIsNoEndOfIt) {
  std::string rows = "t,lat,lon,h\n";
  for (int i = 0; i < 5; ++i) {
    rows += fmt::format("{},47.5,-8.25,400.5\n", i == 2 ? 604700.0 : 100 + 0.01 * i);
  }
  gnss(rows);
  options_.skip_bad_rows = true;
  EXPECT_EQ(run().gnss.skipped, 1);
  EXPECT_EQ(all<GnssFix>().back().t_ns, gps_to_unix_ns(2200, 100.04));
}

// Units -----------------------------------------------------------------------------------------

TEST_F(Dialects, IncrementsAreNotDividedByWhatIsMissing) {
  imu("t,gx,gy,gz,ax,ay,az\n100.00,1,2,3,4,5,6\n100.01,1,2,3,4,5,6\n100.05,1,2,3,4,5,6\n");
  run("  gyro_unit: deg\n  accel_unit: m_s\n");
  const auto increments = all<ImuIncrement>();
  ASSERT_EQ(increments.size(), 3U);  // the first is as long as the second
  for (const ImuIncrement& increment : increments) {
    EXPECT_NEAR(increment.dt(), 0.01, 1e-9);
    EXPECT_TRUE(increment.dtheta_b.isApprox(Eigen::Vector3d(1, 2, 3) * kDegree, 1e-9));
    EXPECT_TRUE(increment.dvel_b.isApprox(Eigen::Vector3d(4, 5, 6), 1e-9));
  }
}

TEST_F(Dialects, IncrementsOfAnglesBesideForces) {
  imu(replaced(kImuRows, "0.5,-1.5,2,", "0.005,-0.015,0.02,"));
  run("  gyro_unit: rad\n");
  const auto increments = all<ImuIncrement>();
  ASSERT_EQ(increments.size(), 3U);
  EXPECT_TRUE(increments[1].dtheta_b.isApprox(Eigen::Vector3d(0.005, -0.015, 0.02), 1e-9));
  EXPECT_TRUE(increments[1].dvel_b.isApprox(0.01 * Eigen::Vector3d(0.25, 0.5, -9.5), 1e-9));
}

TEST_F(Dialects, UnitsOfForcesAreFoundByGravity) {
  const auto with = [&](const std::string& force) {
    imu(replaced(kImuRows, "0.25,0.5,-9.5", force));
    const ImportSummary summary = run();
    return summary.imu.notices.empty() ? "" : summary.imu.notices[0];
  };
  EXPECT_EQ(with("0.25,0.5,-9.5"), "");
  EXPECT_THAT(with("0.01,0.02,1.01"), HasSubstr("read in g;"));
  EXPECT_NEAR(all<ImuIncrement>().at(0).dvel_b.z(), 0.0101 * kStandardGravity, 1e-9);
  EXPECT_THAT(with("3,4,998"), HasSubstr("read in mg;"));
  EXPECT_THAT(with("3,4,978"), HasSubstr("read in cm_s2;"));
  EXPECT_EQ(with("1,2,3"), "");  // no gravity
  // Increments over 0.01 s: the rates are, too.
  EXPECT_THAT(with("0.001,0.002,-0.0975"), HasSubstr("read in m_s;"));
  EXPECT_TRUE(all<ImuIncrement>().at(1).dtheta_b.isApprox(Eigen::Vector3d(0.5, -1.5, 2), 1e-9));
  EXPECT_NEAR(all<ImuIncrement>().at(1).dvel_b.z(), -0.0975, 1e-9);
}

TEST_F(Dialects, IncrementsNeedStampsOfTheirOwn) {
  imu(after_header(kImuRows, "100.00,1,2,3,4,5,6\n"));
  run();  // rates come in bursts
  EXPECT_THAT(error_of<DataError>([&] { run("  gyro_unit: rad\n  accel_unit: m_s\n"); }),
              HasSubstr("imu.csv:3: the stamp"));
}

TEST_F(Dialects, CountsHaveAScale) {
  imu(replaced(replaced(kImuRows, "0.5,-1.5,2,", "50,-150,200,"), "0.25,0.5,-9.5", "25,50,-950"));
  run("  gyro_scale: 0.01\n  accel_scale: 0.01\n");
  expect_plain();
  EXPECT_THAT(error_of<UsageError>([&] { run("  gyro_scale: 0\n"); }), HasSubstr("gyro_scale"));
}

TEST_F(Dialects, UnitsOfForces) {
  imu(replaced(kImuRows, "0.25,0.5,-9.5", "25,50,-950"));
  run("  accel_unit: cm_s2\n");
  expect_plain();
  imu(replaced(kImuRows, "0.25,0.5,-9.5", "0,0,1000"));
  run("  accel_unit: mg\n");
  EXPECT_NEAR(all<ImuIncrement>().at(0).dvel_b.z(), 0.01 * kStandardGravity, 1e-9);
}

TEST_F(Dialects, UnitsOfFixes) {
  gnss("t,lat,lon,h,s,v,n,e,d,a\n100.01,475000000,-82500000,400500,250,500,100,200,-300,150\n");
  run("",
      std::string(kTime) +
          "  angle_unit: e7\n  height_unit: mm\n  velocity_unit: cm_s\n  sigma_unit: mm\n",
      "height: h, sigma_horizontal: s, sigma_vertical: v, velocity_north: n, velocity_east: e, "
      "velocity_down: d, sigma_velocity: a");
  expect_plain();
  EXPECT_LT((*fix().velocity_n - Eigen::Vector3d(1, 2, -3)).norm(), 1e-12);
  EXPECT_NEAR(fix().velocity_covariance(2, 2), 2.25, 1e-6);
  EXPECT_NEAR(std::sqrt(fix().position_covariance(2, 2)), 0.5, 1e-6);
}

TEST_F(Dialects, DetailsOfFixes) {
  gnss("t,lat,lon,h,ns,dop,age\n100.01,47.5,-8.25,400.5,14,0.75,\n");
  run("", kTime, "height: h, satellites: ns, hdop: dop, correction_age: age");
  EXPECT_EQ(fix().details.satellites, 14);
  EXPECT_EQ(fix().details.hdop, 0.75);
  EXPECT_FALSE(fix().details.correction_age);
}

TEST_F(Dialects, NotesForRuns) {
  EXPECT_FALSE(run().lever_arm_v);
  EXPECT_EQ(read_notes(options_.out).lever_arm, "unknown");
  EXPECT_EQ(read_notes(options_.out).imu.samples, imu::ImuOptions::kAsRecorded);
  EXPECT_FALSE(fix().lever_arm_known);
  reference_ = "lever_arm_m: [0, 0, 0]\n";
  run("  sensor: {samples: instantaneous, preset: tactical}\n");
  EXPECT_EQ(read_notes(options_.out).lever_arm, "given");
  EXPECT_EQ(read_notes(options_.out).imu.samples, "instantaneous");
  EXPECT_EQ(read_notes(options_.out).imu.preset, "tactical");
  EXPECT_TRUE(fix().lever_arm_known);
  reference_ = "lever_arm_m: [0, 0]\n";
  EXPECT_THAT(error_of<UsageError>([&] { run(); }), HasSubstr("give three numbers"));
}

TEST_F(Dialects, SpeedsInKnots) {
  gnss("t,lat,lon,h,s,b\n100.01,47.5,-8.25,400.5,36,90\n");
  run("", std::string(kTime) + "  velocity_unit: km_h\n  velocity_sigma_m_s: [1, 1, 1]\n",
      "height: h, speed: s, bearing: b");
  EXPECT_LT((*fix().velocity_n - Eigen::Vector3d(0, 10, 0)).norm(), 1e-12);
}

TEST_F(Dialects, DegreesAndMinutes) {
  const std::string ddmm = std::string(kTime) + "  angle_unit: ddmm\n";
  gnss("t,lat,lon,h\n100.01,4730.0,-815.0,400.5\n");
  run("", ddmm);
  expect_plain();
  EXPECT_THAT(error_of<DataError>([&] { run("", std::string(kTime) + "  angle_unit: deg\n"); }),
              HasSubstr("give gnss.angle_unit: ddmm"));
  gnss("t,lat,ns,lon,ew,h\n100.01,4730.0,N,00815.0,W,400.5\n");
  const std::string letters = "height: h, latitude_hemisphere: ns, longitude_hemisphere: ew";
  run("", ddmm, letters);
  expect_plain();
  gnss("t,lat,ns,lon,ew,h\n100.01,4730.0,X,00815.0,W,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run("", ddmm, letters); }), HasSubstr("none of N, S"));
  gnss("t,lat,lon,h\n100.01,4761.0,-815.0,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run("", ddmm); }), HasSubstr("minutes 61"));
}

TEST_F(Dialects, DegreesMinutesAndSecondsInColumns) {
  const std::string columns =
      "height: h, latitude_minutes: m, latitude_seconds: s, longitude_minutes: om, "
      "longitude_seconds: os";
  gnss("t,lat,m,s,lon,om,os,h\n100.01,47,29,60.0,-8,14,60,400.5\n");
  run("", kTime, columns);
  expect_plain();
  gnss("t,lat,m,s,lon,om,os,h\n100.01,47,30,0,-0,15,0,400.5\n");
  run("", kTime, columns);
  EXPECT_NEAR(fix().antenna.longitude, -0.25 * kDegree, 1e-12);
  gnss("t,lat,m,s,lon,om,os,h\n100.01,47,-30,0,8,15,0,400.5\n");
  EXPECT_THAT(error_of<DataError>([&] { run("", kTime, columns); }), HasSubstr("minutes -30"));
  EXPECT_THAT(
      error_of<UsageError>([&] { run("", std::string(kTime) + "  angle_unit: rad\n", columns); }),
      HasSubstr("stand beside degrees"));
}

TEST_F(Dialects, ReferenceInDegreesMinutesAndSeconds) {
  scratch_.text_file(
      "ref.txt", "t Lat_D Lat_M Lat_S Lon_D Lon_M Lon_S h V\n100.01 52 30 36 13 0 36 80000 36\n");
  reference_ =
      "reference:\n  file: ref.txt\n  columns: {time: t, latitude: Lat_D, latitude_minutes: Lat_M, "
      "latitude_seconds: Lat_S, longitude: Lon_D, longitude_minutes: Lon_M, longitude_seconds: "
      "Lon_S, height: h}\n  height_unit: mm\n" +
      std::string(kTime);
  EXPECT_EQ(run().reference->written, 1);
  const ReferencePose pose = all<ReferencePose>().at(0);
  EXPECT_NEAR(pose.position.latitude, 52.51 * kDegree, 1e-12);
  EXPECT_NEAR(pose.position.longitude, 13.01 * kDegree, 1e-12);
  EXPECT_NEAR(pose.position.height, 80, 1e-9);
}

TEST_F(Dialects, TablesWithoutAHeight) {
  gnss("t,lat,lon,s\n100.01,47.5,-8.25,0.5\n");
  const std::string columns = "sigma_horizontal: s";
  EXPECT_THAT(error_of<UsageError>([&] { run("", kTime, columns); }),
              AllOf(HasSubstr("gnss.columns.height is missing"), HasSubstr("give gnss.height_m")));
  run("", std::string(kTime) + "  height_m: 400.5\n", columns);
  expect_plain();
  const Eigen::Vector3d sigma = fix().position_covariance.diagonal().cwiseSqrt();
  EXPECT_LT((sigma - Eigen::Vector3d(0.5, 0.5, 3)).norm(), 1e-6);
}

// The mapping -----------------------------------------------------------------------------------

TEST(Mapping, HelpNamesEveryKey) {
  ImportMapping mapping;
  const std::string help = describe_config(mapping);
  for (const char* key :
       {"imu.decimal", "imu.separator", "imu.gyro_scale", "imu.accel_scale", "imu.wheel_speed_unit",
        "gnss.height_unit", "gnss.height_m", "gnss.velocity_unit", "gnss.sigma_unit",
        "reference.height_unit", "reference.velocity_unit", "wheel.speed_unit",
        "wheel.time.offset_s", "iso8601", "ddmm", "cm_s2", "knots"}) {
    EXPECT_THAT(help, HasSubstr(key));
  }
}

TEST_F(Dialects, UnknownKeysAndUnitsNameTheNearest) {
  EXPECT_THAT(error_of<UsageError>([&] { run("  gyro_scales: 2\n"); }),
              AllOf(HasSubstr("gyro_scales"), HasSubstr("imu.gyro_scale")));
  EXPECT_THAT(error_of<UsageError>([&] { run("  accel_unit: m_s3\n"); }), HasSubstr("m_s2"));
  EXPECT_THAT(error_of<UsageError>([&] { run("", kTime, "height: h, latitude_minute: m"); }),
              AllOf(HasSubstr("'latitude_minute' is no role"), HasSubstr("latitude_minutes")));
}

}  // namespace
}  // namespace foucault::rawlog
