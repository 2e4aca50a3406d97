/// The EKF through the driver that all methods share, on recordings with troubles of real ones.

#include <gtest/gtest.h>

#include "foucault/navigation/navigation_run.h"
#include "foucault/simulation/simulated_source.h"
#include "trip.h"

namespace foucault::ekf {
namespace {

constexpr double kWarmUp = 120;  ///< until the alignment is over and the filter has settled [s]

/// Errors of the epochs of a run against the truth.
class ErrorSink : public state::Sink {
 public:
  ErrorSink(const simulation::SimulatedSource& truth, int64_t start_ns)
      : truth_(truth), start_ns_(start_ns) {}

  void epoch(const state::Epoch& epoch) override {
    const double t = seconds_between(start_ns_, epoch.t_ns);
    if (t < kWarmUp) return;
    const Geodetic position = truth_.truth(epoch.t_ns).position;
    const Eigen::Vector3d error =
        geodesy::displacement_n(position, epoch.position, geodesy::Place(position));
    const Eigen::Matrix3d covariance = epoch.covariance.topLeftCorner<3, 3>();
    errors.push_back({t, error.norm(), error.dot(covariance.llt().solve(error))});
  }
  void fix(const state::FixResult& result) override {
    if (seconds_between(start_ns_, result.t_ns) < kWarmUp) return;
    if (result.verdict != state::FixVerdict::used) ++rejected;
    const Eigen::Vector3d& v = result.innovation_n;
    nis += v.dot(result.innovation_covariance.llt().solve(v));
    ++fixes;
  }

  struct Error {
    double t, metres, nees;
  };
  std::vector<Error> errors;
  double nis = 0;
  int fixes = 0;
  int rejected = 0;

  /// Largest position error [m] and NEES (3 degrees of freedom) in a span of seconds.
  Error worst(double begin, double end) const {
    Error worst{begin, 0, 0};
    for (const Error& e : errors) {
      if (e.t < begin || e.t > end) continue;
      worst.metres = std::max(worst.metres, e.metres);
      worst.nees = std::max(worst.nees, e.nees);
    }
    return worst;
  }

 private:
  const simulation::SimulatedSource& truth_;
  int64_t start_ns_;
};

class EkfRun : public ::testing::Test {
 protected:
  EkfRun() {
    scenario_.duration_s = 300;
    scenario_.imu_rate_hz = 100;
    scenario_.reference_rate_hz = 0;
    scenario_.seed = 2;
  }

  ErrorSink& run() {
    source_ = std::make_unique<simulation::SimulatedSource>(scenario_, noise_);
    sink_ = std::make_unique<ErrorSink>(*source_, scenario_.start_ns());
    alignment::Aligner aligner(alignment::AlignmentOptions{}, noise_, source_->mounting());
    navigation::NavigationRun driver(
        std::make_unique<EkfNavigator>(noise_, state::Layout{}, EkfOptions{}), std::move(aligner),
        navigation::NavigationRunOptions{}, *sink_);
    while (const std::optional<Measurement> m = source_->next()) driver.process(*m);
    driver.finish();
    return *sink_;
  }

  imu::ImuNoise noise_ = imu::imu_preset("ADIS16465");
  simulation::ScenarioOptions scenario_;
  std::unique_ptr<simulation::SimulatedSource> source_;
  std::unique_ptr<ErrorSink> sink_;
};

/// 99.99 % of a chi-square of 3 degrees of freedom lie below 21; a run has hundreds of epochs.
constexpr double kNeesLimit = 25;

TEST_F(EkfRun, StaysAtCentimetresWithItsOwnAlignment) {
  const ErrorSink& result = run();
  EXPECT_LT(result.worst(kWarmUp, 300).metres, 0.08);  // sigma 2.5 cm a fix
  EXPECT_LT(result.worst(kWarmUp, 300).nees, kNeesLimit);
  EXPECT_NEAR(result.nis / result.fixes, 3, 3.29 * std::sqrt(2 * 3.0 / result.fixes));
  EXPECT_EQ(result.rejected, 0);
}

TEST_F(EkfRun, TakesFixesAtFiveHertzBesideTheSecond) {
  scenario_.gnss_rate_hz = 5;
  scenario_.gnss_phase_s = 0.3;
  const ErrorSink& result = run();
  EXPECT_LT(result.worst(kWarmUp, 300).metres, 0.06);
  EXPECT_NEAR(result.nis / result.fixes, 3, 3.29 * std::sqrt(2 * 3.0 / result.fixes));
}

TEST_F(EkfRun, CoversItsErrorOverAnImuGap) {
  scenario_.imu_gap_start_s = {200.4};
  scenario_.imu_gap_length_s = 3;
  const ErrorSink& result = run();
  EXPECT_LT(result.worst(263.4, 300).metres, 0.3);
  EXPECT_LT(result.worst(200, 300).nees, kNeesLimit);
  EXPECT_EQ(result.rejected, 0);
}

TEST_F(EkfRun, FollowsSigmasThatGrowTenfold) {
  scenario_.gnss_degraded_start_s = 180;
  scenario_.gnss_degraded_length_s = 60;
  scenario_.gnss_degraded_factor = 10;
  const ErrorSink& result = run();
  EXPECT_LT(result.worst(kWarmUp, 300).nees, kNeesLimit);
  EXPECT_LT(result.worst(260, 300).metres, 0.08);
}

}  // namespace
}  // namespace foucault::ekf
