#include "foucault/simulation/simulated_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "foucault/core/error.h"
#include "foucault/core/time.h"

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
