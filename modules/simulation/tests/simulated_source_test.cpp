#include "foucault/simulation/simulated_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::simulation {
namespace {

std::vector<Measurement> record(const ScenarioOptions& options, const imu::ImuNoise& noise) {
  SimulatedSource source(options, noise);
  std::vector<Measurement> all;
  while (std::optional<Measurement> m = source.next()) all.push_back(*m);
  return all;
}

template <class T>
std::vector<T> only(const std::vector<Measurement>& all) {
  std::vector<T> some;
  for (const Measurement& m : all) {
    if (const T* value = std::get_if<T>(&m)) some.push_back(*value);
  }
  return some;
}

ScenarioOptions short_trip() {
  ScenarioOptions options;
  options.duration_s = 60;
  return options;
}

const imu::ImuNoise kNoise = imu::imu_preset("ADIS16465");

TEST(SimulatedSource, GivesEveryMeasurementOfEachRate) {
  const std::vector<Measurement> all = record(short_trip(), kNoise);
  EXPECT_EQ(only<GnssFix>(all).size(), 61u);
  EXPECT_EQ(only<ReferencePose>(all).size(), 601u);
  EXPECT_EQ(only<ImuIncrement>(all).size(), 12000u);
  EXPECT_EQ(stamp(all.front()), gps_to_unix_ns(2200, 357000));
  EXPECT_EQ(stamp(all.back()), gps_to_unix_ns(2200, 357060));
}

TEST(SimulatedSource, IsOrderedIncrementsLastAndWithoutHoles) {
  ScenarioOptions options = short_trip();
  options.gnss_rate_hz = 3;
  options.gnss_phase_s = 0.123;
  options.imu_rate_hz = 97;
  const std::vector<Measurement> all = record(options, kNoise);
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_LE(stamp(all[i - 1]), stamp(all[i]));
    if (stamp(all[i - 1]) == stamp(all[i])) {
      EXPECT_LE(all[i - 1].index(), all[i].index());
    }
  }
  const std::vector<ImuIncrement> increments = only<ImuIncrement>(all);
  for (std::size_t i = 1; i < increments.size(); ++i) {
    EXPECT_EQ(increments[i].t_begin_ns, increments[i - 1].t_end_ns);
  }
  EXPECT_EQ(only<GnssFix>(all).front().t_ns, options.start_ns() + 123'000'000);
}

TEST(SimulatedSource, StampsFitMrptsClock) {
  ScenarioOptions options = short_trip();
  options.gnss_rate_hz = 3;
  options.gnss_phase_s = 1.0 / 7;
  options.imu_rate_hz = 150;
  options.gps_sow_s = 357000.123456789;
  for (const Measurement& m : record(options, kNoise)) EXPECT_EQ(stamp(m) % 100, 0);
}

TEST(SimulatedSource, StampsDoNotDrift) {
  const StampSequence thirds(0, 3, 0);
  EXPECT_EQ(thirds.at(1), 333'333'300);
  EXPECT_EQ(thirds.at(3'000'000), 1'000'000'000'000'000);
}

TEST(SimulatedSource, WheelSpeedsStandInTheirOrder) {
  ScenarioOptions options = short_trip();
  options.wheel_rate_hz = 10;
  const std::vector<Measurement> all = record(options, kNoise);
  EXPECT_EQ(only<WheelSpeed>(all).size(), 601u);
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_LE(stamp(all[i - 1]), stamp(all[i]));
    if (stamp(all[i - 1]) == stamp(all[i])) {
      EXPECT_LE(all[i - 1].index(), all[i].index());
    }
  }
  EXPECT_TRUE(only<WheelSpeed>(record(short_trip(), kNoise)).empty());
}

// A vibration of 10 Hz would stand still under samples of 10 Hz, as a speed of 16 mm/s.
TEST(SimulatedSource, WheelSpeedsAreOfTheTruthWithoutItsVibration) {
  ScenarioOptions options = short_trip();
  options.wheel_rate_hz = 10;
  const Trajectory truth = make_trajectory(options);
  options.vibration_m_s2 = 1;
  options.vibration_hz = 10;
  for (const WheelSpeed& speed : only<WheelSpeed>(record(options, kNoise))) {
    const Motion motion = truth.at(seconds_between(options.start_ns(), speed.t_ns));
    const double forward = (motion.q_n_v.conjugate() * motion.velocity_n).x();
    EXPECT_NEAR(speed.forward, forward, std::abs(forward) < 2e-3 ? 1e-3 : 1e-12);
  }
}

TEST(SimulatedSource, FixesAreOfBeforeTheirStamps) {
  ScenarioOptions options = short_trip();
  options.rest_s = 5;
  options.gnss_noise = false;
  options.gnss_time_offset_s = 0.05;
  options.gnss_time_drift_ppm = 1000;
  const Trajectory truth = make_trajectory(options);
  const auto fixes = only<GnssFix>(record(options, kNoise));
  EXPECT_EQ(fixes.size(), 60u);  // what is stamped with the start would be of before it
  double farthest = 0;
  for (const GnssFix& fix : fixes) {
    const double t = seconds_between(options.start_ns(), fix.t_ns);
    const Motion motion = truth.at(t - 0.05 - 0.001 * t);
    const Eigen::Vector3d arm_n = geodesy::LocalFrame(motion.position).to_local(fix.antenna);
    EXPECT_LT((arm_n - motion.q_n_v * options.lever_arm_m).norm(), 2e-8);
    const geodesy::LocalFrame frame(truth.at(t).position);
    farthest = std::max(farthest, frame.to_local(motion.position).norm());
  }
  EXPECT_GT(farthest, 0.5);  // 10 m/s, 0.05 to 0.11 s
}

TEST(SimulatedSource, MountingErrorTurnsTheImuAndNotWhatIsTold) {
  ScenarioOptions options = short_trip();
  options.mounting_deg = {3, 4, 90};
  ScenarioOptions wrong = options, turned = options;
  wrong.mounting_error_deg = {0.5, 2, -3};
  turned.mounting_deg += wrong.mounting_error_deg;
  SimulatedSource source(wrong, kNoise);
  EXPECT_TRUE(source.mounting().q_v_b.isApprox(options.q_v_b()));
  const Eigen::Quaterniond q_n_v = source.trajectory().at(50).q_n_v;
  const Eigen::Quaterniond q_n_b = source.truth(options.start_ns() + 50'000'000'000).q_n_b;
  EXPECT_LT(q_n_b.angularDistance(q_n_v * turned.q_v_b()), 1e-7);
  const std::vector<Measurement> all = record(wrong, kNoise);
  const auto wrong_increments = only<ImuIncrement>(all);
  const auto turned_increments = only<ImuIncrement>(record(turned, kNoise));
  EXPECT_EQ(wrong_increments.back().dtheta_b, turned_increments.back().dtheta_b);
  EXPECT_EQ(wrong_increments.back().dvel_b, turned_increments.back().dvel_b);
  const GnssFix fix = only<GnssFix>(all).back(),
                told = only<GnssFix>(record(options, kNoise)).back();
  EXPECT_EQ(fix.p_b_a, told.p_b_a);
  EXPECT_EQ(fix.antenna.latitude, told.antenna.latitude);
}

TEST(SimulatedSource, RectificationFollowsTheSpeed) {
  ScenarioOptions options = short_trip();
  const auto without = only<ImuIncrement>(record(options, kNoise));
  options.vibration_rectification_m_s2 = 2e-3;
  const Trajectory truth = make_trajectory(options);
  const auto with = only<ImuIncrement>(record(options, kNoise));
  for (std::size_t i = 0; i < with.size(); i += 100) {
    const double t = seconds_between(options.start_ns(), with[i].t_end_ns) - 0.0025;
    const double speed = truth.at(t).velocity_n.norm();
    const Eigen::Vector3d bias = (with[i].dvel_b - without[i].dvel_b) / with[i].dt();
    const double expected = 2e-3 * speed * speed / 225;
    EXPECT_LT((bias.cwiseAbs().array() - expected).abs().maxCoeff(), 1e-8) << t;
  }
  EXPECT_GT(truth.at(59).velocity_n.norm(), 5);
}

TEST(SimulatedSource, CrossAxisTermsAreThoseOfTheOption) {
  ScenarioOptions options = short_trip();
  options.duration_s = 50;
  SimulatedSource exact(options, imu::ImuNoise{});
  options.cross_axis_sigma_ppm = 1000;
  ImuFlaws flaws;
  flaws.cross_axis_sigma = 1e-3;
  ImuErrors errors(imu::ImuNoise{}, flaws, options.seed);
  SimulatedSource source(options, imu::ImuNoise{});
  while (std::optional<Measurement> m = source.next()) {
    const Measurement without = *exact.next();
    const ImuIncrement* increment = std::get_if<ImuIncrement>(&*m);
    if (!increment) continue;
    const ImuIncrement expected = errors.apply(std::get<ImuIncrement>(without));
    ASSERT_EQ(increment->dtheta_b, expected.dtheta_b);
    ASSERT_EQ(increment->dvel_b, expected.dvel_b);
  }
}

TEST(SimulatedSource, ErrorsOfOneSensorLeaveTheOthersAsTheyAre) {
  const std::vector<Measurement> plain = record(short_trip(), kNoise);
  ScenarioOptions options = short_trip();
  options.lever_arm_error_m = {0.1, 0.1, 0.1};
  options.gnss_coloured_sigma = 1;
  options.gnss_time_offset_s = -0.05;
  options.wheel_rate_hz = 10;
  options.wheel_sigma_m_s = 0.1;
  const auto imu = only<ImuIncrement>(plain),
             same_imu = only<ImuIncrement>(record(options, kNoise));
  for (std::size_t i = 0; i < imu.size(); ++i) {
    ASSERT_EQ(imu[i].dtheta_b, same_imu[i].dtheta_b);
    ASSERT_EQ(imu[i].dvel_b, same_imu[i].dvel_b);
  }
  options = short_trip();
  options.cross_axis_sigma_ppm = 1000;
  options.vibration_rectification_m_s2 = 1e-3;
  options.wheel_rate_hz = 10;
  const auto fixes = only<GnssFix>(plain), same_fixes = only<GnssFix>(record(options, kNoise));
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    ASSERT_EQ(fixes[i].antenna.latitude, same_fixes[i].antenna.latitude);
    ASSERT_EQ(fixes[i].antenna.height, same_fixes[i].antenna.height);
  }
}

TEST(SimulatedSource, SeedsReproduce) {
  ScenarioOptions options = short_trip();
  const auto a = only<ImuIncrement>(record(options, kNoise));
  const auto b = only<ImuIncrement>(record(options, kNoise));
  options.seed = 2;
  const auto c = only<ImuIncrement>(record(options, kNoise));
  EXPECT_EQ(a.back().dtheta_b, b.back().dtheta_b);
  EXPECT_EQ(a.back().dvel_b, b.back().dvel_b);
  EXPECT_NE(a.back().dtheta_b, c.back().dtheta_b);
}

TEST(SimulatedSource, ImuNoiseDoesNotChangeTheFixes) {
  const auto noisy = only<GnssFix>(record(short_trip(), kNoise));
  const auto quiet = only<GnssFix>(record(short_trip(), imu::ImuNoise{}));
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    EXPECT_EQ(noisy[i].antenna.latitude, quiet[i].antenna.latitude);
    EXPECT_EQ(noisy[i].antenna.height, quiet[i].antenna.height);
  }
}

TEST(SimulatedSource, ReferenceIsTheTruth) {
  ScenarioOptions options = short_trip();
  options.mounting_deg = {0, 0, 90};
  SimulatedSource source(options, kNoise);
  while (std::optional<Measurement> m = source.next()) {
    const ReferencePose* reference = std::get_if<ReferencePose>(&*m);
    if (!reference) continue;
    const state::Epoch truth = source.truth(reference->t_ns);
    EXPECT_EQ(reference->position.latitude, truth.position.latitude);
    EXPECT_EQ(*reference->velocity_n, truth.velocity_n);
    const Eigen::Quaterniond q_n_b = *reference->q_n_v * source.mounting().q_v_b;
    EXPECT_NEAR(q_n_b.angularDistance(truth.q_n_b), 0, 1e-7);
  }
  EXPECT_EQ(source.progress(), 1.0);
}

TEST(SimulatedSource, TrueBiasIsInTheIncrements) {
  const ScenarioOptions options = short_trip();
  imu::ImuNoise noise = kNoise;
  noise.gyro_noise_density = noise.accel_noise_density = 0;
  SimulatedSource biased(options, noise), perfect(options, imu::ImuNoise{});
  while (std::optional<Measurement> m = biased.next()) {
    const std::optional<Measurement> exact = perfect.next();
    const ImuIncrement* increment = std::get_if<ImuIncrement>(&*m);
    if (!increment) continue;
    const ImuIncrement& without = std::get<ImuIncrement>(*exact);
    const Eigen::Vector3d gyro = (increment->dtheta_b - without.dtheta_b) / increment->dt();
    const Eigen::Vector3d accel = (increment->dvel_b - without.dvel_b) / increment->dt();
    // Half a step of the Gauss-Markov process: sigma sqrt(2 dt / tau) / 2, times five.
    EXPECT_LT((gyro - biased.true_bias().gyro).norm(), 5 * 1e-3 * noise.gyro_bias_sigma);
    EXPECT_LT((accel - biased.true_bias().accel).norm(), 5 * 1e-3 * noise.accel_bias_sigma + 1e-12);
  }
}

TEST(SimulatedSource, LeavesHolesAndContinuesAsIfThereWereNone) {
  ScenarioOptions options = short_trip();
  const auto whole = only<ImuIncrement>(record(options, kNoise));
  options.imu_gap_start_s = {20, 40};
  options.imu_gap_length_s = 3;
  const auto gapped = only<ImuIncrement>(record(options, kNoise));
  EXPECT_EQ(gapped.size(), whole.size() - 2 * 600);
  EXPECT_EQ(gapped.back().dtheta_b, whole.back().dtheta_b);
  EXPECT_EQ(gapped[4000].t_begin_ns - gapped[3999].t_end_ns, 3 * kNanosecondsPerSecond);
}

TEST(SimulatedSource, NoReferenceWhenRateIsZero) {
  ScenarioOptions options = short_trip();
  options.reference_rate_hz = 0;
  EXPECT_TRUE(only<ReferencePose>(record(options, kNoise)).empty());
}

TEST(SimulatedSource, RefusesNonsense) {
  ScenarioOptions options = short_trip();
  options.gnss_sigma_m.z() = 0;
  EXPECT_THROW(SimulatedSource(options, kNoise), UsageError);
  options = short_trip();
  options.rest_s = 60;
  EXPECT_THROW(SimulatedSource(options, kNoise), UsageError);
}

}  // namespace
}  // namespace foucault::simulation
