/// The heading of two antennas in a simulated city: what it adds, what it may not do, and what is
/// found of its baseline.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/methods/methods.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kTrip = 400;                        // [s]
constexpr double kOutages[] = {160, 220, 280, 340};  // [s] after the start
constexpr double kOutage = 30;

simulation::ScenarioOptions with_heading(int64_t seed) {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = kTrip;
  scenario.seed = seed;
  scenario.heading_sigma_deg = 0.3;
  scenario.heading_baseline_error_deg = 4;
  return scenario;
}

/// `auto`, with nothing beside it; the direction of the baseline is known to `sigma_deg`.
methods::MethodOptions told(double sigma_deg = 5) {
  methods::MethodOptions options;
  options.run.imu = imu::imu_preset("ADIS16465");
  options.run.aids.heading = "auto";
  options.run.layout.add(state::block::baseline_heading, sigma_deg * kDegree);
  return options;
}

methods::MethodOptions untold() {
  methods::MethodOptions options = told();
  options.run.aids.heading = "off";
  options.run.layout = {};
  return options;
}

class Journal : public state::Sink {
 public:
  void epoch(const state::Epoch& epoch) override { epochs[epoch.t_ns] = epoch; }
  void observation(const state::ObservationResult& result) override {
    if (result.name != "heading") return;
    (result.used ? used : rejected) += 1;
    if (result.used) squares += result.normalized_square;
  }
  void notice(const state::Notice& notice) override { notices.push_back(notice.text); }

  std::map<int64_t, state::Epoch> epochs;
  int used = 0, rejected = 0;
  double squares = 0;
  std::vector<std::string> notices;
};

bool in_outage(double t) {
  for (const double begin : kOutages) {
    if (t > begin && t <= begin + kOutage) return true;
  }
  return false;
}

/// A drive with outages, or without.
struct Drive {
  Journal journal;
  state::Layout layout;
  std::vector<double> drifts;  ///< largest horizontal error of each outage [m]
  std::map<int64_t, state::Epoch> truth;

  double rms_drift() const { return evaluation::root_mean_square(drifts); }
  const state::Epoch& last() const { return journal.epochs.rbegin()->second; }
};

Drive drive(const std::string& method, const simulation::ScenarioOptions& scenario,
            methods::MethodOptions options, bool outages = true) {
  Drive run;
  run.layout = options.run.layout;
  simulation::SimulatedSource source(scenario, options.run.imu);
  options.run.mounting = source.mounting();
  const auto estimator = methods::find(method).make(options, run.journal);
  while (std::optional<Measurement> measurement = source.next()) {
    const double t = seconds_between(scenario.start_ns(), stamp(*measurement));
    if (outages && std::holds_alternative<GnssFix>(*measurement) && in_outage(t))
      measurement = EpochRequest{stamp(*measurement)};
    estimator->process(*measurement);
  }
  estimator->finish();
  if (!outages) {
    run.truth[run.last().t_ns] = source.truth(run.last().t_ns);
    return run;
  }
  for (const double begin : kOutages) {
    double most = 0;
    for (const auto& [t_ns, epoch] : run.journal.epochs) {
      const double since = seconds_between(scenario.start_ns(), t_ns) - begin;
      if (since < 0 || since > kOutage) continue;
      const Eigen::Vector3d error =
          geodesy::ned_offset(epoch.position, source.truth(t_ns).position);
      most = std::max(most, error.head<2>().norm());
    }
    run.drifts.push_back(most);
  }
  run.truth[run.last().t_ns] = source.truth(run.last().t_ns);
  return run;
}

/// Of the baseline's block, and of the attitude about the vertical [rad].
struct Estimated {
  double baseline = 0, baseline_sigma = 0;
};

Estimated estimated(const Drive& run) {
  const state::SlowBlock& block = *run.layout.find(state::block::baseline_heading);
  const state::Epoch& last = run.last();
  return {last.slow[block.index], std::sqrt(state::part(last.covariance, block, block)(0, 0))};
}

class HeadingOf : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, HeadingOf, ::testing::Values("ekf", "rts", "full", "batch"));

/// Fixes of a centimetre tell the heading of a car to 0.1 deg.
TEST_P(HeadingOf, BaselineIsFound) {
  const Drive run = drive(GetParam(), with_heading(5), told(), false);
  const Estimated found = estimated(run);
  EXPECT_LT(std::abs(found.baseline - 4 * kDegree), 3 * found.baseline_sigma);
  EXPECT_LT(found.baseline_sigma, 0.3 * kDegree);
  EXPECT_GT(run.journal.used, 250);
  EXPECT_EQ(run.journal.rejected, 0);
  EXPECT_NEAR(run.journal.squares / run.journal.used, 1, 0.25);  // 5 sigmas of so many
}

/// One log, the same fixes: the smoother's last epoch and the filter's agree within what they say.
TEST(Heading, FilterAndBatchAgree) {
  const Drive ekf = drive("ekf", with_heading(6), told(), false);
  const Drive batch = drive("batch", with_heading(6), told(), false);
  const Estimated a = estimated(ekf), b = estimated(batch);
  EXPECT_LT(std::abs(a.baseline - b.baseline), a.baseline_sigma);
  EXPECT_NEAR(b.baseline_sigma, a.baseline_sigma, 0.2 * a.baseline_sigma);
  const Eigen::Vector3d turn = so3::log(ekf.last().q_n_b.conjugate() * batch.last().q_n_b);
  EXPECT_LT(turn.norm(), ekf.last().sigma_of(state::block::attitude).norm());
}

/// 20 seeds: of the mean NEES of three degrees of freedom 99.9 % lie between 1.5 and 5.1.
TEST(Heading, KeepsTheNeesInItsBand) {
  constexpr int kSeeds = 20;
  double attitude = 0, baseline = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    simulation::ScenarioOptions scenario = with_heading(seed);
    scenario.duration_s = 200;
    const Drive run = drive("ekf", scenario, told(), false);
    const state::Epoch& last = run.last();
    const Eigen::Vector3d error = so3::log(last.q_n_b.conjugate() * run.truth.at(last.t_ns).q_n_b);
    attitude += error.dot(last.covariance_of(state::block::attitude).llt().solve(error)) / kSeeds;
    const Estimated found = estimated(run);
    baseline += std::pow((found.baseline - 4 * kDegree) / found.baseline_sigma, 2) / kSeeds;
  }
  EXPECT_GT(attitude, 1.5);
  EXPECT_LT(attitude, 5.1);
  EXPECT_GT(baseline, 0.3);
  EXPECT_LT(baseline, 2.4);
}

/// What is wrong with a heading, and whether it is named.
struct Wrong {
  const char* name;
  double noise_factor, baseline_deg, outlier_percent;
  bool named;
};

void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.name; }

class WrongHeading : public ::testing::TestWithParam<Wrong> {};
INSTANTIATE_TEST_SUITE_P(Ways, WrongHeading,
                         ::testing::Values(Wrong{"sigma_ten_times_too_small", 10, 0, 0, false},
                                           Wrong{"bias_of_20_deg", 1, 20, 0, true},
                                           Wrong{"swapped_antennas", 1, 180, 0, true},
                                           Wrong{"outliers", 1, 4, 20, false}),
                         [](const auto& wrong) { return std::string(wrong.param.name); });

TEST_P(WrongHeading, DoesNoHarm) {
  std::vector<double> with, without;
  for (int seed = 1; seed <= 6; ++seed) {
    simulation::ScenarioOptions scenario = with_heading(seed);
    scenario.heading_noise_factor = GetParam().noise_factor;
    scenario.heading_baseline_error_deg = GetParam().baseline_deg;
    scenario.heading_outlier_percent = GetParam().outlier_percent;
    const Drive run = drive("ekf", scenario, told());
    const auto named = Contains(HasSubstr("heading of two antennas was not used"));
    if (GetParam().named) {
      EXPECT_THAT(run.journal.notices, named) << seed;
    } else {
      EXPECT_THAT(run.journal.notices, Not(named)) << seed;
    }
    const Drive plain = drive("ekf", scenario, untold());
    with.insert(with.end(), run.drifts.begin(), run.drifts.end());
    without.insert(without.end(), plain.drifts.begin(), plain.drifts.end());
  }
  const double a = evaluation::root_mean_square(with), b = evaluation::root_mean_square(without);
  std::printf("%s: %.3f m with, %.3f m without\n", GetParam().name, a, b);
  EXPECT_LT(a, 1.05 * b);
}

/// A copter turns as it likes and accelerates little; its antennas are known to 0.3 deg.
TEST(Heading, HelpsWhereMotionTellsLittle) {
  std::vector<double> with, without;
  for (int seed = 1; seed <= 4; ++seed) {
    simulation::ScenarioOptions scenario = with_heading(seed);
    scenario.name = "copter";
    scenario.heading_baseline_error_deg = 0;
    const Drive run = drive("ekf", scenario, told(0.3));
    EXPECT_GT(run.journal.used, 100);
    const Drive plain = drive("ekf", scenario, untold());
    with.insert(with.end(), run.drifts.begin(), run.drifts.end());
    without.insert(without.end(), plain.drifts.begin(), plain.drifts.end());
  }
  const double a = evaluation::root_mean_square(with), b = evaluation::root_mean_square(without);
  std::printf("copter: %.3f m with, %.3f m without\n", a, b);
  EXPECT_LT(a, b);
}

simulation::ScenarioOptions standing() {
  simulation::ScenarioOptions scenario = with_heading(3);
  scenario.name = "static";
  scenario.duration_s = 60;
  scenario.heading_deg = 200;
  scenario.heading_baseline_error_deg = 3;
  return scenario;
}

/// Rest tells the level, the antennas the heading: as well as their baseline is known.
TEST(Heading, AlignsWithoutMotion) {
  const Drive run = drive("ekf", standing(), told(), false);
  EXPECT_THAT(run.journal.notices, Contains(HasSubstr("by the heading of two antennas")));
  const state::Epoch& last = run.last();
  const state::Epoch& truth = run.truth.at(last.t_ns);
  const double heading = so3::to_euler(last.q_n_b).heading;
  const double off = so3::wrap(heading - so3::to_euler(truth.q_n_b).heading);
  const double sigma = last.sigma_of(state::block::attitude).z();
  EXPECT_LT(std::abs(off), 3 * sigma);
  EXPECT_NEAR(sigma, 5 * kDegree, 0.3 * kDegree);  // that of the baseline: nothing else tells it
  const Estimated found = estimated(run);
  EXPECT_NEAR(found.baseline_sigma, 5 * kDegree, 0.3 * kDegree);
  EXPECT_NEAR(off + found.baseline, 3 * kDegree, 0.2 * kDegree);  // what was measured, 30 times
}

TEST(Heading, WithoutItAStandingVehicleIsNotAligned) {
  EXPECT_THROW(drive("ekf", standing(), untold(), false), DataError);
}

/// A block that nothing tells of has no part in the rest: to rounding of a filter, 1e-9 of a drift.
TEST(Heading, AutoCostsNothingWithoutOne) {
  simulation::ScenarioOptions scenario = with_heading(2);
  scenario.heading_sigma_deg = 0;
  const Drive a = drive("ekf", scenario, told()), b = drive("ekf", scenario, untold());
  ASSERT_EQ(a.drifts.size(), b.drifts.size());
  for (std::size_t i = 0; i < a.drifts.size(); ++i)
    EXPECT_NEAR(a.drifts[i], b.drifts[i], 1e-9 * b.drifts[i]);
}

}  // namespace
}  // namespace foucault
