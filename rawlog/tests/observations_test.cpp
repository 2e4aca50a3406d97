#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <algorithm>
#include <array>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/rawlog/rawlog_info.h"
#include "foucault/rawlog/rawlog_source.h"
#include "mrpt_log.h"
#include "nmea_accuracy.h"
#include "scratch.h"

/// Logs as other programs write them: MRPT objects in, measurements out.
namespace foucault::rawlog {
namespace {

namespace gnss = mrpt::obs::gnss;
using test::gga;
using test::gps_at;
using test::imu_at;
using test::Scratch;

constexpr int64_t kBegin = 1'600'000'000'000'000'000;
constexpr int64_t kMs = 1'000'000;

template <class Kind>
std::vector<Kind> all(state::Source& source) {
  std::vector<Kind> found;
  while (const std::optional<Measurement> m = source.next()) {
    if (const Kind* one = std::get_if<Kind>(&*m)) found.push_back(*one);
  }
  return found;
}

class Observations : public ::testing::Test {
 protected:
  /// Two IMU samples around one GPS record.
  std::vector<GnssFix> fixes_of(const mrpt::obs::CObservationGPS& gps) {
    const std::string path = log_with({&gps});
    RawlogSource source(path);
    return all<GnssFix>(source);
  }

  std::string log_with(const std::vector<const mrpt::serialization::CSerializable*>& objects) {
    const std::string path = scratch_.path("log.rawlog");
    test::GzLog log(path);
    log.write(imu_at(kBegin));
    for (const auto* object : objects) log.write(*object);
    log.write(imu_at(kBegin + 10 * kMs));
    log.write(imu_at(kBegin + 20 * kMs));
    return path;
  }

  Scratch scratch_;
};

TEST_F(Observations, ImuIndicesByNameNotByOrder) {
  const auto gps = gps_at(kBegin);
  RawlogSource source(log_with({&gps}), imu::SampleKind::interval_mean);
  const std::vector<ImuIncrement> increments = all<ImuIncrement>(source);
  ASSERT_EQ(increments.size(), 2U);
  EXPECT_TRUE(increments[0].dtheta_b.isApprox(Eigen::Vector3d(1e-4, 2e-4, 3e-4), 1e-14));
  EXPECT_TRUE(increments[0].dvel_b.isApprox(Eigen::Vector3d(1e-3, 2e-3, 9.7e-2), 1e-14));
}

TEST_F(Observations, SensorPosesTurnOnceFromForwardLeftUp) {
  // An IMU with axes forward-left-up, 1 m forward, 0.5 m left, 0.3 m up; the antenna 2 m up.
  auto imu = imu_at(kBegin);
  imu.sensorPose = mrpt::poses::CPose3D(1, 0.5, 0.3, 0, 0, 0);
  auto gps = gps_at(kBegin + 5 * kMs);
  gps.sensorPose = mrpt::poses::CPose3D(0, 0, 2, 0, 0, 0);
  const std::string path = scratch_.path("pose.rawlog");
  {
    test::GzLog log(path);
    for (const int64_t ms : {0, 10, 20}) {
      imu.timestamp = test::mrpt_stamp(kBegin + ms * kMs);
      log.write(imu);
    }
    log.write(gps);
  }
  RawlogSource source(path);
  // Vehicle forward-right-down: sensor y looks left, z up.
  const Eigen::Matrix3d R_v_b = source.mounting().q_v_b.toRotationMatrix();
  EXPECT_TRUE(R_v_b.isApprox(Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix(), 1e-12));
  EXPECT_TRUE(source.lever_arm().isApprox(Eigen::Vector3d(-1, -0.5, 1.7), 1e-12));
}

TEST_F(Observations, LeverArmIsInTheAxesOfATurnedImu) {
  // Yawed by 90 deg to the left: the sensor's x looks left, its y backward, its z up.
  auto imu = imu_at(kBegin);
  imu.sensorPose = mrpt::poses::CPose3D(0, 0, 0, kPi / 2, 0, 0);
  auto gps = gps_at(kBegin + 5 * kMs);
  gps.sensorPose = mrpt::poses::CPose3D(3, 0, 0, 0, 0, 0);
  const std::string path = scratch_.path("pose.rawlog");
  {
    test::GzLog log(path);
    log.write(imu);
    log.write(gps);
  }
  RawlogSource source(path);
  EXPECT_TRUE(source.lever_arm().isApprox(Eigen::Vector3d(0, -3, 0), 1e-12));
}

TEST_F(Observations, GgaHeightIsAltitudePlusSeparationAndSigmaFromQualityAndHdop) {
  const std::vector<GnssFix> fixes = fixes_of(gps_at(kBegin + 5 * kMs));
  ASSERT_EQ(fixes.size(), 1U);
  EXPECT_EQ(fixes[0].t_ns, kBegin + 5 * kMs);
  EXPECT_DOUBLE_EQ(fixes[0].antenna.latitude, 47.5 * kDegree);
  EXPECT_DOUBLE_EQ(fixes[0].antenna.longitude, 8.25 * kDegree);
  EXPECT_DOUBLE_EQ(fixes[0].antenna.height, 447.5);
  EXPECT_EQ(fixes[0].quality, FixQuality::fixed_rtk);
  const NmeaSigma sigma = nmea_sigma(FixQuality::fixed_rtk, 2.0);
  EXPECT_DOUBLE_EQ(sigma.horizontal, 0.03);
  EXPECT_DOUBLE_EQ(std::sqrt(fixes[0].position_covariance(1, 1)), sigma.horizontal);
  EXPECT_DOUBLE_EQ(std::sqrt(fixes[0].position_covariance(2, 2)), sigma.vertical);
  EXPECT_FALSE(fixes[0].velocity_n);
}

TEST_F(Observations, GgaQualities) {
  const std::map<int, FixQuality> expected{{1, FixQuality::single},
                                           {2, FixQuality::differential},
                                           {4, FixQuality::fixed_rtk},
                                           {5, FixQuality::float_rtk},
                                           {8, FixQuality::unknown}};
  for (const auto& [indicator, quality] : expected) {
    auto gps = gps_at(kBegin);
    gps.setMsg(gga(indicator));
    EXPECT_EQ(fixes_of(gps).at(0).quality, quality) << indicator;
  }
}

TEST_F(Observations, NoFixAndDeadReckoningAreLeftOut) {
  for (const int indicator : {0, 6}) {
    auto gps = gps_at(kBegin + 5 * kMs);
    gps.setMsg(gga(indicator));
    const auto good = gps_at(kBegin + 15 * kMs);
    RawlogSource source(log_with({&gps, &good}));
    EXPECT_EQ(all<GnssFix>(source).size(), 1U);
    EXPECT_EQ(source.counts().skipped.at("CObservationGPS (no position)"), 1);
  }
}

TEST_F(Observations, RmcGivesTheVelocityBesideGga) {
  auto gps = gps_at(kBegin);
  gnss::Message_NMEA_RMC rmc;
  rmc.fields.validity_char = 'A';
  rmc.fields.speed_knots = 10;
  rmc.fields.direction_degrees = 90;
  gps.setMsg(rmc);
  const GnssFix fix = fixes_of(gps).at(0);
  ASSERT_TRUE(fix.velocity_n);
  EXPECT_TRUE(fix.velocity_n->isApprox(Eigen::Vector3d(0, 18520.0 / 3600, 0), 1e-12));
  EXPECT_GT(fix.velocity_covariance(2, 2), 10);  // the vertical is open

  rmc.fields.validity_char = 'V';
  gps.setMsg(rmc);
  EXPECT_FALSE(fixes_of(gps).at(0).velocity_n);
}

TEST_F(Observations, VtgGivesTheVelocityBesideGga) {
  auto gps = gps_at(kBegin);
  gnss::Message_NMEA_VTG vtg;
  vtg.fields.ground_speed_knots = 36;
  vtg.fields.true_track = 180;
  gps.setMsg(vtg);
  const GnssFix fix = fixes_of(gps).at(0);
  ASSERT_TRUE(fix.velocity_n);
  EXPECT_NEAR(fix.velocity_n->x(), -18.52, 1e-9);
}

TEST_F(Observations, PzsTurnsItsCovarianceAndVelocityFromEcef) {
  auto gps = gps_at(kBegin);
  gps.messages.clear();
  gnss::Message_TOPCON_PZS pzs;
  pzs.latitude_degrees = 0;
  pzs.longitude_degrees = 90;  // here east is -x, north z, down -y
  pzs.height_meters = 12;
  pzs.Fix = 2;
  pzs.hasPosCov = true;
  pzs.pos_covariance.setZero();
  pzs.pos_covariance(0, 0) = 4;
  pzs.pos_covariance(1, 1) = 9;
  pzs.pos_covariance(2, 2) = 1;
  pzs.pos_covariance(0, 1) = pzs.pos_covariance(1, 0) = 0.5F;
  pzs.hasCartesianPosVel = true;
  pzs.cartesian_vx = 3;
  pzs.cartesian_vy = 5;
  pzs.cartesian_vz = 7;
  pzs.hasVelCov = true;
  pzs.vel_covariance.setZero();
  for (int axis = 0; axis < 3; ++axis) pzs.vel_covariance(axis, axis) = 0.25F;
  gps.setMsg(pzs);
  const GnssFix fix = fixes_of(gps).at(0);
  EXPECT_EQ(fix.quality, FixQuality::fixed_rtk);
  EXPECT_DOUBLE_EQ(fix.antenna.height, 12);
  Eigen::Matrix3d expected;
  expected << 1, 0, 0, 0, 4, 0.5, 0, 0.5, 9;  // cov(east, down) = cov(-x, -y)
  EXPECT_TRUE(fix.position_covariance.isApprox(expected, 1e-12));
  ASSERT_TRUE(fix.velocity_n);
  EXPECT_TRUE(fix.velocity_n->isApprox(Eigen::Vector3d(7, -3, -5), 1e-12));
  EXPECT_TRUE(fix.velocity_covariance.isApprox(0.25 * Eigen::Matrix3d::Identity(), 1e-12));
}

TEST_F(Observations, BestposAddsTheUndulation) {
  auto gps = gps_at(kBegin);
  gps.messages.clear();
  gnss::Message_NV_OEM6_BESTPOS bestpos;
  bestpos.fields.solution_stat = gnss::nv_oem6_solution_status::SOL_COMPUTED;
  bestpos.fields.position_type = gnss::nv_oem6_position_type::L1_FLOAT;
  bestpos.fields.lat = 10;
  bestpos.fields.lon = 20;
  bestpos.fields.hgt = 100;
  bestpos.fields.undulation = -16.5F;
  bestpos.fields.lat_sigma = 0.5F;
  bestpos.fields.lon_sigma = 0.25F;
  bestpos.fields.hgt_sigma = 1;
  gps.setMsg(bestpos);
  const GnssFix fix = fixes_of(gps).at(0);
  EXPECT_DOUBLE_EQ(fix.antenna.height, 83.5);
  EXPECT_EQ(fix.quality, FixQuality::float_rtk);
  const Eigen::Vector3d variances(0.25, 0.0625, 1);
  EXPECT_EQ(Eigen::Vector3d(fix.position_covariance.diagonal()), variances);

  bestpos.fields.solution_stat = gnss::nv_oem6_solution_status::INSUFFICIENT_OBS;
  gps.setMsg(bestpos);
  const auto other = gps_at(kBegin + 15 * kMs);
  RawlogSource source(log_with({&gps, &other}));
  EXPECT_EQ(all<GnssFix>(source).size(), 1U);
}

TEST_F(Observations, InspvasOfASystemThatSitsElsewhereIsMovedToTheImu) {
  // The reference sits 2 m ahead of the IMU and is yawed 90 deg to the left in the vehicle, which
  // heads east, so that it reports north.
  auto reference = gps_at(kBegin + 5 * kMs, "REFERENCE");
  reference.messages.clear();
  reference.sensorPose = mrpt::poses::CPose3D(2, 0, 0, kPi / 2, 0, 0);
  gnss::Message_NV_OEM6_INSPVAS ins;
  ins.fields.lat = 47.5;
  ins.fields.lon = 8.25;
  ins.fields.hgt = 300;
  ins.fields.vel_up = 0.5;
  ins.fields.azimuth = 0;
  reference.setMsg(ins);
  const auto gps = gps_at(kBegin);
  RawlogSource source(log_with({&gps, &reference}));
  const ReferencePose pose = all<ReferencePose>(source).at(0);
  const so3::Euler euler = so3::to_euler(*pose.q_n_v);
  EXPECT_NEAR(euler.heading, kPi / 2, 1e-12);
  EXPECT_NEAR(pose.velocity_n->z(), -0.5, 1e-15);
  const geodesy::LocalFrame at_reference({47.5 * kDegree, 8.25 * kDegree, 300});
  EXPECT_LT((at_reference.to_local(pose.position) - Eigen::Vector3d(0, -2, 0)).norm(), 1e-6);
}

TEST_F(Observations, VelocityOfAReferenceElsewhereIsMovedToTheImu) {
  // The vehicle, heading east, turns right by 0.5 rad/s; the reference 2 m ahead of the IMU swings
  // to the south by 1 m/s more.
  auto imu = imu_at(kBegin);
  imu.set(mrpt::obs::IMU_WX, 0);
  imu.set(mrpt::obs::IMU_WY, 0);
  imu.set(mrpt::obs::IMU_WZ, -0.5);  // up, of an IMU on forward-left-up axes
  auto reference = gps_at(kBegin + 15 * kMs, "REFERENCE");
  reference.messages.clear();
  gnss::Message_NV_OEM6_INSPVAS ins;
  ins.fields.vel_east = 10;
  ins.fields.vel_north = -1;
  ins.fields.azimuth = 90;
  reference.setMsg(ins);
  const auto velocity_with_arm = [&](double arm) {
    reference.sensorPose = mrpt::poses::CPose3D(arm, 0, 0, 0, 0, 0);
    const std::string path = scratch_.path("swing.rawlog");
    {
      test::GzLog log(path);
      log.write(gps_at(kBegin));
      log.write(reference);
      for (int i = 0; i < 4; ++i) {
        imu.timestamp = test::mrpt_stamp(kBegin + i * 10 * kMs);
        log.write(imu);
      }
    }
    RawlogSource source(path);
    return *all<ReferencePose>(source).at(0).velocity_n;
  };
  EXPECT_LT((velocity_with_arm(2) - Eigen::Vector3d(0, 10, 0)).norm(), 1e-12);
  EXPECT_LT((velocity_with_arm(0) - Eigen::Vector3d(-1, 10, 0)).norm(), 1e-15);
}

TEST_F(Observations, InspvasRollPitchAzimuth) {
  auto reference = gps_at(kBegin, "REFERENCE");
  reference.messages.clear();
  gnss::Message_NV_OEM6_INSPVAS ins;
  ins.fields.roll = 5;
  ins.fields.pitch = -8;
  ins.fields.azimuth = 250;
  reference.setMsg(ins);
  const auto gps = gps_at(kBegin);
  RawlogSource source(log_with({&gps, &reference}));
  const so3::Euler euler = so3::to_euler(*all<ReferencePose>(source).at(0).q_n_v);
  EXPECT_NEAR(euler.roll / kDegree, 5, 1e-10);
  EXPECT_NEAR(euler.pitch / kDegree, -8, 1e-10);
  EXPECT_NEAR(euler.heading / kDegree, 250, 1e-10);
}

TEST_F(Observations, RobotPoseIsEastNorthUpAtTheFirstFix) {
  mrpt::obs::CObservationRobotPose robot;
  robot.sensorLabel = "REFERENCE";
  robot.timestamp = test::mrpt_stamp(kBegin + 5 * kMs);
  // 30 m east, 40 m north, 5 m up, nose to the north, nose up by 10 deg (MRPT's pitch is negative).
  robot.pose.mean = mrpt::poses::CPose3D(30, 40, 5, kPi / 2, -10 * kDegree, 0);
  const auto gps = gps_at(kBegin);
  RawlogSource source(log_with({&gps, &robot}));
  const ReferencePose pose = all<ReferencePose>(source).at(0);
  const geodesy::LocalFrame frame({47.5 * kDegree, 8.25 * kDegree, 447.5});
  EXPECT_LT((frame.to_local(pose.position) - Eigen::Vector3d(40, 30, -5)).norm(), 1e-6);
  const so3::Euler euler = so3::to_euler(*pose.q_n_v);
  EXPECT_NEAR(so3::wrap(euler.heading), 0, 1e-5);  // 50 m turn the vertical by 8e-6 rad
  EXPECT_NEAR(euler.pitch, 10 * kDegree, 1e-5);
  EXPECT_NEAR(euler.roll, 0, 1e-5);
  EXPECT_FALSE(pose.velocity_n);
}

TEST_F(Observations, OdometryWithAndWithoutVelocity) {
  mrpt::obs::CObservationOdometry odometry;
  odometry.timestamp = test::mrpt_stamp(kBegin + 5 * kMs);
  const mrpt::obs::CObservationOdometry without = odometry;
  odometry.hasVelocities = true;
  odometry.velocityLocal.vx = 3.5;
  const auto gps = gps_at(kBegin);
  RawlogSource source(log_with({&gps, &without, &odometry}));
  const std::vector<WheelSpeed> speeds = all<WheelSpeed>(source);
  ASSERT_EQ(speeds.size(), 1U);
  EXPECT_EQ(speeds[0].forward, 3.5);
  EXPECT_EQ(source.counts().skipped.at("CObservationOdometry (no velocity)"), 1);
}

TEST_F(Observations, EverythingElseIsCountedByClass) {
  mrpt::obs::CObservationComment comment;
  comment.timestamp = test::mrpt_stamp(kBegin);
  const auto second_imu = imu_at(kBegin + 5 * kMs, "another imu");
  const auto second_gps = gps_at(kBegin + 5 * kMs, "another gps");
  const auto gps = gps_at(kBegin);
  auto undated = gps_at(0);
  undated.timestamp = mrpt::system::TTimeStamp();
  RawlogSource source(log_with({&comment, &gps, &second_imu, &second_gps, &comment, &undated}));
  EXPECT_EQ(all<ImuIncrement>(source).size(), 2U);
  const std::map<std::string, int64_t> expected{{"CObservationComment", 2},
                                                {"CObservationIMU (another label)", 1},
                                                {"CObservationGPS (another label)", 1},
                                                {"CObservationGPS (no stamp)", 1}};
  EXPECT_EQ(source.counts().skipped, expected);
  EXPECT_EQ(source.notices().size(), 4U);
}

TEST_F(Observations, LabelsChooseTheSensors) {
  const auto gps = gps_at(kBegin, "rover");
  const auto other = gps_at(kBegin + 15 * kMs, "phone");
  RawlogOptions options;
  options.gnss_label = "phone";
  RawlogSource source(log_with({&gps, &other}), imu::SampleKind::interval_mean, options);
  EXPECT_EQ(source.gnss_label(), "phone");
  EXPECT_EQ(all<GnssFix>(source).at(0).t_ns, kBegin + 15 * kMs);
}

mrpt::obs::CObservationIMU half(int64_t t_ns, bool rates, double value) {
  using namespace mrpt::obs;
  CObservationIMU imu;
  imu.sensorLabel = rates ? "gyro" : "accel";
  imu.timestamp = test::mrpt_stamp(t_ns);
  for (const auto i :
       rates ? std::array{IMU_WX, IMU_WY, IMU_WZ} : std::array{IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC}) {
    imu.set(i, value);
  }
  return imu;
}

/// Rates at 100 Hz and forces at 50 Hz, both straight lines of time, so that the joined samples are
/// exact; the last rates have no force after them.
TEST_F(Observations, RatesAndForcesInRecordsOfTheirOwnAreJoined) {
  const std::string path = scratch_.path("halves.rawlog");
  {
    test::GzLog log(path);
    log.write(gps_at(kBegin + 100 * kMs));
    for (int i = 0; i <= 100; ++i) {
      log.write(half(kBegin + i * 10 * kMs, true, 0.01 * i));
      if (i % 2 == 0) log.write(half(kBegin + (i * 10 - 3) * kMs, false, 1 + 0.5 * (i - 0.3)));
    }
  }
  RawlogSource source(path, imu::SampleKind::interval_mean);
  const std::vector<ImuIncrement> increments = all<ImuIncrement>(source);
  ASSERT_EQ(increments.size(), 99U);  // of samples 0 to 99: 0 to 98 end an interval, 99 is lost
  for (size_t i = 0; i < increments.size(); ++i) {
    const auto k = static_cast<double>(i + 1);
    ASSERT_EQ(increments[i].t_end_ns, kBegin + static_cast<int64_t>(i + 1) * 10 * kMs);
    EXPECT_NEAR(increments[i].dtheta_b.y(), 0.01 * k * 0.01, 1e-12);
    EXPECT_NEAR(increments[i].dvel_b.z(), (1 + 0.5 * k) * 0.01, 1e-12);
  }
  EXPECT_EQ(read_rawlog_info(path).imu_label, "gyro");
}

/// MRPT's grabber: a record for each sentence, labelled by its kind.
TEST_F(Observations, SentencesOfOneTimeAreJoined) {
  for (const bool velocity_first : {false, true}) {
    const auto position = gps_at(kBegin + 5 * kMs, "gps_NMEA_GGA");
    auto velocity = gps_at(kBegin + 5 * kMs, "gps_NMEA_RMC");
    velocity.messages.clear();
    gnss::Message_NMEA_RMC rmc;
    rmc.fields.validity_char = 'A';
    rmc.fields.speed_knots = 10;
    rmc.fields.direction_degrees = 90;
    velocity.setMsg(rmc);
    auto stale = velocity;
    stale.timestamp = test::mrpt_stamp(kBegin + 6 * kMs);
    const std::string path = velocity_first ? log_with({&velocity, &position})
                                            : log_with({&position, &velocity, &stale});
    RawlogSource source(path);
    const std::vector<GnssFix> fixes = all<GnssFix>(source);
    ASSERT_EQ(fixes.size(), 1U);
    ASSERT_TRUE(fixes[0].velocity_n);
    EXPECT_NEAR(fixes[0].velocity_n->y(), 10 * 1852.0 / 3600, 1e-12);
  }
}

TEST_F(Observations, PositionsOfRmcWhereThereAreNoOthers) {
  auto gps = gps_at(kBegin + 5 * kMs);
  gps.messages.clear();
  gnss::Message_NMEA_RMC rmc;
  rmc.fields.validity_char = 'A';
  rmc.fields.latitude_degrees = 47.5;
  rmc.fields.longitude_degrees = 8.25;
  gps.setMsg(rmc);
  RawlogSource source(log_with({&gps}));
  const std::vector<GnssFix> fixes = all<GnssFix>(source);
  ASSERT_EQ(fixes.size(), 1U);
  EXPECT_DOUBLE_EQ(fixes[0].antenna.latitude, 47.5 * kDegree);
  EXPECT_EQ(fixes[0].position_covariance(2, 2), 1e6);
  ASSERT_EQ(source.notices().size(), 1U);
  EXPECT_THAT(source.notices()[0].text, ::testing::HasSubstr("without heights"));
}

TEST_F(Observations, SensoryFramesReadLikeLooseObservations) {
  const std::string path = scratch_.path("frames.rawlog");
  {
    test::PlainLog log(path);  // uncompressed, too
    for (int64_t i = 0; i < 10; ++i) {
      mrpt::obs::CSensoryFrame frame;
      frame.insert(std::make_shared<mrpt::obs::CObservationIMU>(imu_at(kBegin + i * 10 * kMs)));
      frame.insert(std::make_shared<mrpt::obs::CObservationGPS>(gps_at(kBegin + i * 10 * kMs)));
      log.write(mrpt::obs::CActionCollection());
      log.write(frame);
    }
  }
  RawlogSource increments(path);
  EXPECT_EQ(all<ImuIncrement>(increments).size(), 9U);
  RawlogSource fixes(path);
  EXPECT_EQ(all<GnssFix>(fixes).size(), 10U);
}

TEST_F(Observations, RepeatedImuSamplesAreDroppedAndCounted) {
  const auto gps = gps_at(kBegin);
  const auto again = imu_at(kBegin);
  RawlogSource source(log_with({&gps, &again}));
  EXPECT_EQ(all<ImuIncrement>(source).size(), 2U);
  EXPECT_EQ(source.counts().imu_duplicates, 1);
}

TEST_F(Observations, SamplesOfOneStampAreSpreadInOrder) {
  const std::string path = scratch_.path("pairs.rawlog");
  constexpr int kSamples = 800;
  {
    test::GzLog log(path);
    for (int i = 0; i < kSamples; ++i) {
      auto imu = imu_at(kBegin + (i / 2 * 2 + 1) * 10 * kMs);
      imu.set(mrpt::obs::IMU_WX, 0.001 * i);
      log.write(imu);
      if (i % 100 == 0) log.write(gps_at(kBegin + i * 10 * kMs));
    }
  }
  const RawlogInfo info = read_rawlog_info(path);
  const auto imu_stream = std::find_if(info.streams.begin(), info.streams.end(),
                                       [](const auto& s) { return s.type == "CObservationIMU"; });
  ASSERT_NE(imu_stream, info.streams.end());
  EXPECT_NEAR(imu_stream->burst_samples, 2, 0.02);
  EXPECT_NEAR(imu_stream->median_interval, 0.01, 1e-5);
  EXPECT_EQ(imu_stream->gap_count, 0);
  RawlogSource source(path);
  const std::vector<ImuIncrement> increments = all<ImuIncrement>(source);
  ASSERT_EQ(increments.size(), kSamples - 1U);
  for (int i = 1; i < kSamples; ++i) {
    const ImuIncrement& increment = increments[static_cast<size_t>(i) - 1];
    EXPECT_EQ(increment.t_end_ns, kBegin + i * 10 * kMs);
    EXPECT_NEAR(increment.dt(), 0.01, 1e-9);
    EXPECT_NEAR(increment.dtheta_b.x(), 0.001 * i * 0.01, 1e-12);
  }
  EXPECT_EQ(source.counts().imu_samples, kSamples);
  const std::vector<state::Notice> notices = source.notices();
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_THAT(notices[0].text, ::testing::HasSubstr("800 IMU samples are stamped on arrival, in "
                                                    "400 bursts of 2.0"));
}

/// Here and there a second sample of one stamp is no burst.
TEST_F(Observations, ASecondSampleOfOneStampIsLeftOutWhereTheyAreRare) {
  const std::string path = scratch_.path("twice.rawlog");
  {
    test::GzLog log(path);
    for (int i = 0; i < 400; ++i) {
      auto imu = imu_at(kBegin + i * 10 * kMs);
      log.write(imu);
      imu.set(mrpt::obs::IMU_WX, 7);
      if (i % 100 == 50) log.write(imu);
      if (i % 100 == 0) log.write(gps_at(kBegin + i * 10 * kMs));
    }
  }
  RawlogSource source(path);
  EXPECT_EQ(all<ImuIncrement>(source).size(), 399U);
  EXPECT_EQ(source.counts().imu_samples, 400);
  ASSERT_EQ(source.notices().size(), 1U);
  EXPECT_THAT(source.notices()[0].text, ::testing::HasSubstr("4 x CObservationIMU (stamp comes"));
}

}  // namespace
}  // namespace foucault::rawlog
