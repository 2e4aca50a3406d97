#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "foucault/core/time.h"
#include "foucault/geodesy/place.h"
#include "foucault/simulation/simulated_source.h"
#include "methods.h"
#include "settings.h"

/// A trip in a city whose lever arm was measured wrong and whose fixes are stamped late: what each
/// method makes of it at the end, against what was put in.
namespace foucault::app {
namespace {

const Eigen::Vector3d kArmError(0.06, -0.05, 0.04);  ///< true less given, forward-right-down [m]
constexpr double kLate = 0.004;                      ///< [s]

simulation::ScenarioOptions city(int64_t seed) {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = 500;
  scenario.seed = seed;
  return scenario;
}

bool comes_before(const Measurement& a, const Measurement& b) {
  const bool is_fix = std::holds_alternative<GnssFix>(a);
  return stamp(a) < stamp(b) ||
         (stamp(a) == stamp(b) && is_fix && !std::holds_alternative<GnssFix>(b));
}

std::vector<Measurement> recording(simulation::SimulatedSource& source, double late) {
  std::vector<Measurement> all;
  while (const std::optional<Measurement> measurement = source.next()) {
    all.push_back(*measurement);
    if (auto* fix = std::get_if<GnssFix>(&all.back())) {
      fix->t_ns += nanoseconds(late);
      fix->p_b_a -= source.mounting().q_v_b.conjugate() * kArmError;
    }
  }
  std::stable_sort(all.begin(), all.end(), comes_before);
  return all;
}

class LastEpoch : public state::Sink {
 public:
  void epoch(const state::Epoch& epoch) override { last = epoch; }
  state::Epoch last;
};

/// Errors of the slow blocks over their sigmas.
struct Found {
  double offset = 0, offset_sigma = 0;
  Eigen::Vector3d arm = Eigen::Vector3d::Zero(), arm_sigma = Eigen::Vector3d::Zero();
};

Found drive(const std::string& method, int64_t seed, double late) {
  Settings settings;
  settings.imu.preset = "ADIS16465";
  settings.calibrate.time_offset = "on";
  settings.calibrate.lever_arm = "on";
  settings.calibrate.lever_arm_sigma_m = 0.05;
  simulation::SimulatedSource source(city(seed), settings.imu.noise());
  LastEpoch sink;
  const auto estimator =
      methods::find(method).make(method_options(settings, source.mounting()), sink);
  for (const Measurement& measurement : recording(source, late)) estimator->process(measurement);
  estimator->finish();
  const state::Layout layout = settings.calibrate.layout();
  const state::SlowBlock& offset = *layout.find(state::block::time_offset);
  const state::SlowBlock& arm = *layout.find(state::block::lever_arm);
  const Eigen::Matrix3d R_v_b = source.mounting().q_v_b.toRotationMatrix();
  const state::StateMatrix& P = sink.last.covariance;
  Found found;
  found.offset = sink.last.slow[offset.index] - late;
  found.offset_sigma = std::sqrt(state::part(P, offset, offset)(0, 0));
  found.arm = R_v_b * sink.last.slow.segment<3>(arm.index) - kArmError;
  found.arm_sigma = (R_v_b * state::part(P, arm, arm) * R_v_b.transpose()).diagonal().cwiseSqrt();
  return found;
}

class Calibration : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Calibration, ::testing::Values("ekf", "rts", "full", "batch"));

/// An RTK fix of 1 cm at 10 m/s knows its time to 1 ms, 500 of them much better; a car turns and so
/// shows the horizontal arm to millimetres, the vertical one only where it leans.
TEST_P(Calibration, LeverArmAndTimeOffsetAreFound) {
  const Found found = drive(GetParam(), 3, kLate);
  EXPECT_LT(std::abs(found.offset), 4 * found.offset_sigma);
  EXPECT_LT(found.offset_sigma, 1.5e-3);
  for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(found.arm[i]), 4 * found.arm_sigma[i]) << i;
  EXPECT_LT(found.arm_sigma.head<2>().maxCoeff(), 0.01);
  EXPECT_GT(found.arm_sigma.z(), 0.02);  // it stays near its prior, 0.05
}

/// Over seeds the errors are as large as their sigmas say: 95 % of the chi-square of 12 x 4 degrees
/// of freedom lies within 31 and 69.
TEST(CalibrationOverSeeds, ErrorsAreAsLargeAsTheirSigmas) {
  double squares = 0;
  constexpr int kTrips = 12;
  for (int seed = 1; seed <= kTrips; ++seed) {
    const Found found = drive("ekf", seed, 0.001 * (seed % 5));
    squares += std::pow(found.offset / found.offset_sigma, 2) +
               found.arm.cwiseQuotient(found.arm_sigma).squaredNorm();
  }
  EXPECT_GT(squares, 31);
  EXPECT_LT(squares, 69);
}

/// Of 1 cm, 0.7 of it from one fix to the next.
class LastingError {
 public:
  explicit LastingError(int64_t seed) : rng_(static_cast<unsigned>(seed)), error_(draw()) {}

  void add_to(GnssFix& fix) {
    constexpr double kSigma = 0.01, kKept = 0.7;
    fix.antenna = geodesy::displaced(fix.antenna, kSigma * error_, geodesy::Place(fix.antenna));
    error_ = kKept * error_ + std::sqrt(1 - kKept * kKept) * draw();
  }

 private:
  Eigen::Vector3d draw() { return {normal_(rng_), normal_(rng_), normal_(rng_)}; }

  std::mt19937 rng_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d error_;
};

/// Error of the offset over its sigma, with a consumer's IMU and RTK four times a second.
double offset_among_lasting_errors(const std::string& method, int64_t seed) {
  Settings settings;
  settings.imu.preset = "ADIS16465";
  settings.imu.arw_deg_sqrt_h = 3.4;
  settings.imu.vrw_m_s_sqrt_h = 0.6;
  settings.calibrate.time_offset = "on";
  settings.calibrate.time_offset_sigma_s = 0.01;
  simulation::ScenarioOptions scenario;
  scenario.duration_s = 400;
  scenario.seed = seed;
  scenario.imu_rate_hz = 100;
  scenario.gnss_rate_hz = 4;
  scenario.gnss_noise = false;
  simulation::SimulatedSource source(scenario, settings.imu.noise());
  LastEpoch sink;
  const auto estimator =
      methods::find(method).make(method_options(settings, source.mounting()), sink);
  LastingError error(seed);
  while (std::optional<Measurement> measurement = source.next()) {
    if (auto* fix = std::get_if<GnssFix>(&*measurement)) error.add_to(*fix);
    estimator->process(*measurement);
  }
  estimator->finish();
  const state::Layout layout = settings.calibrate.layout();
  const state::SlowBlock& offset = *layout.find(state::block::time_offset);
  return sink.last.slow[offset.index] /
         std::sqrt(state::part(sink.last.covariance, offset, offset)(0, 0));
}

/// The velocity that a filter sees the offset by has the noise of the last fixes, that of a batch
/// has not. A mean of four is within 1.5 sigmas.
TEST(CalibrationAmongLastingErrors, BatchFindsTheTimeOffset) {
  double batch = 0, filter = 0;
  for (int64_t seed = 1; seed <= 4; ++seed) {
    batch += offset_among_lasting_errors("batch", seed) / 4;
    filter += offset_among_lasting_errors("ekf", seed) / 4;
  }
  EXPECT_LT(std::abs(batch), 1.5);
  EXPECT_LT(filter, -1.5);  // what the data would show of a batch that did as a filter does
}

}  // namespace
}  // namespace foucault::app
