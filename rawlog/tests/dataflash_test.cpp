#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/rawlog/import_dataflash.h"
#include "foucault/rawlog/rawlog_source.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::error_of;
using test::packed;
using test::Scratch;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::string padded(std::string text, size_t count) {
  text.resize(count, '\0');
  return text;
}

std::string message(uint8_t type, const std::string& body) {
  return packed('\xa3', '\x95', type) + body;
}

std::string fmt_of(uint8_t type, uint8_t length, const std::string& name, const std::string& types,
                   const std::string& columns) {
  return message(128,
                 packed(type, length) + padded(name, 4) + padded(types, 16) + padded(columns, 64));
}

constexpr uint64_t kBoot = 20'000'000;  // [us]
constexpr int kWeek = 2046;
constexpr uint32_t kMs = 312'816'600;  ///< at kBoot, of the week
int64_t stamp_at(uint32_t after_ms) { return gps_to_unix_ns(kWeek, (kMs + after_ms) / 1000.0); }

/// Messages as ArduCopter 3.6 writes them.
class Dataflash : public ::testing::Test {
 protected:
  Dataflash() {
    options_.log = scratch_.path("flight.bin");
    options_.out = scratch_.path("out.rawlog");
    options_.lever_arm = Eigen::Vector3d(0.1, -0.2, -0.3);
    log_ = fmt_of(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns") +
           fmt_of(129, 31, "PARM", "QNf", "TimeUS,Name,Value") +
           fmt_of(46, 46, "GPS", "QBIHBcLLefffB",
                  "TimeUS,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,U") +
           fmt_of(24, 24, "GPA", "QCCCCBI", "TimeUS,VDop,HAcc,VAcc,SAcc,VV,SMS") +
           fmt_of(53, 35, "IMU", "Qffffff", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ") +
           fmt_of(54, 35, "IMU2", "Qffffff", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ") +
           fmt_of(55, 47, "IMT", "Qfffffffff", "TimeUS,DelT,DelvT,DelaT,DAX,DAY,DAZ,DVX,DVY,DVZ");
  }

  void imu(uint64_t after_us, uint8_t type = 53) {
    log_ += message(type, packed(kBoot + after_us, 0.1F, 0.2F, -0.3F, 1.0F, -2.0F, -9.75F));
  }
  void gps(uint32_t after_ms, uint8_t status = 3, uint64_t delay_us = 100'000,
           uint16_t week = kWeek) {
    log_ += message(
        46, packed(kBoot + 1000U * after_ms + delay_us, status, kMs + after_ms, week, uint8_t{18},
                   int16_t{150}, 422'923'858, -713'657'172, 4736, 5.0F, 90.0F, -0.5F, uint8_t{1}));
  }
  void gpa(uint32_t after_ms, uint8_t vertical = 1) {
    log_ += message(24, packed(kBoot + 1000U * after_ms + 100'000, uint16_t{108}, uint16_t{75},
                               uint16_t{142}, uint16_t{31}, vertical, 0U));
  }
  void parameter(const std::string& name, float value) {
    log_ += message(129, packed(kBoot) + padded(name, 16) + packed(value));
  }

  /// Two seconds of 50 Hz and 5 Hz.
  void fly() {
    for (uint32_t ms = 20; ms <= 2000; ms += 20) {
      imu(1000 * ms);
      if (ms % 200 == 0) gps(ms);
    }
  }

  ImportSummary import() {
    scratch_.text_file("flight.bin", log_);
    return import_dataflash(options_);
  }
  std::string data_error() {
    const std::string what = error_of<DataError>([&] { import(); });
    EXPECT_FALSE(std::filesystem::exists(options_.out));
    return what;
  }
  template <class Kind>
  std::vector<Kind> all() {
    RawlogSource source(options_.out, imu::SampleKind::interval_mean);
    std::vector<Kind> found;
    while (const std::optional<Measurement> m = source.next()) {
      if (const Kind* one = std::get_if<Kind>(&*m)) found.push_back(*one);
    }
    return found;
  }

  Scratch scratch_;
  DataflashImport options_;
  std::string log_;
};

TEST_F(Dataflash, Values) {
  fly();
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 100);
  EXPECT_EQ(summary.gnss.written, 10);
  EXPECT_EQ(summary.with_velocity, 10);
  EXPECT_THAT(summary.gnss.notices,
              AllOf(Contains(HasSubstr("above the sea")), Contains(HasSubstr("1.7 m assumed"))));
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns, stamp_at(200));
  EXPECT_EQ(fix.quality, FixQuality::single);
  EXPECT_NEAR(fix.antenna.latitude, 42.2923858 * kDegree, 1e-15);
  EXPECT_NEAR(fix.antenna.longitude, -71.3657172 * kDegree, 1e-15);
  EXPECT_NEAR(fix.antenna.height, 47.36, 1e-9);
  EXPECT_LT((*fix.velocity_n - Eigen::Vector3d(0, 5, -0.5)).norm(), 1e-6);
  const Eigen::Vector3d sigma = fix.position_covariance.diagonal().cwiseSqrt();
  EXPECT_LT((sigma - Eigen::Vector3d(2.55, 2.55, 5.1)).norm(), 1e-5);
  const ImuIncrement increment = all<ImuIncrement>().at(0);  // up to the second sample
  EXPECT_LT((increment.dtheta_b / 0.02 - Eigen::Vector3d(0.1, 0.2, -0.3)).norm(), 1e-6);
  EXPECT_LT((increment.dvel_b / 0.02 - Eigen::Vector3d(1, -2, -9.75)).norm(), 1e-6);
  // The clock since boot stands for the time of reception, 0.1 s late.
  EXPECT_NEAR(seconds_between(increment.t_end_ns, stamp_at(40)), 0.1, 1e-5);
}

TEST_F(Dataflash, AccuraciesComeBehindTheirFix) {
  fly();
  gps(2200);
  gpa(2200);
  gps(2400, 6);
  gpa(2400, 0);
  gpa(9999);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.qualities.at(FixQuality::fixed_rtk), 1);
  const auto fixes = all<GnssFix>();
  ASSERT_EQ(fixes.size(), 12U);
  const Eigen::Vector3d sigma = fixes[10].position_covariance.diagonal().cwiseSqrt();
  EXPECT_LT((sigma - Eigen::Vector3d(0.75, 0.75, 1.42)).norm(), 1e-6);
  EXPECT_NEAR(std::sqrt(fixes[10].velocity_covariance(2, 2)), 0.31, 1e-5);
  EXPECT_NEAR(std::sqrt(fixes[11].velocity_covariance(0, 0)), 0.31, 1e-5);
  EXPECT_GT(std::sqrt(fixes[11].velocity_covariance(2, 2)), 5);
}

TEST_F(Dataflash, WithoutAFixAndOtherStates) {
  fly();
  for (const uint8_t status : {0, 1, 2, 4, 5}) gps(2000 + 200U * (status + 1U), status);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.gnss.without_fix, 3);
  EXPECT_EQ(summary.qualities.at(FixQuality::differential), 1);
  EXPECT_EQ(summary.qualities.at(FixQuality::float_rtk), 1);
}

/// As ArduCopter 3.1 writes them: milliseconds, T of the clock since boot, another order.
TEST_F(Dataflash, OldNames) {
  log_ = fmt_of(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format") +
         fmt_of(130, 45, "GPS", "BIHBcLLeeEefI",
                "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T") +
         fmt_of(131, 31, "IMU", "Iffffff", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
  for (uint32_t ms = 20; ms <= 1000; ms += 20) {
    log_ += message(131, packed(20'000 + ms, 0.1F, 0.2F, -0.3F, 1.0F, -2.0F, -9.75F));
    if (ms % 200 != 0) continue;
    log_ += message(
        130, packed(uint8_t{3}, kMs + ms, static_cast<uint16_t>(kWeek), uint8_t{10}, int16_t{168},
                    301'557'346, -979'575'471, -531, 29'788, 300U, -9000, 0.25F, 20'000 + ms));
  }
  EXPECT_EQ(import().imu.written, 50);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns, stamp_at(200));
  EXPECT_NEAR(fix.antenna.height, 297.88, 1e-9);
  EXPECT_LT((*fix.velocity_n - Eigen::Vector3d(0, -3, 0.25)).norm(), 1e-6);
  EXPECT_NEAR(seconds_between(all<ImuIncrement>().at(8).t_end_ns, fix.t_ns), 0, 1e-9);
}

/// Of text, values are in their units already.
TEST_F(Dataflash, TextLogs) {
  log_ =
      "58\n\nArduCopter V3.1.2\nFree RAM: 1273\n"
      "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format\r\n"
      "FMT, 129, 23, PARM, Nf, Name,Value\r\n"
      "FMT, 130, 45, GPS, BIHBcLLeeEefI, "
      "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T\r\n"
      "FMT, 131, 31, IMU, Iffffff, TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\r\n"
      "PARM, GPS_POS1_X, 0.500000\nPARM, GPS_POS1_Y, 0.0\nPARM, GPS_POS1_Z, -0.25\n";
  for (uint32_t ms = 20; ms <= 1000; ms += 20) {
    log_ += fmt::format("IMU, {}, 0.1, 0.2, -0.3, 1.0, -2.0, -9.75\n", 69'141 + ms);
    if (ms % 200 != 0) continue;
    log_ += fmt::format(
        "GPS, 3, {}, 1774, 9, 2.42, -39.4950311, 176.7483503, -0.03, 46.87, 0.05, 202.77, "
        "0.110000, {}\r\nMODE, LOITER, 494\n",
        109'216'200 + ms, 69'141 + ms);
  }
  options_.lever_arm.reset();
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 50);
  EXPECT_LT((summary.lever_arm_v.value() - Eigen::Vector3d(0.5, 0, -0.25)).norm(), 1e-9);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns, gps_to_unix_ns(1774, 109'216.4));
  EXPECT_NEAR(fix.antenna.latitude, -39.4950311 * kDegree, 1e-15);
  EXPECT_NEAR(fix.antenna.height, 46.87, 1e-9);
  EXPECT_NEAR(fix.velocity_n->norm(), std::hypot(0.05, 0.11), 1e-6);
  const std::string good = log_;
  log_ = good + "IMU, 70300, 0.1, 0.2\n";
  EXPECT_THAT(error_of<DataError>([&] { import(); }),
              HasSubstr(fmt::format("byte {}: the IMU has 3 values, too few", good.size())));
  log_ = good + "IMU, 70300, 0.1, x, 0, 0, 0, 0\n";
  EXPECT_THAT(error_of<DataError>([&] { import(); }), HasSubstr("'x', which is no number"));
}

/// IMT without holes comes first, thinned out it does not.
TEST_F(Dataflash, DeltaAngles) {
  const std::string formats = log_;
  for (const float interval : {0.02F, 0.01F}) {
    log_ = formats;
    fly();
    for (uint64_t us = 20'000; us <= 2'000'000; us += 20'000) {
      log_ += message(55, packed(kBoot + us, 0.02F, interval / 2, interval, 1e-3F, 2e-3F, 3e-3F,
                                 0.01F, 0.02F, -0.1F));
    }
    import();
    const ImuIncrement increment = all<ImuIncrement>().at(5);
    const bool used = interval == 0.02F;
    EXPECT_NEAR(increment.dtheta_b.x(), used ? 1e-3 : 2e-3, 1e-8);
    EXPECT_NEAR(increment.dvel_b.z(), used ? -0.2 : -0.195, 1e-6);
  }
}

/// The second receiver and IMU where the first are not there.
TEST_F(Dataflash, Instances) {
  log_ += fmt_of(47, 47, "GPS", "QBBIHBcLLefffB",
                 "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,U");
  for (uint32_t ms = 20; ms <= 2000; ms += 20) {
    imu(1000 * ms, 54);
    for (const uint8_t instance : {uint8_t{0}, uint8_t{1}}) {
      if (ms % 200 != 0) continue;
      log_ += message(
          47, packed(kBoot + 1000U * ms, instance, static_cast<uint8_t>(3 * instance), kMs + ms,
                     static_cast<uint16_t>(kWeek), uint8_t{18}, int16_t{150}, 422'923'858,
                     -713'657'172, 4736 + instance, 5.0F, 90.0F, -0.5F, uint8_t{1}));
    }
  }
  parameter("GPS_POS2_X", 0.5F);
  parameter("GPS_POS2_Y", 0.25F);
  parameter("GPS_POS2_Z", -1);
  parameter("INS_POS2_X", 0.25F);
  options_.lever_arm.reset();
  const ImportSummary summary = import();
  EXPECT_EQ(summary.gnss.written, 10);
  EXPECT_EQ(summary.imu.written, 100);
  EXPECT_LT((summary.lever_arm_v.value() - Eigen::Vector3d(0.25, 0.25, -1)).norm(), 1e-6);
  EXPECT_NEAR(all<GnssFix>().at(0).antenna.height, 47.37, 1e-9);
}

TEST_F(Dataflash, LeverArmOfTheParameters) {
  fly();
  options_.lever_arm.reset();
  for (const char* axis : {"X", "Y", "Z"}) parameter(fmt::format("GPS_POS1_{}", axis), 0);
  EXPECT_THAT(error_of<UsageError>([&] { import(); }), HasSubstr("give --lever-arm"));
}

TEST_F(Dataflash, BytesThatAreNoMessage) {
  fly();
  const std::string good = log_;
  const size_t middle = good.rfind("\xa3\x95\x35");
  log_ = good.substr(0, middle) + std::string("\xa3\x95\x35\0\0\xff", 6) + good.substr(middle);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 100);
  EXPECT_THAT(summary.gnss.notices,
              Contains(HasSubstr(fmt::format("6 bytes in 1 places that are no message; the first "
                                             "at byte {}",
                                             middle))));
  log_ = good + std::string("\xa3\x95\x35\x01\x02", 5);  // the battery was pulled
  EXPECT_THAT(import().gnss.notices, Contains(HasSubstr("5 bytes in 1 places")));
  EXPECT_EQ(import().imu.written, 100);
  log_ = good + std::string(1000, '\xff');
  EXPECT_THAT(import().gnss.notices, Contains(HasSubstr("1000 bytes in 1 places")));
}

/// A flight of ArduCopter 3.1, joeydouglas/dataflash_logs "2014-10-18 21-19-07.bin". Not in the
/// repository for its size.
TEST_F(Dataflash, ARealFlight) {
  options_.log = test::data_dir() + "/raw_fixtures/ardupilot_copter.bin";
  // Not everywhere: the tests above prove the importer on logs that they write.
  if (!std::filesystem::exists(options_.log)) {
    GTEST_SKIP() << "no " << options_.log << "; set FOUCAULT_DATA_DIR";
  }
  const ImportSummary summary = import_dataflash(options_);
  EXPECT_EQ(summary.imu.written, 3672);
  EXPECT_EQ(summary.gnss.written, 368);
  EXPECT_EQ(summary.with_velocity, 368);
  EXPECT_THAT(summary.gnss.notices, Contains(HasSubstr("8 bytes in 1 places")));
}

TEST_F(Dataflash, DamageIsOneLine) {
  const std::string formats = log_;
  log_ = "no such log";
  EXPECT_THAT(data_error(), HasSubstr("no DataFlash log of ArduPilot"));
  log_ = formats;
  gps(200);
  EXPECT_THAT(data_error(), HasSubstr("has no IMU messages"));
  log_ = formats;
  imu(20'000);
  gps(200, 1);
  EXPECT_THAT(data_error(), HasSubstr("no GPS messages with a fix"));
  log_ = formats;
  fly();
  const std::string good = log_;
  const size_t byte = log_.size();
  log_ += message(53, packed(kBoot + 2'020'000, std::nanf(""), 0.2F, -0.3F, 1.0F, -2.0F, -9.75F));
  EXPECT_THAT(data_error(), HasSubstr(fmt::format("flight.bin: byte {}: the IMU has a GyrX that is "
                                                  "not finite",
                                                  byte)));
  options_.skip_bad_rows = true;
  EXPECT_EQ(import().imu.skipped, 1);
  options_.skip_bad_rows = false;
  std::filesystem::remove(options_.out);
  log_ = good + fmt_of(128, 20, "FMT", "B", "Type");
  EXPECT_THAT(data_error(), HasSubstr("a format FMT of type 128 and 20 bytes"));
  log_ = good + fmt_of(53, 11, "IMU", "Qf", "TimeUS,GyrX") + message(53, packed(kBoot));
  EXPECT_THAT(data_error(), HasSubstr("the IMU is shorter than its format"));
}

}  // namespace
}  // namespace foucault::rawlog
