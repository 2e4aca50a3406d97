#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/rawlog/import_ulog.h"
#include "foucault/rawlog/rawlog_source.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

template <class... T>
std::string packed(const T&... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}

/// Writes what docs.px4.io says of the format.
struct Log {
  std::string bytes{"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0", 16};

  void message(char type, const std::string& body) {
    bytes += packed(static_cast<uint16_t>(body.size()), type) + body;
  }
  void flags(uint8_t incompatible, uint64_t appended) {
    std::string body(40, '\0');
    body[8] = static_cast<char>(incompatible);
    std::memcpy(&body[16], &appended, sizeof appended);
    message('B', body);
  }
  void subscribe(uint16_t id, const std::string& topic) {
    message('A', packed(uint8_t{0}, id) + topic);
  }
  void parameter(const std::string& name, float value) {
    const std::string key = "float " + name;
    message('P', packed(static_cast<uint8_t>(key.size())) + key + packed(value));
  }
  void data(uint16_t id, const std::string& body) { message('D', packed(id) + body); }
};

constexpr uint64_t kBoot = 20'000'000;            // [us]
constexpr uint64_t kUtc = 1'618'986'658'000'000;  // [us] at kBoot
constexpr const char* kImuFormat =
    "vehicle_imu:uint64_t timestamp;uint64_t timestamp_sample;float[3] delta_angle;float[3] "
    "delta_velocity;uint16_t delta_angle_dt;uint16_t delta_velocity_dt;uint8_t[4] _padding0;";
constexpr const char* kCombinedFormat =
    "sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t "
    "accelerometer_timestamp_relative;float[3] accelerometer_m_s2;uint32_t "
    "accelerometer_integral_dt;";
constexpr const char* kOldGnss =
    "vehicle_gps_position:uint64_t timestamp;uint64_t time_utc_usec;int32_t lat;int32_t lon;"
    "int32_t alt;int32_t alt_ellipsoid;float s_variance_m_s;float eph;float epv;float vel_n_m_s;"
    "float vel_e_m_s;float vel_d_m_s;int32_t timestamp_time_relative;uint8_t fix_type;"
    "bool vel_ned_valid;";
constexpr const char* kNewGnss =
    "place:double latitude_deg;double longitude_deg;double altitude_msl_m;double "
    "altitude_ellipsoid_m;";

/// A log of 200 Hz and 5 Hz; its messages are changed by the tests.
class Ulog : public ::testing::Test {
 protected:
  Ulog() {
    options_.log = scratch_.path("log.ulg");
    options_.out = scratch_.path("out.rawlog");
    options_.lever_arm = Eigen::Vector3d(0.1, -0.2, -0.3);
  }

  void begin(uint64_t appended = 0) {
    log_.flags(appended > 0 ? 1 : 0, appended);
    for (const char* format : {kImuFormat, kCombinedFormat, kOldGnss}) log_.message('F', format);
    log_.subscribe(0, "vehicle_imu");
    log_.subscribe(1, "sensor_combined");
    log_.subscribe(2, "vehicle_gps_position");
  }

  /// Increments over 5 ms that end at t; those of velocity over 4 ms.
  void increment(uint64_t t) {
    log_.data(0, packed(t + 100, t, 1e-3F, 2e-3F, -3e-3F, 0.004F, 0.008F, -0.04F, uint16_t{5000},
                        uint16_t{4000}));
  }
  void combined(uint64_t t) {
    log_.data(1, packed(t, 0.1F, 0.2F, 0.3F, 5000U, 0, 1.0F, 2.0F, -9.8F, 5000U));
  }
  void fix(uint64_t t, uint64_t utc, int ellipsoidal_mm = 106'766, uint8_t type = 6) {
    log_.data(2, packed(t, utc, 634'170'622, 104'082'151, 66'000, ellipsoidal_mm, 0.5F, 1.5F, 2.5F,
                        1.0F, -2.0F, 0.25F, -1000, type, uint8_t{1}));
  }

  void increments(int count) {
    for (int i = 1; i <= count; ++i) increment(kBoot + 5000U * static_cast<uint64_t>(i));
  }

  ImportSummary import() {
    scratch_.text_file("log.ulg", log_.bytes);
    return import_ulog(options_);
  }
  std::string data_error() {
    const std::string what = error_of<DataError>([&] { import(); });
    EXPECT_FALSE(std::filesystem::exists(options_.out));
    return what;
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

  Scratch scratch_;
  Log log_;
  UlogImport options_;
};

TEST_F(Ulog, IncrementsAndFixesOnUtc) {
  begin();
  fix(kBoot + 51'000, kUtc + 50'000, 106'766, 2);  // without height: none
  increments(100);
  fix(kBoot + 251'000, kUtc + 250'000);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 100);
  EXPECT_EQ(summary.gnss.written, 1);
  EXPECT_EQ(summary.gnss.without_fix, 1);
  EXPECT_EQ(summary.qualities.at(FixQuality::fixed_rtk), 1);
  const auto increments = all<ImuIncrement>();
  ASSERT_EQ(increments.size(), 100U);
  EXPECT_EQ(increments[9].t_end_ns, static_cast<int64_t>(kUtc + 50'000) * 1000);
  EXPECT_NEAR(increments[9].dt(), 0.005, 1e-12);
  EXPECT_LT((increments[9].dtheta_b - Eigen::Vector3d(1e-3, 2e-3, -3e-3)).norm(), 1e-9);  // float
  EXPECT_LT((increments[9].dvel_b - Eigen::Vector3d(0.005, 0.01, -0.05)).norm(), 1e-8);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns, static_cast<int64_t>(kUtc + 250'000) * 1000);
  EXPECT_NEAR(fix.antenna.latitude, 63.4170622 * kDegree, 1e-12);
  EXPECT_NEAR(fix.antenna.longitude, 10.4082151 * kDegree, 1e-12);
  EXPECT_NEAR(fix.antenna.height, 106.766, 1e-9);
  EXPECT_NEAR(std::sqrt(fix.position_covariance(1, 1)), 1.5, 1e-6);
  EXPECT_NEAR(std::sqrt(fix.position_covariance(2, 2)), 2.5, 1e-6);
  EXPECT_LT((*fix.velocity_n - Eigen::Vector3d(1, -2, 0.25)).norm(), 1e-6);
  EXPECT_LT((fix.p_b_a - *options_.lever_arm).norm(), 1e-12);
}

TEST_F(Ulog, WhatIsThinnedOutIsNotTaken) {
  begin();
  fix(kBoot + 51'000, kUtc + 50'000);
  for (uint64_t i = 1; i <= 400; ++i) {
    combined(kBoot + 5000 * i);
    if (i % 100 == 0) increment(kBoot + 5000 * i);
  }
  EXPECT_EQ(import().imu.written, 400);
  const auto increments = all<ImuIncrement>();
  EXPECT_LT((increments[9].dtheta_b - Eigen::Vector3d(5e-4, 1e-3, 1.5e-3)).norm(), 1e-9);
  EXPECT_LT((increments[9].dvel_b - Eigen::Vector3d(0.005, 0.01, -0.049)).norm(), 1e-8);
}

TEST_F(Ulog, AnImuThatIsThinnedOutIsRefused) {
  begin();
  fix(kBoot + 1000, kUtc);
  for (uint64_t i = 1; i <= 10; ++i) increment(kBoot + 500'000 * i);
  EXPECT_THAT(data_error(), AllOf(HasSubstr("logged for 1 % of the time"), HasSubstr("SDLOG")));
}

/// Names and units since PX4 1.14, behind a field of another format, heights above the sea.
TEST_F(Ulog, NewNames) {
  begin();
  log_.message('F', "triple:float[3] x;uint8_t n;");
  log_.message('F', std::string("sensor_gps:uint64_t timestamp;triple[2] more;") +
                        (std::strchr(kNewGnss, ':') + 1) + "float eph;float epv;uint8_t fix_type;");
  log_.subscribe(3, "sensor_gps");
  increments(100);
  log_.data(3, packed(kBoot + 100'000) + std::string(26, '\x7f') +
                   packed(63.5, 10.25, 42.125, 0.0, 0.5F, 0.75F, uint8_t{4}));
  const ImportSummary summary = import();
  EXPECT_EQ(summary.with_velocity, 0);
  EXPECT_EQ(summary.qualities.at(FixQuality::differential), 1);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns, static_cast<int64_t>(kBoot + 100'000) * 1000);  // no UTC: since 1970
  EXPECT_NEAR(fix.antenna.latitude, 63.5 * kDegree, 1e-15);
  EXPECT_NEAR(fix.antenna.height, 42.125, 1e-12);
}

/// Of two antennas: heading and its accuracy, which may be NaN.
TEST_F(Ulog, Heading) {
  begin();
  log_.message('F', std::string("sensor_gps:uint64_t timestamp;") +
                        (std::strchr(kNewGnss, ':') + 1) +
                        "float eph;float epv;float heading;float heading_accuracy;"
                        "uint8_t fix_type;");
  log_.subscribe(3, "sensor_gps");
  increments(100);
  const float none = std::numeric_limits<float>::quiet_NaN();
  const std::pair<float, float> told[] = {{1.25F, 0.01F}, {-2.5F, none}, {none, none}};
  uint64_t t = kBoot;
  for (const auto& [heading, accuracy] : told) {
    log_.data(3, packed(t += 100'000, 63.5, 10.25, 42.125, 0.0, 0.5F, 0.75F, heading, accuracy,
                        uint8_t{4}));
  }
  import();
  const std::vector<GnssFix> fixes = all<GnssFix>();
  ASSERT_EQ(fixes.size(), 3U);
  EXPECT_NEAR(fixes[0].heading->azimuth, 1.25, 1e-12);
  EXPECT_NEAR(fixes[0].heading->sigma, 0.01, 1e-9);  // float
  EXPECT_NEAR(fixes[1].heading->azimuth, -2.5, 1e-12);
  EXPECT_NEAR(fixes[1].heading->sigma, 0.5 * kDegree, 1e-12);
  EXPECT_FALSE(fixes[2].heading);
}

/// A boot clock 50 ppm fast; one UTC that is wrong; delays of reception that vary.
TEST_F(Ulog, TheBootClockDrifts) {
  begin();
  for (uint64_t i = 1; i <= 60'000; ++i) {
    const uint64_t boot = kBoot + 5000 * i;
    increment(boot);
    const uint64_t utc = kUtc + 5000 * i - i / 4;
    if (i % 200 == 0) fix(boot + 1000 + (i % 3) * 5000, i == 20'000 ? utc + 7'000'000 : utc);
  }
  EXPECT_EQ(import().gnss.written, 300);
  const auto increments = all<ImuIncrement>();
  const auto fixes = all<GnssFix>();
  const int64_t length = increments.back().t_end_ns - increments.front().t_end_ns;
  EXPECT_NEAR(static_cast<double>(length), 59'999 * 5e6 * (1 - 50e-6), 0.5e6);
  EXPECT_EQ(fixes[98].t_ns, static_cast<int64_t>(kUtc + 19'800 * 5000 - 4950) * 1000);
  EXPECT_NEAR(static_cast<double>(fixes[99].t_ns - fixes[98].t_ns), 1e9, 15e6);
}

/// Then the time of reception counts.
TEST_F(Ulog, AUtcThatStands) {
  begin();
  increments(100);
  fix(kBoot + 101'000, kUtc + 100'000);
  fix(kBoot + 151'000, kUtc + 100'000);
  EXPECT_EQ(import().gnss.written, 2);
  const auto fixes = all<GnssFix>();
  EXPECT_EQ(fixes[0].t_ns, static_cast<int64_t>(kUtc + 100'000) * 1000);
  EXPECT_NEAR(static_cast<double>(fixes[1].t_ns - fixes[0].t_ns), 50e6, 1e3);
}

TEST_F(Ulog, AppendedDataFollowWhatWasCutOff) {
  const auto write = [this](uint64_t appended) {
    log_ = {};
    begin(appended);
    fix(kBoot + 51'000, kUtc + 50'000);
    increments(50);
    log_.bytes += std::string(
        "\x30\x00"
        "D\x02",
        4);  // the crash
    const uint64_t end = log_.bytes.size();
    for (uint64_t i = 51; i <= 60; ++i) increment(kBoot + 5000 * i);
    return end;
  };
  write(write(1));
  EXPECT_EQ(import().imu.written, 60);
}

TEST_F(Ulog, OtherMessagesAreLeftOut) {
  begin();
  log_.message('O', packed(uint16_t{30}));  // a dropout of 30 ms
  log_.message('S', std::string(8, 'x'));
  fix(kBoot + 51'000, kUtc + 50'000);
  increments(50);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 50);
  EXPECT_TRUE(summary.imu.notices.empty());
}

TEST_F(Ulog, BytesThatAreNoMessagesAreTold) {
  begin();
  fix(kBoot + 51'000, kUtc + 50'000);
  increments(50);
  const size_t byte = log_.bytes.size();
  log_.bytes += std::string(3000, '\0');
  increment(kBoot + 5000 * 51);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 51);
  EXPECT_THAT(summary.imu.notices,
              ::testing::ElementsAre(HasSubstr("log.ulg: byte " + std::to_string(byte) +
                                               ": 3000 bytes are no messages")));
}

TEST_F(Ulog, LeverArmOfTheParameters) {
  options_.lever_arm.reset();
  begin();
  fix(kBoot + 51'000, kUtc + 50'000);
  increments(50);
  const std::string without = log_.bytes;
  EXPECT_THAT(error_of<UsageError>([&] { import(); }), HasSubstr("give --lever-arm"));
  log_.parameter("EKF2_GPS_POS_X", 0.5F);
  log_.parameter("EKF2_GPS_POS_Y", 0.0F);
  log_.parameter("EKF2_GPS_POS_Z", -0.25F);
  log_.parameter("EKF2_IMU_POS_X", 0.25F);
  EXPECT_LT((import().lever_arm_v.value() - Eigen::Vector3d(0.25, 0, -0.25)).norm(), 1e-12);
}

TEST_F(Ulog, ATruncatedLogNamesTheByte) {
  begin();
  fix(kBoot + 51'000, kUtc + 50'000);
  increments(50);
  const size_t byte = log_.bytes.size();
  increment(kBoot + 5000 * 51);
  log_.bytes.pop_back();
  EXPECT_THAT(data_error(),
              AllOf(HasSubstr("log.ulg: byte " + std::to_string(byte) + ": "),
                    HasSubstr("ends within a message"), HasSubstr("--skip-bad-rows")));
  options_.skip_bad_rows = true;
  EXPECT_EQ(import().imu.written, 50);
}

TEST_F(Ulog, DamageIsOneLine) {
  begin();
  fix(kBoot + 51'000, kUtc + 50'000);
  increments(50);
  const std::string good = log_.bytes;
  log_.data(0, "short");
  EXPECT_THAT(data_error(), HasSubstr("has 5 bytes, too few for its format"));
  log_.bytes = good;
  log_.data(77, "");
  EXPECT_THAT(data_error(), HasSubstr("data of message 77, which nothing defines"));
  log_.bytes = good;
  log_.message('F', "loop:loop x;");
  log_.subscribe(9, "loop");
  EXPECT_THAT(data_error(), HasSubstr("a type that nothing defines"));
  log_.bytes = "ULog, says this text";
  EXPECT_THAT(data_error(), HasSubstr("byte 0: it does not begin as a ULog"));
  log_ = {};
  log_.flags(4, 0);
  EXPECT_THAT(data_error(), HasSubstr("a reader newer than this one"));
}

}  // namespace
}  // namespace foucault::rawlog
