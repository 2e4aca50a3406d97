#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstdlib>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/rawlog/import_novatel.h"
#include "foucault/rawlog/rawlog_source.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

template <class... T>
std::string packed(const T&... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}

uint32_t crc_of(const std::string& bytes) {
  return static_cast<uint32_t>(crc32(0xffffffffUL, reinterpret_cast<const Bytef*>(bytes.data()),
                                     static_cast<uInt>(bytes.size()))) ^
         0xffffffffU;
}

constexpr int kWeek = 2101;
constexpr uint32_t kMs = 148'000'000;  ///< of the week
constexpr double kSow = kMs / 1000.0;
int64_t stamp_at(double after) { return gps_to_unix_ns(kWeek, kSow + after); }
uint32_t ms(double after) { return static_cast<uint32_t>(std::lround((kSow + after) * 1000)); }

std::string with_crc(const std::string& bytes) { return bytes + packed(crc_of(bytes)); }

std::string long_log_at(uint16_t id, int week, uint32_t milliseconds, const std::string& body) {
  return with_crc(packed('\xaa', '\x44', '\x12', uint8_t{28}, id, uint8_t{0}, uint8_t{32},
                         static_cast<uint16_t>(body.size()), uint16_t{0}, uint8_t{90}, uint8_t{180},
                         static_cast<uint16_t>(week), milliseconds, 0U, 0U) +
                  body);
}

std::string long_log(uint16_t id, double after, const std::string& body) {
  return long_log_at(id, kWeek, ms(after), body);
}

std::string short_log(uint16_t id, double after, const std::string& body) {
  return with_crc(packed('\xaa', '\x44', '\x13', static_cast<uint8_t>(body.size()), id,
                         static_cast<uint16_t>(kWeek), ms(after)) +
                  body);
}

std::string bestpos(double after, uint32_t type = 50, uint16_t id = 42, uint32_t status = 0,
                    double latitude = 51.25) {
  return long_log(id, after,
                  packed(status, type, latitude, -114.5, 1094.0, -17.5F, 61U, 0.25F, 0.5F, 0.75F) +
                      std::string(24, '\0'));
}

std::string bestvel(double after, double speed, float latency = 0, uint16_t id = 99) {
  return long_log(id, after, packed(0U, 8U, latency, 0.0F, speed, 90.0, 0.5, 0.0F));
}

std::string rawimusx(double after, int z, int minus_y, int x, uint8_t type = 26, uint8_t info = 4) {
  return short_log(1462, after,
                   packed(info, type, static_cast<uint16_t>(kWeek), kSow + after, 0U, z, minus_y, x,
                          3000, -2000, 1000));
}

std::string insconfig(float x, float y, float z, float rotation_x, float rotation_z,
                      uint32_t imu = 26) {
  const std::string rest = packed(0.0F, 0.0F, 0.0F, 4U);
  return long_log(1945, 0,
                  packed(imu) + std::string(56, '\0') + packed(1U, 1U, 0U, x, y, z) + rest +
                      packed(1U, 11U, 0U, rotation_x, 0.0F, rotation_z) + rest);
}

std::string inspvas(double after, double roll, double pitch, double azimuth, uint32_t status = 3) {
  return short_log(508, after,
                   packed(static_cast<uint32_t>(kWeek), kSow + after, 51.25, -114.5, 1080.0, 1.0,
                          2.0, 3.0, roll, pitch, azimuth, status));
}

class Novatel : public ::testing::Test {
 protected:
  Novatel() {
    options_.log = scratch_.path("drive.gps");
    options_.out = scratch_.path("out.rawlog");
    options_.lever_arm = Eigen::Vector3d(0.1, -0.2, -0.3);
  }

  /// Half a second of 200 Hz at rest and two fixes.
  void drive() {
    for (int i = 1; i <= 100; ++i) {
      log_ += rawimusx(0.005 * i, 490'000, 0, 0);
      if (i % 50 == 0) log_ += bestpos(0.005 * i);
    }
  }

  ImportSummary import() {
    scratch_.text_file("drive.gps", log_);
    return import_novatel(options_);
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
  NovatelImport options_;
  std::string log_;
};

TEST_F(Novatel, BinaryValues) {
  drive();
  log_ += inspvas(0.5, 1, -2, 30);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 100);
  EXPECT_EQ(summary.gnss.written, 2);
  EXPECT_EQ(summary.qualities.at(FixQuality::fixed_rtk), 2);
  EXPECT_THAT(summary.gnss.notices, ::testing::IsEmpty());
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns, stamp_at(0.25));
  EXPECT_NEAR(fix.antenna.latitude, 51.25 * kDegree, 1e-15);
  EXPECT_NEAR(fix.antenna.longitude, -114.5 * kDegree, 1e-15);
  EXPECT_NEAR(fix.antenna.height, 1094.0 - 17.5, 1e-9);
  const Eigen::Vector3d sigma = fix.position_covariance.diagonal().cwiseSqrt();
  EXPECT_LT((sigma - Eigen::Vector3d(0.25, 0.5, 0.75)).norm(), 1e-6);
  const ReferencePose pose = all<ReferencePose>().at(0);
  EXPECT_EQ(pose.t_ns, stamp_at(0.5));
  EXPECT_NEAR(pose.position.height, 1080, 1e-9);  // above the ellipsoid
  EXPECT_LT((*pose.velocity_n - Eigen::Vector3d(1, 2, -3)).norm(), 1e-9);
  const so3::Euler euler = so3::to_euler(*pose.q_n_v);
  EXPECT_NEAR(euler.roll, 1 * kDegree, 1e-9);
  EXPECT_NEAR(euler.pitch, -2 * kDegree, 1e-9);
  EXPECT_NEAR(euler.heading, 30 * kDegree, 1e-9);
}

/// ISA-100C: 2e-8 m/s, 1e-9 rad. y looks forward, x right, z up.
TEST_F(Novatel, CountsBecomeIncrementsOnTheVehiclesAxes) {
  log_ += rawimusx(0.005, 490'000, -20'000, 10'000) + bestpos(0.005) +
          rawimusx(0.010, 490'000, -20'000, 10'000) + rawimusx(0.015, 490'000, 0, 0);
  import();
  RawlogSource source(options_.out, imu::SampleKind::interval_mean);
  const Eigen::Quaterniond q_v_b = source.mounting().q_v_b;
  const auto increments = all<ImuIncrement>();
  ASSERT_EQ(increments.size(), 3U);
  EXPECT_EQ(increments[0].t_begin_ns, stamp_at(0));
  EXPECT_EQ(increments[0].t_end_ns, stamp_at(0.005));
  EXPECT_LT((increments[0].dvel_b - Eigen::Vector3d(2e-4, 4e-4, 9.8e-3)).norm(), 1e-12);
  EXPECT_LT((increments[0].dtheta_b - Eigen::Vector3d(1e-6, 2e-6, 3e-6)).norm(), 1e-15);
  EXPECT_LT((q_v_b * increments[0].dvel_b - Eigen::Vector3d(4e-4, 2e-4, -9.8e-3)).norm(), 1e-12);
}

TEST_F(Novatel, ImuTypes) {
  struct Case {
    uint8_t type;
    double gyro, accel;  ///< of a count
  };
  constexpr double kSecond = kDegree / 3600;
  for (const Case& c :
       {Case{8, 1.0 / 524288, 1.0 / 16384}, Case{11, std::exp2(-33), std::exp2(-27) * 0.3048},
        Case{12, std::exp2(-33), std::exp2(-26) * 0.3048},
        Case{13, 0.1 / 256 * kSecond, 0.05 / 32768}, Case{16, 0.1 / 3600 / 256, 0.05 / 32768},
        Case{31, 720 * kDegree / std::exp2(31), 200 / std::exp2(31)},
        Case{32, kDegree / std::exp2(21), 1 / std::exp2(22)},
        Case{41, 0.008 / 65536 / 125 * kDegree, 0.2e-3 * 9.80665 / 65536 / 125},
        Case{61, 0.0151515 / 65536 / 200 * kDegree, 0.4e-3 * 9.80665 / 65536 / 200},
        Case{58, std::exp2(-33), std::exp2(-29)}}) {
    log_ =
        bestpos(0.005) + rawimusx(0.005, 1000, 0, 0, c.type) + rawimusx(0.010, 1000, 0, 0, c.type);
    import();
    const ImuIncrement increment = all<ImuIncrement>().at(1);
    EXPECT_NEAR(increment.dtheta_b.z() / (3000 * c.gyro), 1, 1e-9) << int{c.type};
    EXPECT_NEAR(increment.dvel_b.z() / (1000 * c.accel), 1, 1e-9) << int{c.type};
  }
}

TEST_F(Novatel, AnUnknownImuNamesTheOptions) {
  log_ = bestpos(0.005) + rawimusx(0.005, 1000, 0, 0, 99) + rawimusx(0.010, 1000, 0, 0, 99);
  EXPECT_THAT(error_of<UsageError>([&] { import(); }),
              AllOf(HasSubstr("number 99"), HasSubstr("--imu-scales"), HasSubstr("ADIS16488")));
  options_.imu_scales = Eigen::Vector2d(1e-8, 2e-6);
  import();
  EXPECT_NEAR(all<ImuIncrement>().at(1).dvel_b.z(), 2e-3, 1e-12);
  EXPECT_NEAR(all<ImuIncrement>().at(1).dtheta_b.z(), 3e-5, 1e-14);
  options_.imu_scales = Eigen::Vector2d(0, 1);
  EXPECT_THAT(error_of<UsageError>([&] { import(); }), HasSubstr("greater than zero"));
  options_.imu_scales.reset();
  options_.imu_type = "STIM300";
  import();
  EXPECT_NEAR(all<ImuIncrement>().at(1).dvel_b.z(), 1000 / std::exp2(22), 1e-12);
  options_.imu_type = "MPU6050";
  EXPECT_THAT(error_of<UsageError>([&] { import(); }), HasSubstr("--imu-type MPU6050 is not"));
}

/// RAWIMUS does not tell the type, INSCONFIG does.
TEST_F(Novatel, TheTypeOfInsconfig) {
  const auto rawimus = [](double after) {
    return short_log(325, after,
                     packed(static_cast<uint32_t>(kWeek), kSow + after, 0U, 1000, 0, 0, 0, 0, 0));
  };
  log_ = bestpos(0.005) + rawimus(0.005) + rawimus(0.010);
  EXPECT_THAT(error_of<UsageError>([&] { import(); }), HasSubstr("does not tell the IMU's type"));
  log_ += insconfig(0, 0, 0, 0, 0, 8);
  import();
  EXPECT_NEAR(all<ImuIncrement>().at(1).dvel_b.z(), 1000 / 16384.0, 1e-12);
}

TEST_F(Novatel, LeverArmAndMountingOfInsconfig) {
  drive();
  const std::string without = log_;
  options_.lever_arm.reset();
  EXPECT_THAT(error_of<UsageError>([&] { import(); }), HasSubstr("give --lever-arm"));
  log_ = insconfig(0.5F, 0.25F, 1.5F, 0, 0) + without;
  EXPECT_LT((import().lever_arm_v.value() - Eigen::Vector3d(0.25, 0.5, -1.5)).norm(), 1e-9);
  // z looks down and x forward: as NovAtel's guide from OEM6 to OEM7 has it.
  log_ = insconfig(0.5F, 0.25F, 1.5F, 180, 90) + without;
  EXPECT_LT((import().lever_arm_v.value() - Eigen::Vector3d(0.5, 0.25, 1.5)).norm(), 1e-6);
  RawlogSource turned(options_.out);
  EXPECT_LT(turned.mounting().q_v_b.angularDistance(Eigen::Quaterniond::Identity()), 1e-6);
  options_.imu_axes = {"-y", "-x", "-z"};
  EXPECT_LT((import().lever_arm_v.value() - Eigen::Vector3d(-0.25, -0.5, -1.5)).norm(), 1e-9);
  options_.imu_axes = {"y", "y", "z"};
  EXPECT_THAT(error_of<UsageError>([&] { import(); }), HasSubstr("--imu-axes"));
}

/// A velocity of latency 0.2 s belongs to 0.2 s before its stamp.
TEST_F(Novatel, VelocitiesAreLate) {
  drive();
  for (int i = 0; i < 4; ++i) {
    log_ += bestpos(1.0 + i) + bestvel(1.0 + i, 10.0 + i, 0.25F);
  }
  options_.velocity_sigma = Eigen::Vector3d(0.03, 0.04, 0.05);
  EXPECT_EQ(import().with_velocity, 3);
  const auto fixes = all<GnssFix>();
  EXPECT_FALSE(fixes.front().velocity_n);
  const GnssFix& fix = fixes.at(2);
  EXPECT_EQ(fix.t_ns, stamp_at(1));
  EXPECT_LT((*fix.velocity_n - Eigen::Vector3d(0, 10.25, -0.5)).norm(), 1e-6);
  EXPECT_NEAR(std::sqrt(fix.velocity_covariance(2, 2)), 0.05, 1e-6);
  EXPECT_FALSE(fixes.back().velocity_n);
}

TEST_F(Novatel, WithoutLatencyTheVelocityIsThatOfTheStamp) {
  drive();
  log_ += bestvel(1, 3) + bestpos(1) + bestpos(2) + bestvel(2, 7);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.with_velocity, 2);
  EXPECT_THAT(summary.gnss.notices, ::testing::Contains(HasSubstr("--velocity-sigma")));
  EXPECT_NEAR(all<GnssFix>().at(2).velocity_n->y(), 3, 1e-9);
  EXPECT_NEAR(all<GnssFix>().at(3).velocity_n->y(), 7, 1e-9);
}

TEST_F(Novatel, TypesOfSolutions) {
  drive();
  const std::vector<std::pair<uint32_t, FixQuality>> types{{16, FixQuality::single},
                                                           {17, FixQuality::differential},
                                                           {34, FixQuality::float_rtk},
                                                           {50, FixQuality::fixed_rtk},
                                                           {69, FixQuality::ppp}};
  int t = 0;
  for (const auto& [type, quality] : types) log_ += bestpos(++t, type);
  log_ += bestpos(6, 19) + bestpos(7, 1) + bestpos(8, 50, 42, 1);  // extrapolated, given, none
  log_ += bestpos(9, 56);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.gnss.written, 8);
  EXPECT_EQ(summary.gnss.without_fix, 3);
  EXPECT_THAT(summary.gnss.notices,
              ::testing::Contains(AllOf(HasSubstr("1 positions"), HasSubstr("own INS"))));
  const auto fixes = all<GnssFix>();
  for (size_t i = 0; i < types.size(); ++i) EXPECT_EQ(fixes.at(2 + i).quality, types[i].second);
}

/// What is not of the receiver's INS comes first.
TEST_F(Novatel, BestgnssposIsPreferred) {
  drive();
  log_ += bestpos(0.6, 56) + bestpos(0.4, 50, 1429, 0, 52.0) + bestvel(0.4, 5, 0, 1430) +
          bestvel(0.6, 9);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.gnss.written, 1);
  EXPECT_NEAR(all<GnssFix>().at(0).antenna.latitude, 52 * kDegree, 1e-15);
  EXPECT_NEAR(all<GnssFix>().at(0).velocity_n->y(), 5, 1e-9);
}

TEST_F(Novatel, OtherBytesBetweenTheLogs) {
  const std::string noise = std::string("\xaa\x44\x12\x1c\xaa\x44") + "$GPGGA,1*00\r\n#%<OK\r\n" +
                            long_log(43, 0, std::string(300, 'x')) + "#TIMEA,COM1,0,1;2*3\r\n";
  for (int i = 1; i <= 100; ++i) {
    log_ += noise + rawimusx(0.005 * i, 490'000, 0, 0);
    if (i % 50 == 0) log_ += bestpos(0.005 * i);
  }
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 100);
  EXPECT_EQ(summary.gnss.written, 2);
}

TEST_F(Novatel, AWrongCrcLosesOneLog) {
  drive();
  const size_t first = log_.size();
  std::string broken = bestpos(0.6);
  broken[60] ^= 1;
  log_ += broken + bestpos(0.7);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.gnss.written, 3);
  EXPECT_THAT(summary.gnss.notices, Each(AllOf(HasSubstr("left out 1 of 104 logs"),
                                               HasSubstr(fmt::format("byte {}", first)))));
  EXPECT_EQ(summary.gnss.notices.size(), 1U);
}

/// A length that is wrong spans whole logs; they are read.
TEST_F(Novatel, AWrongLengthDoesNotHideWhatFollows) {
  std::string broken = bestpos(0.001);
  broken[9] = '\x08';
  log_ = broken;
  drive();
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 100);
  EXPECT_EQ(summary.gnss.notices.size(), 1U);
}

TEST_F(Novatel, ACutTailIsTold) {
  drive();
  log_ += bestpos(0.6);
  log_.resize(log_.size() - 10);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.gnss.written, 2);
  EXPECT_THAT(summary.gnss.notices, Each(HasSubstr("left out 1 of 103 logs, cut off")));
}

TEST_F(Novatel, LogsOnSeveralPortsCountOnce) {
  drive();
  log_ += bestpos(1) + bestpos(1);
  const ImportSummary summary = import();
  EXPECT_EQ(summary.gnss.written, 3);
  EXPECT_THAT(summary.gnss.notices, Each(HasSubstr("left out 1 logs BESTPOS")));
}

TEST_F(Novatel, DamageIsOneLine) {
  log_ = "no such log";
  EXPECT_THAT(data_error(), HasSubstr("no position of a NovAtel receiver"));
  drive();
  const std::string good = log_;
  const size_t byte = log_.size();
  log_ += long_log(42, 1, "short");
  EXPECT_THAT(data_error(), AllOf(HasSubstr(fmt::format("drive.gps: byte {}: ", byte)),
                                  HasSubstr("BESTPOS has too few bytes")));
  log_ = good + bestpos(1, 50, 42, 0, 95.0);
  EXPECT_THAT(data_error(), HasSubstr("no place on Earth"));
  log_ = good + bestpos(1, 50, 42, 0, std::nan(""));
  EXPECT_THAT(data_error(), HasSubstr("not finite"));
  log_ = good + rawimusx(0.6, 1, 1, 1, 26, 2);
  EXPECT_THAT(data_error(), HasSubstr("encrypted"));
  options_.skip_bad_rows = true;
  EXPECT_EQ(import().imu.skipped, 1);
}

TEST_F(Novatel, FixesOnly) {
  log_ = bestpos(1) + bestpos(2);
  const ImportSummary summary = import();
  EXPECT_TRUE(summary.imu.file.empty());
  EXPECT_EQ(summary.gnss.written, 2);
}

/// A turning vehicle on its side: what the receiver took out comes back.
TEST_F(Novatel, CorrectedIncrementsGetGravityBack) {
  const auto corrected = [](double after) {
    return short_log(
        1362, after,
        packed(static_cast<uint32_t>(kWeek), kSow + after, 0.0, 0.0, -0.005, 0.0, 0.0, 0.0));
  };
  log_ = bestpos(0.1);
  for (int i = 1; i <= 100; ++i) log_ += corrected(0.01 * i);
  EXPECT_THAT(data_error(), AllOf(HasSubstr("IMURATECORRIMUS"), HasSubstr("log RAWIMUSX")));
  log_ = bestpos(0.1) + inspvas(0.01, 90, 0, 0);
  for (int i = 1; i <= 100; ++i) log_ += corrected(0.01 * i);
  const ImportSummary summary = import();
  EXPECT_THAT(summary.imu.notices, Each(HasSubstr("corrected by the receiver's filter")));
  const auto increments = all<ImuIncrement>();
  ASSERT_EQ(increments.size(), 100U);
  const double latitude = 51.25 * kDegree;
  const Eigen::Vector3d earth =
      7.292115e-5 * Eigen::Vector3d(std::cos(latitude), 0, -std::sin(latitude));
  for (const size_t i : {size_t{0}, size_t{99}}) {
    const ImuIncrement& increment = increments[i];
    const double turned = 0.5 * (0.01 * static_cast<double>(i) - 0.005);  // about down
    const Eigen::Quaterniond q_n_v =
        so3::from_euler({90 * kDegree, 0, 0}) * so3::exp({0, 0, turned});
    const Eigen::Vector3d force = -(q_n_v.conjugate() * Eigen::Vector3d(0, 0, 9.808));
    EXPECT_LT((increment.dvel_b / 0.01 - force).norm(), 2e-3) << i;  // height, latitude: 9.808
    const Eigen::Vector3d rate = Eigen::Vector3d(0, 0, 0.5) + q_n_v.conjugate() * earth;
    EXPECT_LT((increment.dtheta_b / 0.01 - rate).norm(), 1e-8) << i;
  }
}

/// Logs of old firmware are single samples: poses turn more.
TEST_F(Novatel, CorrectedSamplesThatAreNoSums) {
  for (int i = 0; i <= 100; ++i) {
    log_ += inspvas(0.01 * i, 0, 0, 0.5 * i) + bestpos(0.01 * i) +
            long_log(812, 0.01 * i,
                     packed(static_cast<uint32_t>(kWeek), kSow + 0.01 * i, 0.0, 0.0,
                            -0.25 * kDegree, 0.0, 0.0, 0.0));
  }
  EXPECT_THAT(
      error_of<UsageError>([&] { import(); }),
      AllOf(HasSubstr("turns 2 times as much as CORRIMUDATA"), HasSubstr("--imu-scales N,N")));
  options_.imu_scales = Eigen::Vector2d(2, 2);
  import();
  EXPECT_NEAR(all<ImuIncrement>().at(50).dtheta_b.z(), 0.5 * kDegree, 1e-6);
  EXPECT_NEAR(all<ImuIncrement>().at(50).dvel_b.z(), -0.0981, 1e-3);
}

/// Examples that docs.novatel.com prints, to the letter.
TEST_F(Novatel, PrintedExamples) {
  log_ =
      "#INSCONFIGA,COM1,0,71.0,COARSESTEERING,1931,517331.006,02400000,6d7a,32768;EPSON_G320,6,50,"
      "20,DEFAULT,00ffd1bf,AUTOMATIC,ROVER,FALSE,00000000,0,0,0,0,0,0,0,0,0,1,ANT1,IMUBODY,0.0540,"
      "0.0699,-0.0346,0.0200,0.0200,0.0200,FROM_NVM,1,RBV,IMUBODY,180.0000,0.0000,90.0000,5.0000,"
      "5.0000,5.0000,FROM_COMMAND*b1233ac4\r\n"
      "%RAWIMUSXA,2209,491674.014;04,41,2209,491674.013699,ea59fe00,329308016,-2706935,4508389,"
      "196192,417138,-1000837*038422a7\r\n"
      "#BESTPOSA,USB1,0,58.5,FINESTEERING,2209,502061.000,02000020,cdba,16809;SOL_COMPUTED,PPP,"
      "51.15043706870,-114.03067882331,1097.3462,-17.0001,WGS84,0.0154,0.0139,0.0288,\"TSTR\","
      "11.000,0.000,43,39,39,38,00,00,7f,37*52483ac5\r\n"
      "#BESTVELA,USB1,0,57.5,FINESTEERING,2209,502223.000,02000020,10a2,16809;SOL_COMPUTED,PPP,"
      "0.250,13.000,0.0025,28.358727,0.0021,0*e9418656\r\n";
  const auto sample = [](double sow, int x) {  // a second one, which tells the interval
    const std::string text =
        fmt::format("RAWIMUSXA,2209,{:.3f};00,41,2209,{:.6f},ea59fe00,0,0,{},0,0,0", sow, sow, x);
    return fmt::format("%{}*{:08x}\r\n", text, crc_of(text));
  };
  log_ += sample(491674.021699, 7) + sample(502061.5, 8);
  options_.lever_arm.reset();
  const ImportSummary summary = import();
  EXPECT_LT((summary.lever_arm_v.value() - Eigen::Vector3d(0.0540, 0.0699, -0.0346)).norm(), 1e-6);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns, gps_to_unix_ns(2209, 502061));
  EXPECT_EQ(fix.quality, FixQuality::ppp);
  EXPECT_NEAR(fix.antenna.height, 1097.3462 - 17.0001, 1e-6);
  EXPECT_NEAR(std::sqrt(fix.position_covariance(1, 1)), 0.0139, 1e-8);
  const ImuIncrement increment = all<ImuIncrement>().at(0);
  EXPECT_EQ(increment.t_end_ns, gps_to_unix_ns(2209, 491674.013699));
  EXPECT_NEAR(increment.dvel_b.z() / 0.008, 9.855, 1e-3);  // z up
  EXPECT_NEAR(increment.dvel_b.y() / 0.008, 2706935 * 0.2 / 65536 * 9.80665e-3, 1e-9);
  EXPECT_NEAR(increment.dtheta_b.y() / 0.008, -417138 * 0.008 / 65536 * kDegree, 1e-12);
}

/// The same place above the ellipsoid and above the sea.
TEST_F(Novatel, PrintedPoses) {
  const auto pose_of = [this](const std::string& line) {
    const std::string body = bestpos(0).substr(28, 72);
    const auto rawimu = [](double sow) {
      return long_log_at(268, 2209, 0, packed(2209U, sow, 0U, 1, 0, 0, 0, 0, 0));
    };
    options_.imu_type = "LN200";
    log_ = long_log_at(42, 2209, 490'700'000, body) + rawimu(490'700) + rawimu(490'790) + line +
           "\r\n" + long_log_at(42, 2209, 490'800'000, body);
    import();
    return all<ReferencePose>().at(0);
  };
  const ReferencePose pose = pose_of(
      "%INSPVASA,2209,490712.000;2209,490712.000000000,51.15043713712,-114.03067872932,1080.3580,"
      "0.0014,-0.0007,0.0015,-0.293782412,0.302470613,157.989827209,INS_SOLUTION_GOOD*a87ab88b");
  EXPECT_EQ(pose.t_ns, gps_to_unix_ns(2209, 490712));
  EXPECT_NEAR(pose.position.latitude / kDegree, 51.15043713712, 1e-10);
  EXPECT_NEAR(pose.position.height, 1080.3580, 1e-6);
  EXPECT_NEAR(so3::to_euler(*pose.q_n_v).heading / kDegree, 157.989827209, 1e-8);
  const ReferencePose extended = pose_of(
      "#INSPVAXA,USB1,0,65.5,FINESTEERING,2209,490782.000,02000020,46eb,16809;INS_SOLUTION_GOOD,"
      "INS_PPP,51.15043710672,-114.03067871892,1097.3598,-17.0001,-0.0016,0.0002,0.0029,"
      "-0.308665944,0.297893298,157.960833016,0.1816,0.1816,0.1808,0.0018,0.0018,0.0016,0.0292,"
      "0.0292,0.0582,13000045,0*a74644a2");
  EXPECT_EQ(extended.t_ns, gps_to_unix_ns(2209, 490782));
  EXPECT_NEAR(extended.position.height, 1097.3598 - 17.0001, 1e-4);
  EXPECT_NEAR(extended.velocity_n->z(), -0.0029, 1e-9);
  EXPECT_NEAR(so3::to_euler(*extended.q_n_v).pitch / kDegree, 0.297893298, 1e-8);
}

TEST_F(Novatel, ALineThatIsDamaged) {
  drive();
  log_ += "#BESTPOSA,COM1,0,58.5,FINESTEERING,2101,148001.000,0,0,0;SOL_COMPUTED*00000000\r\n";
  log_ += "#BESTPOSA,COM1,0,58.5,FINEST";
  EXPECT_THAT(import().gnss.notices, Each(HasSubstr("left out 2 of 104 logs")));
  const std::string text = "BESTPOSA,COM1,0,58.5,FINE,2101,148001.000,0,0,0;SOL_COMPUTED,SINGLE,5x";
  log_ += "\n#" + text + fmt::format("*{:08x}", crc_of(text));
  EXPECT_THAT(error_of<DataError>([&] { import(); }),
              HasSubstr("BESTPOS has a field that is no such number"));
}

/// A recording of NovAtel's own driver for ROS: test/ins2.gps, 6 s at rest, corrected IMU. Not in
/// the repository; the positions are those of the reference.
TEST_F(Novatel, ARealRecording) {
  const std::string file = test::data_dir() + "/raw_fixtures/ins2.gps";
  // Not everywhere: the tests above prove the importer on logs that NovAtel prints or we write.
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << "; set FOUCAULT_DATA_DIR";
  log_ = test::contents(file);
  EXPECT_THAT(data_error(), HasSubstr("no position of a NovAtel receiver with a solution: 835"));
  log_ += long_log_at(42, 2100, 600'120'000,
                      packed(0U, 16U, 51.15044, -114.03066, 1097.8, -17.0F, 61U, 1.0F, 1.0F, 2.0F));
  const ImportSummary summary = import();
  EXPECT_EQ(summary.imu.written, 764);
  EXPECT_EQ(summary.imu.without_fix, 2);  // before the first attitude
  EXPECT_EQ(summary.reference->written, 62);
  Eigen::Vector3d dvel = Eigen::Vector3d::Zero();
  double time = 0;
  for (const ImuIncrement& increment : all<ImuIncrement>()) {
    dvel += increment.dvel_b;
    time += increment.dt();
  }
  EXPECT_NEAR(dvel.z() / time, -9.81, 0.01);
}

}  // namespace
}  // namespace foucault::rawlog
