#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/rawlog/import_raw_gnss.h"
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
using ::testing::IsEmpty;

/// A frame as the interface description has it.
std::string frame(int message_class, int id, const std::string& payload) {
  const std::string body = packed(static_cast<uint8_t>(message_class), static_cast<uint8_t>(id),
                                  static_cast<uint16_t>(payload.size())) +
                           payload;
  unsigned a = 0;
  unsigned b = 0;
  for (const char c : body) {
    a += static_cast<unsigned char>(c);
    b += a;
  }
  return "\xb5\x62" + body + packed(static_cast<uint8_t>(a), static_cast<uint8_t>(b));
}

/// 2023-01-08 (a Sunday) 10:00:00 UTC: week 2244, 10 hours and 18 leap seconds into it.
constexpr uint32_t kTow = 36'018'000;
const int64_t kUtcNs = gps_to_unix_ns(2244, 36'018);

/// NAV-PVT of that day.
struct Pvt {
  uint32_t tow = kTow;
  uint8_t minute = 0, second = 0;
  uint8_t valid = 7;
  int32_t nano = -400'000;
  uint8_t fix_type = 3, flags = 1;
  int32_t lon = 91'719'922, lat = 487'807'357, height = 320'123;
  uint32_t horizontal = 1414, vertical = 2500;
  int32_t north = 1000, east = -2000, down = 300;
  uint32_t speed_accuracy = 200;
  uint8_t flags3 = 0;

  std::string bytes() const {
    return frame(1, 7,
                 packed(tow, uint16_t{2023}, uint8_t{1}, uint8_t{8}, uint8_t{10}, minute, second,
                        valid, 20U, nano, fix_type, flags, uint8_t{0}, uint8_t{12}, lon, lat,
                        height, 270'000, horizontal, vertical, north, east, down, 2236, 0,
                        speed_accuracy, 0U, uint16_t{120}, flags3) +
                     std::string(13, '\0'));
  }
};

Pvt pvt_at(int second) {
  Pvt pvt;
  pvt.tow += static_cast<uint32_t>(1000 * second);
  pvt.minute = static_cast<uint8_t>(second / 60);
  pvt.second = static_cast<uint8_t>(second % 60);
  return pvt;
}

class Ubx : public ::testing::Test {
 protected:
  Ubx() {
    options_.rover = scratch_.path("log.ubx");
    options_.out = scratch_.path("out.rawlog");
    options_.mapping = test::imu_at_all_times(scratch_);
  }

  void with_own_imu() {
    options_.mapping.clear();
    options_.lever_arm = Eigen::Vector3d(0.5, 0.25, -1);
  }

  ImportSummary import(const std::string& bytes) {
    scratch_.text_file("log.ubx", bytes);
    return import_ubx(options_);
  }
  template <class Kind>
  std::vector<Kind> all() {
    RawlogSource source(options_.out);
    std::vector<Kind> found;
    while (const std::optional<Measurement> m = source.next()) {
      if (const Kind* one = std::get_if<Kind>(&*m)) found.push_back(*one);
    }
    return found;
  }
  GnssFix fix_of(const std::string& bytes) {
    import(bytes);
    return all<GnssFix>().at(0);
  }
  std::string data_error(const std::string& bytes) {
    const std::string what = error_of<DataError>([&] { import(bytes); });
    EXPECT_FALSE(std::filesystem::exists(options_.out));
    return what;
  }

  Scratch scratch_;
  UbxImport options_;
};

Eigen::Vector3d sigmas(const Eigen::Matrix3d& covariance) {
  return covariance.diagonal().cwiseSqrt();
}

TEST_F(Ubx, PvtIsAFix) {
  const GnssFix fix = fix_of(Pvt{}.bytes());
  EXPECT_EQ(fix.t_ns, kUtcNs - 400'000);
  EXPECT_NEAR(fix.antenna.latitude, 48.7807357 * kDegree, 1e-14);
  EXPECT_NEAR(fix.antenna.longitude, 9.1719922 * kDegree, 1e-14);
  EXPECT_NEAR(fix.antenna.height, 320.123, 1e-9);
  EXPECT_EQ(fix.quality, FixQuality::single);
  // hAcc is of north and east together.
  const double horizontal = 1.414 / std::sqrt(2);
  EXPECT_LT((sigmas(fix.position_covariance) - Eigen::Vector3d(horizontal, horizontal, 2.5)).norm(),
            1e-6);
  EXPECT_LT((*fix.velocity_n - Eigen::Vector3d(1, -2, 0.3)).norm(), 1e-12);
  EXPECT_NEAR(std::sqrt(fix.velocity_covariance(2, 2)), 0.2, 1e-7);
  EXPECT_NEAR(std::sqrt(fix.velocity_covariance(0, 0)), 0.2 / std::sqrt(2), 1e-7);
}

/// NAV-RELPOSNED of the same time: direction 123.4 deg, accuracy 0.35 deg.
std::string relposned(uint32_t flags, uint8_t version = 1, uint32_t accuracy = 35'000) {
  return frame(
      1, 0x3c,
      packed(version, uint8_t{0}, uint16_t{0}, kTow, -60, 90, 2, 108, 12'340'000, 0U, uint8_t{0},
             uint8_t{0}, uint8_t{0}, uint8_t{0}, 100U, 100U, 100U, 100U, accuracy, 0U, flags));
}

/// Fix and solution ok, valid, fixed, moving base, heading valid.
TEST_F(Ubx, HeadingOfAMovingBase) {
  constexpr uint32_t kGood = 0x1 | 0x4 | 0x10 | 0x20 | 0x100;
  const GnssFix fix = fix_of(Pvt{}.bytes() + relposned(kGood));
  ASSERT_TRUE(fix.heading);
  EXPECT_NEAR(fix.heading->azimuth, 123.4 * kDegree, 1e-9);
  EXPECT_NEAR(fix.heading->sigma, 0.35 * kDegree, 1e-12);
  for (const uint32_t missing : {0x1U, 0x4U, 0x10U, 0x20U, 0x100U})
    EXPECT_FALSE(fix_of(Pvt{}.bytes() + relposned(kGood & ~missing)).heading) << missing;
  EXPECT_FALSE(fix_of(Pvt{}.bytes() + relposned(kGood, 0)).heading);
  EXPECT_FALSE(fix_of(Pvt{}.bytes() + relposned(kGood, 1, 0)).heading);
}

TEST_F(Ubx, QualityByCarrierSolution) {
  std::string log;
  const std::vector<std::pair<int, FixQuality>> cases{{0x01, FixQuality::single},
                                                      {0x03, FixQuality::differential},
                                                      {0x43, FixQuality::float_rtk},
                                                      {0x83, FixQuality::fixed_rtk}};
  for (size_t i = 0; i < cases.size(); ++i) {
    Pvt pvt = pvt_at(static_cast<int>(i));
    pvt.flags = static_cast<uint8_t>(cases[i].first);
    log += pvt.bytes();
  }
  import(log);
  const std::vector<GnssFix> fixes = all<GnssFix>();
  ASSERT_EQ(fixes.size(), cases.size());
  for (size_t i = 0; i < cases.size(); ++i) EXPECT_EQ(fixes[i].quality, cases[i].second) << i;
}

/// 2: without height; 1: dead reckoning; 5: time only; not OK; invalidLlh.
TEST_F(Ubx, WhatIsNoFixIsCounted) {
  std::string log;
  int second = 0;
  for (const int type : {0, 1, 2, 5}) {
    Pvt pvt = pvt_at(second++);
    pvt.fix_type = static_cast<uint8_t>(type);
    log += pvt.bytes();
  }
  Pvt not_ok = pvt_at(second++);
  not_ok.flags = 0;
  Pvt invalid = pvt_at(second++);
  invalid.flags3 = 1;
  log += not_ok.bytes() + invalid.bytes();
  EXPECT_THAT(data_error(log), AllOf(HasSubstr("no usable GNSS row"), HasSubstr("6 without")));
  const ImportSummary summary = import(log + pvt_at(second).bytes());
  EXPECT_EQ(summary.gnss.written, 1);
  EXPECT_EQ(summary.gnss.without_fix, 6);
}

TEST_F(Ubx, FusedFixesAreTold) {
  Pvt pvt;
  pvt.fix_type = 4;
  EXPECT_THAT(import(pvt.bytes()).gnss.notices, Contains(HasSubstr("1 fixes are fused")));
  EXPECT_THAT(import(Pvt{}.bytes()).gnss.notices, IsEmpty());
}

/// Until it knows better, a receiver may take 16 leap seconds for 18: iTOW is GPS time.
TEST_F(Ubx, LeapSecondsAreOurs) {
  Pvt pvt;
  pvt.second = 2;
  pvt.valid = 3;
  EXPECT_EQ(fix_of(pvt.bytes()).t_ns, kUtcNs - 400'000);
}

TEST_F(Ubx, OverTheEndOfTheWeek) {
  Pvt before;
  before.tow = 604'799'900;
  before.valid = 0;  // of no date: takes that of the next
  Pvt after;
  after.tow = 100;
  const auto timegps = frame(1, 0x20, packed(100U, 300, int16_t{2244}, int8_t{18}, uint8_t{7}, 5U));
  import(before.bytes() + after.bytes() + timegps);
  const auto fixes = all<GnssFix>();
  ASSERT_EQ(fixes.size(), 2U);
  EXPECT_EQ(fixes[0].t_ns, gps_to_unix_ns({2243, 604'799'900'000'000}));
  EXPECT_EQ(fixes[1].t_ns, gps_to_unix_ns({2244, 100'000'300}));
}

TEST_F(Ubx, WithoutADate) {
  Pvt pvt;
  pvt.valid = 0;
  EXPECT_THAT(data_error(pvt.bytes()), AllOf(HasSubstr("has no date"), HasSubstr("NAV-PVT")));
}

/// Whatever their order within the epoch.
TEST_F(Ubx, HighPrecisionAndCovariancesOfTheEpoch) {
  const std::string precise =
      frame(1, 0x14,
            packed(uint8_t{0}, uint8_t{0}, uint8_t{0}, uint8_t{0}, kTow, 91'719'922, 487'807'357,
                   320'123, 270'000, int8_t{-21}, int8_t{34}, int8_t{-5}, int8_t{3}, 141U, 180U));
  const std::string covariances =
      frame(1, 0x36,
            packed(kTow, uint8_t{0}, uint8_t{1}, uint8_t{1}) + std::string(9, '\0') +
                packed(0.9F, 0.2F, -0.1F, 1.1F, 0.3F, 4.0F, 0.02F, 0.001F, -0.002F, 0.03F, 0.004F,
                       0.06F));
  for (const std::string& log : {precise + Pvt{}.bytes() + covariances,
                                 covariances + Pvt{}.bytes() + precise + pvt_at(1).bytes()}) {
    const GnssFix fix = fix_of(log);
    EXPECT_NEAR(fix.antenna.latitude / kDegree, 48.780735734, 1e-12);
    EXPECT_NEAR(fix.antenna.longitude / kDegree, 9.171992179, 1e-12);
    EXPECT_NEAR(fix.antenna.height, 320.1225, 1e-9);
    Eigen::Matrix3d position;
    position << 0.9, 0.2, -0.1, 0.2, 1.1, 0.3, -0.1, 0.3, 4.0;
    EXPECT_LT((fix.position_covariance - position).cwiseAbs().maxCoeff(), 1e-6);  // float
    Eigen::Matrix3d velocity;
    velocity << 0.02, 0.001, -0.002, 0.001, 0.03, 0.004, -0.002, 0.004, 0.06;
    EXPECT_LT((fix.velocity_covariance - velocity).cwiseAbs().maxCoeff(), 1e-6);
  }
  EXPECT_NEAR(std::sqrt(fix_of(Pvt{}.bytes() + precise).position_covariance(2, 2)), 0.018, 1e-7);
  const std::string invalid =
      frame(1, 0x14,
            packed(uint8_t{0}, uint8_t{0}, uint8_t{0}, uint8_t{1}, kTow) + std::string(28, '\0'));
  EXPECT_NEAR(fix_of(invalid + Pvt{}.bytes()).antenna.height, 320.123, 1e-9);
}

/// Covariances that are not positive, or flagged so, are not taken.
TEST_F(Ubx, CovariancesThatAreNone) {
  const auto covariances = [](uint8_t valid, float north) {
    return frame(1, 0x36,
                 packed(kTow, uint8_t{0}, valid, valid) + std::string(9, '\0') +
                     packed(north, 0.2F, -0.1F, 1.1F, 0.3F, 4.0F, 0.02F, 0.001F, -0.002F, 0.03F,
                            0.004F, 0.06F));
  };
  for (const std::string& none : {covariances(0, 0.9F), covariances(1, 0.0F)}) {
    EXPECT_NEAR(std::sqrt(fix_of(Pvt{}.bytes() + none).position_covariance(2, 2)), 2.5, 1e-6);
  }
}

TEST_F(Ubx, OlderReceivers) {
  const std::string posllh =
      frame(1, 2, packed(kTow, 91'719'922, 487'807'357, 320'123, 270'000, 1414U, 2500U));
  const std::string velned = frame(1, 0x12, packed(kTow, 100, -200, 30, 226U, 224U, 0, 20U, 100U));
  const std::string status =
      frame(1, 3, packed(kTow, uint8_t{3}, uint8_t{3}, uint8_t{0}, uint8_t{0}, 1000U, 5000U));
  const std::string timeutc = frame(1, 0x21,
                                    packed(kTow, 20U, 1000, uint16_t{2023}, uint8_t{1}, uint8_t{8},
                                           uint8_t{10}, uint8_t{0}, uint8_t{0}, uint8_t{7}));
  const GnssFix fix = fix_of(posllh + velned + status + timeutc);
  EXPECT_EQ(fix.t_ns, kUtcNs + 1000);
  EXPECT_NEAR(fix.antenna.height, 320.123, 1e-9);
  EXPECT_LT((*fix.velocity_n - Eigen::Vector3d(1, -2, 0.3)).norm(), 1e-12);
  EXPECT_EQ(fix.quality, FixQuality::differential);
  EXPECT_NEAR(std::sqrt(fix.velocity_covariance(2, 2)), 0.2, 1e-7);
}

TEST_F(Ubx, SolAlone) {
  const Geodetic place{48.78 * kDegree, 9.17 * kDegree, 320};
  const Eigen::Vector3d p_e = geodesy::wgs84::geodetic_to_ecef(place) * 100;
  const Eigen::Vector3d v_e =
      geodesy::wgs84::R_e_n(place.latitude, place.longitude) * Eigen::Vector3d(300, 400, -50);
  const auto whole = [](double value) { return static_cast<int32_t>(std::lround(value)); };
  const GnssFix fix =
      fix_of(frame(1, 6,
                   packed(kTow, -1500, int16_t{2244}, uint8_t{3}, uint8_t{0xd}, whole(p_e.x()),
                          whole(p_e.y()), whole(p_e.z()), 300U, whole(v_e.x()), whole(v_e.y()),
                          whole(v_e.z()), 25U, uint16_t{200}, uint8_t{0}, uint8_t{9}, 0U)));
  EXPECT_EQ(fix.t_ns, kUtcNs - 1500);
  EXPECT_NEAR(fix.antenna.height, 320, 0.01);
  EXPECT_NEAR(fix.antenna.latitude / kDegree, 48.78, 1e-7);
  EXPECT_LT((*fix.velocity_n - Eigen::Vector3d(3, 4, -0.5)).norm(), 0.01);
  EXPECT_NEAR(std::sqrt(fix.position_covariance(2, 2)), 3, 1e-6);
}

/// NMEA and RTCM between, a false sync, a byte changed, a message cut off.
TEST_F(Ubx, DamageLosesItsMessageOnly) {
  std::string damaged = pvt_at(1).bytes();
  damaged[50] ^= 1;
  const std::string nmea = "$GNGGA,,,,,,0,00,99.99,,,,,,*56\r\n";
  const std::string log = nmea + pvt_at(0).bytes() + damaged + "\xd3\x00\xb5" + pvt_at(2).bytes() +
                          pvt_at(3).bytes().substr(0, 60);
  const ImportSummary summary = import(log);
  EXPECT_EQ(summary.gnss.written, 2);
  EXPECT_THAT(summary.gnss.notices,
              Contains(AllOf(HasSubstr("left out 1 of 3 UBX messages"),
                             HasSubstr("byte " + std::to_string(nmea.size() + 100)))));
  EXPECT_THAT(summary.gnss.notices, Contains(HasSubstr("cut off")));
  EXPECT_THAT(summary.gnss.notices, Contains(HasSubstr("passed over")));
}

TEST_F(Ubx, ErrorsAreOneLineWithTheByte) {
  EXPECT_THAT(data_error("no UBX at all"), HasSubstr("has no UBX message"));
  const std::string good = Pvt{}.bytes();
  EXPECT_THAT(
      data_error(good + frame(1, 7, packed(kTow, uint16_t{2023}))),
      AllOf(HasSubstr("log.ubx: byte 100: "), HasSubstr("too few"), HasSubstr("--skip-bad-rows")));
  EXPECT_THAT(data_error(good + frame(1, 2, packed(700'000'000U))),
              HasSubstr("lies outside its week"));
  Pvt blind = pvt_at(1);
  blind.horizontal = 4'294'967'295U;
  EXPECT_THAT(data_error(good + blind.bytes()), AllOf(HasSubstr("byte 100: "), HasSubstr("hAcc")));
  EXPECT_THAT(data_error(good + good + pvt_at(-1).bytes()),
              HasSubstr("does not come after the one before"));
}

// Its own IMU -------------------------------------------------------------------------------------

uint32_t word(int type, double value, double unit) {
  return static_cast<uint32_t>(type) << 24U |
         (static_cast<uint32_t>(std::lround(value / unit)) & 0xffffffU);
}

/// One sample of ESF-RAW: rates in deg/s and forces.
std::string raw_sample(uint32_t tag, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
  std::string bytes;
  const int gyro_types[] = {14, 13, 5};
  for (int i = 0; i < 3; ++i) bytes += packed(word(16 + i, accel[i], 0x1p-10), tag);
  for (int i = 0; i < 3; ++i) bytes += packed(word(gyro_types[i], gyro[i], 0x1p-12), tag);
  return bytes + packed(word(12, 25, 0.01), tag);
}

const Eigen::Vector3d kGyro(-1.5, 2, -0.25);       // [deg/s]
const Eigen::Vector3d kAccel(0.5, -0.25, 9.8125);  // z looks up

std::string nav_status(uint32_t tow, uint32_t clock_ms) {
  return frame(1, 3,
               packed(tow, uint8_t{3}, uint8_t{0xd}, uint8_t{0}, uint8_t{0}, 1000U, clock_ms));
}

/// 100 Hz, ten samples a message; clock 20 s at kTow; the sensor counts 0.2 % too fast and over the
/// end of its 24 bits. Fixes come 0.3 s late.
std::string raw_log(bool with_status) {
  constexpr double kTick = 39.0625e-6 / 1.002;
  constexpr uint32_t kFirstTag = (1U << 24U) - 100'000;
  std::string log;
  for (uint32_t message = 0; message < 300; ++message) {
    std::string body = packed(20'000 + 100 * message);
    for (uint32_t i = 0; i < 10; ++i) {
      const double since = 0.1 * message + 0.01 * i;
      body +=
          raw_sample((kFirstTag + static_cast<uint32_t>(since / kTick)) & 0xffffffU, kGyro, kAccel);
    }
    log += frame(0x10, 3, body);
    if (message % 10 != 2) continue;
    const int second = static_cast<int>(message) / 10;
    log += pvt_at(second).bytes();
    if (with_status) log += nav_status(pvt_at(second).tow, 20'000 + 1000 * message / 10 - 200);
  }
  return log;
}

TEST_F(Ubx, OwnImu) {
  with_own_imu();
  const ImportSummary summary = import(raw_log(true));
  EXPECT_EQ(summary.imu.written, 3000);
  EXPECT_THAT(summary.imu.notices, IsEmpty());
  const auto increments = all<ImuIncrement>();
  double total = 0;
  for (size_t i = 0; i < increments.size(); ++i) {
    const ImuIncrement& one = increments[i];
    total += one.dt();
    ASSERT_NEAR(one.dt(), 0.01, 1.2e-4) << i;  // ticks of 39 us, clocks of 1 ms smoothed
    ASSERT_LT((one.dtheta_b / one.dt() - kGyro * kDegree).norm(), 1e-6);
    ASSERT_LT((one.dvel_b / one.dt() - kAccel).norm(), 1e-3);
  }
  EXPECT_NEAR(total, 30, 1e-3);
  // The clock's 20 s stand at the first epoch.
  EXPECT_NEAR(static_cast<double>(increments.front().t_end_ns - kUtcNs), 0, 0.2e6);
  RawlogSource source(options_.out);
  EXPECT_LT((source.mounting().q_v_b * kAccel - Eigen::Vector3d(0.5, 0.25, -9.8125)).norm(), 1e-9);
  EXPECT_LT((source.lever_arm() - source.mounting().q_v_b.conjugate() * *options_.lever_arm).norm(),
            1e-9);
}

TEST_F(Ubx, OwnImuWithoutAClock) {
  with_own_imu();
  const ImportSummary summary = import(raw_log(false));
  EXPECT_THAT(summary.imu.notices, Contains(HasSubstr("no NAV-STATUS")));
  // By the order: the fix comes behind the sample of 0.29 s after it.
  EXPECT_NEAR(static_cast<double>(all<ImuIncrement>().front().t_end_ns - kUtcNs), -290e6, 1e6);
}

TEST_F(Ubx, OwnImuNeedsALeverArm) {
  options_.mapping.clear();
  EXPECT_THAT(error_of<UsageError>([&] { import(raw_log(true)); }), HasSubstr("--lever-arm"));
}

/// Gyroscope and accelerometer in two messages, 5 ms apart; wheel ticks between; one is lost.
TEST_F(Ubx, MeansOfTheImu) {
  with_own_imu();
  std::string log;
  for (uint32_t i = 0; i < 50; ++i) {
    const uint32_t clock_ms = 20'000 + 100 * i;
    const auto meas = [](uint32_t clock, const std::string& words) {
      const auto count = static_cast<uint16_t>(words.size() / 4);
      return frame(0x10, 2,
                   packed(clock, static_cast<uint16_t>(count << 11U | 0x18U), uint16_t{0}) + words +
                       packed(clock));
    };
    if (i != 20) {
      log += meas(clock_ms + 5, packed(word(16, kAccel.x(), 0x1p-10), word(17, kAccel.y(), 0x1p-10),
                                       word(18, kAccel.z(), 0x1p-10)));
    }
    log += meas(clock_ms + 50, packed(word(10, 0, 1)));
    log += meas(clock_ms - 5, packed(word(14, kGyro.x(), 0x1p-12), word(13, kGyro.y(), 0x1p-12),
                                     word(5, kGyro.z(), 0x1p-12), word(12, 25, 0.01)));
    if (i % 10 == 0)
      log += pvt_at(static_cast<int>(i / 10)).bytes() + nav_status(kTow + 100 * i, clock_ms);
  }
  const ImportSummary summary = import(log);
  EXPECT_EQ(summary.imu.written, 49);
  EXPECT_THAT(summary.imu.notices, Contains(HasSubstr("ESF-MEAS")));
  const ImuIncrement first = all<ImuIncrement>().front();
  EXPECT_NEAR(static_cast<double>(first.t_end_ns - kUtcNs), 50e6, 1e6);
  EXPECT_NEAR(first.dt(), 0.1, 1e-6);
  EXPECT_LT((first.dvel_b / first.dt() - kAccel).norm(), 1e-3);
}

// A recording -------------------------------------------------------------------------------------

/// Of a train's receiver, written as hexadecimal among the lines of its IMU.
TEST_F(Ubx, Train) {
  const std::string path = test::data_dir() + "/raw_fixtures/train_etr103_sample.csv";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << "no " << path << "; set FOUCAULT_DATA_DIR";
  }
  std::string log;
  std::istringstream lines(test::contents(path));
  for (std::string line; std::getline(lines, line);) {
    const size_t message = line.find(",U,");
    if (message == std::string::npos) continue;
    for (size_t at = message + 3; at + 1 < line.size(); at += 2) {
      log += static_cast<char>(std::stoi(line.substr(at, 2), nullptr, 16));
    }
  }
  const ImportSummary summary = import(log);
  EXPECT_EQ(summary.qualities.at(FixQuality::differential), 2);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(utc_text(fix.t_ns), "2022-10-20T09:06:05.000Z");
  const Eigen::Matrix3d& covariance = fix.position_covariance;
  EXPECT_NEAR(covariance(0, 1), 0.203238, 1e-6);  // NAV-COV's
  // hAcc of the PVT beside it, 1.418 m, is of north and east together; vAcc 2.136 m of down.
  EXPECT_NEAR(std::sqrt(covariance(0, 0) + covariance(1, 1)), 1.418, 5e-4);
  EXPECT_NEAR(std::sqrt(covariance(2, 2)), 2.136, 5e-4);
}

}  // namespace
}  // namespace foucault::rawlog
