#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::Scratch;

constexpr int64_t kBegin = 1'750'000'000'000'000'000;

/// What a log gave out, by kind and in order.
struct Contents {
  std::vector<Measurement> all;
  std::vector<ImuIncrement> increments;
  std::vector<GnssFix> fixes;
  std::vector<ReferencePose> references;
  std::vector<WheelSpeed> speeds;
};

Contents read_all(state::Source& source) {
  Contents contents;
  while (const std::optional<Measurement> m = source.next()) {
    contents.all.push_back(*m);
    if (const auto* increment = std::get_if<ImuIncrement>(&*m)) {
      contents.increments.push_back(*increment);
    } else if (const auto* fix = std::get_if<GnssFix>(&*m)) {
      contents.fixes.push_back(*fix);
    } else if (const auto* reference = std::get_if<ReferencePose>(&*m)) {
      contents.references.push_back(*reference);
    } else if (const auto* speed = std::get_if<WheelSpeed>(&*m)) {
      contents.speeds.push_back(*speed);
    }
  }
  return contents;
}

Eigen::Vector3d random_vector(std::mt19937& rng, double scale) {
  std::uniform_real_distribution<double> uniform(-scale, scale);
  return {uniform(rng), uniform(rng), uniform(rng)};
}

/// Increments with jitter in their length, stamps to the nanosecond.
std::vector<ImuIncrement> random_increments(std::mt19937& rng, int count) {
  std::uniform_int_distribution<int64_t> jitter(-400'000, 400'000);
  std::vector<ImuIncrement> increments;
  int64_t t_ns = kBegin + 37;
  for (int i = 0; i < count; ++i) {
    ImuIncrement increment;
    increment.t_begin_ns = t_ns;
    t_ns += 5'000'000 + jitter(rng);
    increment.t_end_ns = t_ns;
    increment.dtheta_b = random_vector(rng, 1e-3);
    increment.dvel_b = random_vector(rng, 5e-2);
    increments.push_back(increment);
  }
  return increments;
}

GnssFix some_fix(int64_t t_ns) {
  GnssFix fix;
  fix.t_ns = t_ns;
  fix.antenna = {40.0966268 * kDegree, -105.1474483 * kDegree, 1584.974};
  fix.position_covariance = Eigen::Vector3d(0.0099, 0.012, 0.021).cwiseAbs2().asDiagonal();
  fix.quality = FixQuality::fixed_rtk;
  return fix;
}

state::Mounting tilted_mounting() {
  // x backward, y right, z up, then pitched and yawed: as consumer IMUs are glued into cars.
  const Eigen::Quaterniond backward_right_up(0, 0, 1, 0);
  return {so3::from_euler({0.01, -0.118, 0.093}) * backward_right_up};
}

TEST(RoundTrip, IncrementsToDoubleRounding) {
  std::mt19937 rng{42};
  const std::vector<ImuIncrement> written = random_increments(rng, 500);
  const Scratch scratch;
  RawlogWriter writer(scratch.path("a.rawlog"));
  writer.write(some_fix(kBegin + 1'000'000'000));
  for (const ImuIncrement& increment : written) writer.write(increment);
  writer.finish();

  RawlogSource source(scratch.path("a.rawlog"));
  const Contents read = read_all(source);
  ASSERT_EQ(read.increments.size(), written.size());
  for (size_t i = 0; i < written.size(); ++i) {
    const ImuIncrement& a = written[i];
    const ImuIncrement& b = read.increments[i];
    // Two roundings, of the quotient and of the product.
    const double tolerance = 2 * std::numeric_limits<double>::epsilon();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(a.dtheta_b[axis], b.dtheta_b[axis], tolerance * std::abs(a.dtheta_b[axis]));
      EXPECT_NEAR(a.dvel_b[axis], b.dvel_b[axis], tolerance * std::abs(a.dvel_b[axis]));
    }
    EXPECT_LE(std::abs(a.t_end_ns - b.t_end_ns), 50);  // MRPT's clock ticks in 100 ns
    if (i > 0) {
      EXPECT_EQ(b.t_begin_ns, read.increments[i - 1].t_end_ns);
    }
  }
  EXPECT_DOUBLE_EQ(source.progress(), 1);
}

TEST(RoundTrip, SamplesExactly) {
  const Scratch scratch;
  RawlogWriter writer(scratch.path("a.rawlog"));
  std::mt19937 rng{1};
  std::vector<imu::ImuSample> samples;
  for (int64_t i = 0; i < 20; ++i) {
    samples.push_back({kBegin + i * 10'000'000, random_vector(rng, 1), random_vector(rng, 10)});
    writer.write(samples.back());
  }
  writer.write(some_fix(kBegin));
  writer.finish();
  RawlogSource source(scratch.path("a.rawlog"), imu::SampleKind::instantaneous);
  const Contents read = read_all(source);
  ASSERT_EQ(read.increments.size(), 19U);
  for (int i = 0; i < 19; ++i) {
    const Eigen::Vector3d mean = 0.5 * (samples[i].gyro_b + samples[i + 1].gyro_b) * 0.01;
    EXPECT_LT((read.increments[i].dtheta_b - mean).norm(), 1e-15);
  }
}

TEST(RoundTrip, MountingAndLeverArm) {
  const Scratch scratch;
  const state::Mounting mounting = tilted_mounting();
  GnssFix fix = some_fix(kBegin + 500'000'000);
  fix.p_b_a = {0.3, -0.2, 1.1};
  RawlogWriter writer(scratch.path("a.rawlog"), mounting);
  std::mt19937 rng{2};
  for (const ImuIncrement& increment : random_increments(rng, 200)) writer.write(increment);
  writer.write(fix);
  writer.finish();

  RawlogSource source(scratch.path("a.rawlog"));
  EXPECT_LT(source.mounting().q_v_b.angularDistance(mounting.q_v_b), 1e-12);
  EXPECT_LT((source.lever_arm() - fix.p_b_a).norm(), 1e-12);
  const Contents read = read_all(source);
  ASSERT_EQ(read.fixes.size(), 1U);
  EXPECT_LT((read.fixes[0].p_b_a - fix.p_b_a).norm(), 1e-12);
}

class FixRoundTrip : public ::testing::Test {
 protected:
  GnssFix through_a_log(const GnssFix& fix) {
    RawlogWriter writer(scratch_.path("a.rawlog"));
    std::mt19937 rng{3};
    for (const ImuIncrement& increment : random_increments(rng, 20)) writer.write(increment);
    writer.write(fix);
    writer.finish();
    RawlogSource source(scratch_.path("a.rawlog"));
    const Contents read = read_all(source);
    EXPECT_EQ(read.fixes.size(), 1U);
    return read.fixes.at(0);
  }

  Scratch scratch_;
};

// Degrees as double resolve 1e-14 deg, a nanometre; sigmas are float, 1.2e-7 of their value.
constexpr double kFloatRelative = 2.5e-7;

TEST_F(FixRoundTrip, Position) {
  const GnssFix fix = some_fix(kBegin + 12'345'600);
  const GnssFix read = through_a_log(fix);
  EXPECT_EQ(read.t_ns, fix.t_ns);
  EXPECT_NEAR(read.antenna.latitude, fix.antenna.latitude, 4e-16);
  EXPECT_NEAR(read.antenna.longitude, fix.antenna.longitude, 4e-16);
  EXPECT_EQ(read.antenna.height, fix.antenna.height);
  EXPECT_TRUE(read.position_covariance.isApprox(fix.position_covariance, kFloatRelative));
  EXPECT_FALSE(read.velocity_n);
}

TEST_F(FixRoundTrip, VelocityAndItsCovariance) {
  GnssFix fix = some_fix(kBegin);
  fix.velocity_n = Eigen::Vector3d(12.5, -3.25, 0.125);
  fix.velocity_covariance << 4e-3, 1e-3, -2e-4, 1e-3, 9e-3, 5e-4, -2e-4, 5e-4, 1e-2;
  const GnssFix read = through_a_log(fix);
  ASSERT_TRUE(read.velocity_n);
  EXPECT_LT((*read.velocity_n - *fix.velocity_n).norm(), 1e-13);
  EXPECT_TRUE(read.velocity_covariance.isApprox(fix.velocity_covariance, 1e-6));
  EXPECT_TRUE(read.position_covariance.isApprox(fix.position_covariance, kFloatRelative));
}

/// North, east, south, west, and near the seam.
TEST_F(FixRoundTrip, Heading) {
  for (const double degrees : {0.0, 90.0, 179.9999, -90.0, -179.9999, 12.345}) {
    GnssFix fix = some_fix(kBegin);
    fix.heading = GnssHeading{degrees * kDegree, 0.25 * kDegree, 0};
    const GnssFix read = through_a_log(fix);
    ASSERT_TRUE(read.heading);
    EXPECT_NEAR(so3::wrap(read.heading->azimuth - fix.heading->azimuth), 0, 1e-14) << degrees;
    EXPECT_NEAR(read.heading->sigma, fix.heading->sigma, 1e-17);
  }
  EXPECT_FALSE(through_a_log(some_fix(kBegin)).heading);
}

TEST_F(FixRoundTrip, CorrelatedPosition) {
  GnssFix fix = some_fix(kBegin);
  fix.position_covariance << 4e-4, -1e-4, 2e-4, -1e-4, 9e-4, 1e-4, 2e-4, 1e-4, 2.5e-3;
  const GnssFix read = through_a_log(fix);
  EXPECT_TRUE(read.position_covariance.isApprox(fix.position_covariance, 1e-6));
  EXPECT_FALSE(read.velocity_n);
}

TEST_F(FixRoundTrip, EveryQuality) {
  for (const FixQuality quality :
       {FixQuality::unknown, FixQuality::single, FixQuality::differential, FixQuality::ppp,
        FixQuality::float_rtk, FixQuality::fixed_rtk}) {
    GnssFix fix = some_fix(kBegin);
    fix.quality = quality;
    EXPECT_EQ(through_a_log(fix).quality, quality);
  }
}

TEST_F(FixRoundTrip, ZeroSigmaIsLeftToTheEstimator) {
  GnssFix fix = some_fix(kBegin);
  fix.position_covariance.setZero();
  EXPECT_EQ(through_a_log(fix).position_covariance, Eigen::Matrix3d::Zero());
}

TEST(RoundTrip, ReferencesAndWheelSpeeds) {
  const Scratch scratch;
  ReferencePose full{kBegin + 10'000'000,
                     {30.45 * kDegree, 114.47 * kDegree, 19.999},
                     Eigen::Vector3d(3, -4, 0.5),
                     so3::from_euler({0.02, -1.3, 5.9})};
  ReferencePose bare{kBegin + 20'000'000, full.position, std::nullopt, std::nullopt};
  RawlogWriter writer(scratch.path("a.rawlog"), tilted_mounting());
  std::mt19937 rng{4};
  for (const ImuIncrement& increment : random_increments(rng, 20)) writer.write(increment);
  writer.write(some_fix(kBegin));
  writer.write(full);
  writer.write(bare);
  writer.write(WheelSpeed{kBegin + 30'000'000, 7.25});
  writer.finish();

  RawlogSource source(scratch.path("a.rawlog"));
  const Contents read = read_all(source);
  ASSERT_EQ(read.references.size(), 2U);
  EXPECT_EQ(read.references[0].t_ns, full.t_ns);
  EXPECT_NEAR(read.references[0].position.latitude, full.position.latitude, 4e-16);
  EXPECT_NEAR(read.references[0].position.height, full.position.height, 1e-9);
  EXPECT_EQ(*read.references[0].velocity_n, *full.velocity_n);
  EXPECT_LT(read.references[0].q_n_v->angularDistance(*full.q_n_v), 1e-12);
  EXPECT_FALSE(read.references[1].velocity_n);
  EXPECT_FALSE(read.references[1].q_n_v);
  ASSERT_EQ(read.speeds.size(), 1U);
  EXPECT_EQ(read.speeds[0].forward, 7.25);
  EXPECT_EQ(source.counts().references, 2);
  EXPECT_EQ(source.counts().wheel_speeds, 1);
  EXPECT_TRUE(source.counts().skipped.empty());
}

TEST(RoundTrip, MeasurementsComeInOrderAndIncrementsLast) {
  const Scratch scratch;
  RawlogWriter writer(scratch.path("a.rawlog"));
  for (int64_t i = 0; i <= 100; ++i) {
    writer.write(imu::ImuSample{kBegin + i * 10'000'000, {0, 0, 0}, {0, 0, -9.8}});
  }
  for (const int64_t i : {30, 20, 60}) writer.write(some_fix(kBegin + i * 10'000'000));
  writer.write(WheelSpeed{kBegin + 200'000'000, 1});
  writer.finish();
  RawlogSource source(scratch.path("a.rawlog"));
  const Contents read = read_all(source);
  ASSERT_EQ(read.fixes.size(), 3U);
  for (size_t i = 1; i < read.all.size(); ++i) {
    const int64_t before = stamp(read.all[i - 1]);
    const int64_t now = stamp(read.all[i]);
    EXPECT_LE(before, now);
    const bool increment_before = std::holds_alternative<ImuIncrement>(read.all[i - 1]);
    EXPECT_FALSE(before == now && increment_before);
  }
}

TEST(Reorder, LateFixesArePutRightWithinTheBufferAndCountedBeyond) {
  const Scratch scratch;
  RawlogWriter writer(scratch.path("a.rawlog"));
  for (int64_t i = 0; i <= 600; ++i) {
    const int64_t t_ns = kBegin + i * 10'000'000;
    writer.write(imu::ImuSample{t_ns, {0, 0, 0}, {0, 0, -9.8}});
    if (i == 300) writer.write(some_fix(t_ns - 1'500'000'000));
    if (i == 500) writer.write(some_fix(t_ns - 2'500'000'000));
  }
  writer.finish();
  RawlogSource source(scratch.path("a.rawlog"));
  const Contents read = read_all(source);
  ASSERT_EQ(read.fixes.size(), 1U);
  EXPECT_EQ(read.fixes[0].t_ns, kBegin + 1'500'000'000);
  EXPECT_EQ(source.counts().late, 1);
  ASSERT_EQ(source.notices().size(), 1U);
  EXPECT_EQ(source.notices()[0].t_ns, kBegin + 2'500'000'000);

  RawlogOptions patient;
  patient.reorder_s = 3;
  RawlogSource second(scratch.path("a.rawlog"), imu::SampleKind::interval_mean, patient);
  EXPECT_EQ(read_all(second).fixes.size(), 2U);
  EXPECT_EQ(second.counts().late, 0);
}

TEST(Reorder, AFixThatCanNoLongerPrecedeItsIncrementIsLate) {
  const Scratch scratch;
  RawlogWriter writer(scratch.path("a.rawlog"));
  writer.write(some_fix(kBegin));
  for (int64_t i = 0; i <= 100; ++i) {
    const int64_t t_ns = kBegin + i * 10'000'000;
    writer.write(imu::ImuSample{t_ns, {0, 0, 0}, {0, 0, -9.8}});
    if (i == 50) writer.write(some_fix(t_ns));
  }
  writer.finish();
  RawlogOptions impatient;
  impatient.reorder_s = 0;
  RawlogSource source(scratch.path("a.rawlog"), imu::SampleKind::interval_mean, impatient);
  EXPECT_EQ(read_all(source).fixes.size(), 1U);
  EXPECT_EQ(source.counts().late, 1);
}

TEST(Writer, LeavesNothingUnlessFinished) {
  const Scratch scratch;
  {
    RawlogWriter writer(scratch.path("a.rawlog"));
    writer.write(some_fix(kBegin));
    EXPECT_FALSE(std::filesystem::exists(scratch.path("a.rawlog")));
  }
  EXPECT_TRUE(scratch.names().empty());
  RawlogWriter writer(scratch.path("a.rawlog"));
  writer.write(some_fix(kBegin));
  writer.finish();
  EXPECT_THAT(scratch.names(), ::testing::ElementsAre("a.rawlog"));
}

TEST(Writer, KeepsAnOlderFileWhenItFails) {
  const Scratch scratch;
  scratch.text_file("a.rawlog", "precious");
  GnssFix broken = some_fix(kBegin);
  broken.antenna.height = std::nan("");
  const std::string what = test::error_of<DataError>([&] {
    RawlogWriter writer(scratch.path("a.rawlog"));
    writer.write(broken);
  });
  EXPECT_THAT(what, ::testing::HasSubstr("2025-06-15T15:06:40.000Z is not finite"));
  EXPECT_EQ(test::contents(scratch.path("a.rawlog")), "precious");
}

TEST(Writer, SaysWhereItCannotWrite) {
  const Scratch scratch;
  EXPECT_THAT(test::error_of<DataError>([&] { RawlogWriter writer(scratch.path("no/a.rawlog")); }),
              ::testing::HasSubstr("No such file or directory"));
  EXPECT_THAT(test::error_of<DataError>([&] { RawlogWriter writer(scratch.path("")); }),
              ::testing::HasSubstr("is a directory"));
}

TEST(RoundTrip, NotesStandBeforeAllElse) {
  const Scratch scratch;
  GnssFix fix;
  fix.t_ns = kBegin;
  fix.antenna = {0.8, 0.1, 400};
  fix.position_covariance.setIdentity();
  std::mt19937 rng{3};
  for (const char* lever_arm : {"given", "unknown", "not_told"}) {
    const std::string path = scratch.path("notes.rawlog");
    RecordingNotes notes;
    notes.lever_arm = lever_arm;
    notes.imu.samples = "instantaneous";
    notes.imu.arw_deg_sqrt_h = 3.4;
    {
      RawlogWriter writer(path);
      writer.write(notes);
      writer.write(fix);
      for (const ImuIncrement& increment : random_increments(rng, 10)) writer.write(increment);
      writer.finish();
    }
    const RecordingNotes read = read_notes(path);
    EXPECT_EQ(read.lever_arm, lever_arm);
    EXPECT_EQ(read.imu.samples, "instantaneous");
    EXPECT_EQ(read.imu.arw_deg_sqrt_h, 3.4);
    EXPECT_FALSE(read.imu.vrw_m_s_sqrt_h);
    RawlogSource source(path);
    const Contents contents = read_all(source);
    ASSERT_EQ(contents.fixes.size(), 1U);
    EXPECT_EQ(contents.fixes[0].lever_arm_known, lever_arm == std::string("given"));
    EXPECT_TRUE(source.counts().skipped.empty());
  }
}

TEST(RoundTrip, ALogWithoutNotesTellsNothing) {
  const Scratch scratch;
  const std::string path = scratch.path("bare.rawlog");
  GnssFix fix;
  fix.t_ns = kBegin;
  fix.antenna = {0.8, 0.1, 400};
  fix.position_covariance.setIdentity();
  fix.p_b_a = Eigen::Vector3d(1, 0, 0);
  std::mt19937 rng{3};
  {
    RawlogWriter writer(path);
    writer.write(fix);
    for (const ImuIncrement& increment : random_increments(rng, 10)) writer.write(increment);
    writer.finish();
  }
  EXPECT_EQ(read_notes(path).lever_arm, "not_told");
  RawlogSource source(path);
  EXPECT_TRUE(read_all(source).fixes.at(0).lever_arm_known);  // it is there
}

TEST(RoundTrip, WhatAReceiverTellsOfAFix) {
  const Scratch scratch;
  const std::string path = scratch.path("details.rawlog");
  GnssFix fix;
  fix.t_ns = kBegin;
  fix.antenna = {0.8, 0.1, 400};
  fix.position_covariance.setIdentity();
  fix.details = {17, 0.75, 1.5};
  std::mt19937 rng{3};
  {
    RawlogWriter writer(path);
    writer.write(fix);
    fix.t_ns += 1'000'000;
    fix.details = {};
    writer.write(fix);
    for (const ImuIncrement& increment : random_increments(rng, 10)) writer.write(increment);
    writer.finish();
  }
  RawlogSource source(path);
  const Contents contents = read_all(source);
  ASSERT_EQ(contents.fixes.size(), 2U);
  EXPECT_EQ(contents.fixes[0].details.satellites, 17);
  EXPECT_EQ(contents.fixes[0].details.hdop, 0.75);
  EXPECT_EQ(contents.fixes[0].details.correction_age, 1.5);
  EXPECT_FALSE(contents.fixes[1].details.satellites);
  EXPECT_FALSE(contents.fixes[1].details.hdop);
  EXPECT_FALSE(contents.fixes[1].details.correction_age);
}

}  // namespace
}  // namespace foucault::rawlog
