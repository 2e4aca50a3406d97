#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "foucault/rawlog/rawlog_info.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "mrpt_log.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::gps_at;
using test::imu_at;
using test::Scratch;

constexpr int64_t kBegin = 1'600'000'000'000'000'000;
constexpr int64_t kMs = 1'000'000;

const StreamInfo& stream(const RawlogInfo& info, const std::string& label) {
  for (const StreamInfo& stream : info.streams) {
    if (stream.label == label) return stream;
  }
  throw std::out_of_range(label);
}

TEST(Info, RatesGapsAndOrder) {
  const Scratch scratch;
  {
    test::GzLog log(scratch.path("a.rawlog"));
    for (int64_t i = 0; i < 1000; ++i) {
      if (i >= 300 && i < 350) continue;  // half a second missing
      if (i == 700) continue;             // a single sample missing
      log.write(imu_at(kBegin + i * 10 * kMs));
    }
    log.write(imu_at(kBegin + 9990 * kMs));  // again
    log.write(imu_at(kBegin + 9980 * kMs));  // back
    auto undated = imu_at(0);
    undated.timestamp = mrpt::system::TTimeStamp();
    log.write(undated);
  }
  const RawlogInfo info = read_rawlog_info(scratch.path("a.rawlog"));
  EXPECT_TRUE(info.compressed);
  EXPECT_FALSE(info.sensory_frames);
  EXPECT_FALSE(info.damage);
  EXPECT_EQ(info.records, 952);
  const StreamInfo& imu = stream(info, "imu");
  EXPECT_EQ(imu.type, "CObservationIMU");
  EXPECT_EQ(imu.count, 952);
  EXPECT_EQ(imu.first_ns, kBegin);
  EXPECT_EQ(imu.last_ns, kBegin + 9990 * kMs);
  EXPECT_NEAR(imu.median_interval, 0.01, 1e-9);
  EXPECT_EQ(imu.duplicates, 1);
  EXPECT_EQ(imu.backward, 1);
  EXPECT_EQ(imu.without_stamp, 1);
  EXPECT_EQ(imu.gap_count, 2);
  ASSERT_EQ(imu.longest_gaps.size(), 2U);
  EXPECT_NEAR(imu.longest_gaps[1].length, 0.02, 1e-9);
  EXPECT_EQ(imu.longest_gaps[0].t_ns, kBegin + 2990 * kMs);
  EXPECT_NEAR(imu.longest_gaps[0].length, 0.51, 1e-9);
}

TEST(Info, KeepsTheLongestGapsInOrderOfTime) {
  const Scratch scratch;
  {
    test::GzLog log(scratch.path("a.rawlog"));
    int64_t t_ns = kBegin;
    for (int64_t i = 0; i < 500; ++i) {
      // Every tenth interval is a gap, the later the longer.
      t_ns += i % 10 == 9 ? 20 * kMs + i * kMs : 10 * kMs;
      log.write(imu_at(t_ns));
    }
  }
  const StreamInfo imu = stream(read_rawlog_info(scratch.path("a.rawlog")), "imu");
  EXPECT_EQ(imu.gap_count, 50);
  ASSERT_EQ(imu.longest_gaps.size(), 20U);
  EXPECT_NEAR(imu.longest_gaps.back().length, 0.519, 1e-9);
  for (size_t i = 1; i < imu.longest_gaps.size(); ++i) {
    EXPECT_LT(imu.longest_gaps[i - 1].t_ns, imu.longest_gaps[i].t_ns);
  }
}

TEST(Info, ReceiversMountingAndLeverArm) {
  const Scratch scratch;
  const state::Mounting mounting{Eigen::Quaterniond(0, 0, 1, 0)};  // x backward, y right, z up
  RawlogWriter writer(scratch.path("a.rawlog"), mounting);
  for (int64_t i = 0; i < 10; ++i) {
    GnssFix fix;
    fix.t_ns = kBegin + i * 250 * kMs;
    fix.antenna = {0.7, 0.1, 100.0 + static_cast<double>(i)};
    const double sigma = i < 8 ? 0.01 : 0.5;
    fix.position_covariance = Eigen::Vector3d(sigma, sigma, 2 * sigma).cwiseAbs2().asDiagonal();
    if (i == 3) fix.position_covariance.setZero();
    fix.quality = i < 8 ? FixQuality::fixed_rtk : FixQuality::float_rtk;
    if (i == 9) {
      fix.velocity_n = Eigen::Vector3d(1, 2, 3);
      fix.velocity_covariance.setIdentity();
    }
    fix.p_b_a = {-1, 0.5, 2};
    writer.write(fix);
    writer.write(imu::ImuSample{fix.t_ns, {0, 0, 0}, {0, 0, 9.8}});
  }
  writer.write(ReferencePose{kBegin, {0.7, 0.1, 100}, std::nullopt, std::nullopt});
  writer.finish();

  const RawlogInfo info = read_rawlog_info(scratch.path("a.rawlog"));
  EXPECT_EQ(info.imu_label, "IMU");
  ASSERT_TRUE(info.mounting);
  EXPECT_LT(info.mounting->q_v_b.angularDistance(mounting.q_v_b), 1e-12);
  ASSERT_EQ(info.receivers.size(), 1U);
  const GnssInfo& gnss = info.receivers[0];
  EXPECT_EQ(gnss.label, "GNSS");
  const std::map<FixQuality, int64_t> qualities{{FixQuality::fixed_rtk, 8},
                                                {FixQuality::float_rtk, 2}};
  EXPECT_EQ(gnss.qualities, qualities);
  EXPECT_EQ(gnss.bad_sigma, 1);
  EXPECT_EQ(gnss.with_velocity, 1);
  EXPECT_NEAR(gnss.min_sigma.z(), 0.02, 1e-8);
  EXPECT_NEAR(gnss.max_sigma.z(), 1.0, 1e-7);
  EXPECT_DOUBLE_EQ(gnss.first.height, 100);
  EXPECT_DOUBLE_EQ(gnss.last.height, 109);
  EXPECT_TRUE(gnss.p_b_a->isApprox(Eigen::Vector3d(-1, 0.5, 2), 1e-12));
  EXPECT_TRUE(gnss.p_v->isApprox(Eigen::Vector3d(1, 0.5, -2), 1e-12));
  EXPECT_EQ(stream(info, "REFERENCE").count, 1);
}

TEST(Info, FramesAndActionsAreTold) {
  const Scratch scratch;
  {
    test::PlainLog log(scratch.path("a.rawlog"));
    mrpt::obs::CSensoryFrame frame;
    frame.insert(std::make_shared<mrpt::obs::CObservationIMU>(imu_at(kBegin)));
    auto gps = gps_at(kBegin);
    gps.setMsg(test::gga(0));
    frame.insert(std::make_shared<mrpt::obs::CObservationGPS>(gps));
    log.write(mrpt::obs::CActionCollection());
    log.write(frame);
  }
  double last = 0;
  const RawlogInfo info =
      read_rawlog_info(scratch.path("a.rawlog"), [&](double part) { last = part; });
  EXPECT_EQ(last, 1);
  EXPECT_FALSE(info.compressed);
  EXPECT_TRUE(info.sensory_frames);
  EXPECT_EQ(info.records, 2);
  EXPECT_EQ(info.other_records.at("CActionCollection"), 1);
  EXPECT_EQ(info.receivers.at(0).without_position, 1);
}

}  // namespace
}  // namespace foucault::rawlog
