#include "../src/heading_bank.h"

#include <gtest/gtest.h>

#include "../src/refinement.h"
#include "../src/starts.h"
#include "../src/track.h"
#include "foucault/core/constants.h"
#include "foucault/state/vehicle_attitude.h"
#include "test_drive.h"

/// The parts of the way from fixes and forces to a start, on drives whose truth is known.
namespace foucault::alignment {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::Drive;
using testing::DriveSimulator;
using testing::Sensors;

imu::ImuNoise noise_of_drive() {
  imu::ImuNoise noise;
  noise.gyro_noise_density = 0.15 * kDegree / 60;
  noise.accel_noise_density = 0.012 / 60;
  noise.gyro_turn_on_sigma = 1e-4;
  noise.accel_turn_on_sigma = 0.015;
  noise.gyro_bias_sigma = 1e-7;
  noise.accel_bias_sigma = 1e-5;
  return noise;
}

Sensors sensors_of_drive(unsigned seed) {
  Sensors sensors;
  sensors.gyro_density = noise_of_drive().gyro_noise_density;
  sensors.accel_density = noise_of_drive().accel_noise_density;
  sensors.bias.gyro = Vector3d(1e-4, -5e-5, 1e-4);
  sensors.bias.accel = Vector3d(0.01, -0.015, 0.01);
  sensors.seed = seed;
  return sensors;
}

Track track_of(const DriveSimulator& simulator) {
  Track track(300);
  for (const Measurement& m : simulator.stream()) {
    if (const auto* fix = std::get_if<GnssFix>(&m)) track.add(*fix);
    if (const auto* increment = std::get_if<ImuIncrement>(&m)) track.add(*increment);
  }
  return track;
}

/// From speed, straight at first, then a turn.
Drive moving() {
  Drive drive;
  drive.speed = [](double t) { return 8 + std::clamp(t - 10, 0.0, 5.0); };
  drive.acceleration = [](double t) { return t > 10 && t < 15 ? 1.0 : 0.0; };
  drive.heading = [](double t) { return 0.7 + 0.2 * std::clamp(t - 20, 0.0, 8.0); };
  drive.turn_rate = [](double t) { return t > 20 && t < 28 ? 0.2 : 0.0; };
  drive.duration = 40;
  return drive;
}

double heading_of(const state::Epoch& epoch) {
  return state::vehicle_attitude(epoch, state::Mounting{}).euler.heading;
}

HeadingBank bank_over(const Track& track, const imu::ImuNoise& noise) {
  HeadingBank bank(noise, {}, state::Mounting{});
  AlignmentFindings findings =
      findings_in_motion(track.first_fixes(4), track.steps(), noise, Quaterniond::Identity());
  findings.heading_variance = std::pow(15 * kDegree, 2);
  for (int i = 0; i < 12; ++i) {
    findings.heading = i * 30 * kDegree;
    bank.add(initial_state(findings, noise), 0);
  }
  for (const Step& step : track.steps()) {
    if (const auto* increment = std::get_if<ImuIncrement>(&step)) {
      if (increment->t_begin_ns >= findings.fix.t_ns) bank.propagate(*increment);
    } else if (std::get<GnssFix>(step).t_ns > findings.fix.t_ns) {
      bank.update(std::get<GnssFix>(step));
    }
  }
  return bank;
}

TEST(HeadingBank, FindsTheHeadingFromAccelerations) {
  const DriveSimulator simulator(moving(), sensors_of_drive(3));
  const HeadingBelief belief = bank_over(track_of(simulator), noise_of_drive()).belief();
  const double truth = so3::to_euler(simulator.truth(belief.best.t_ns).q_n_b).heading;
  EXPECT_LT(belief.sigma, 1 * kDegree);
  EXPECT_LT(std::abs(so3::wrap(belief.heading - truth)), 4 * belief.sigma);
}

TEST(HeadingBank, ClaimsNothingWhereNothingTellsIt) {
  Drive straight;
  straight.speed = [](double) { return 10.0; };
  straight.duration = 40;
  const DriveSimulator simulator(straight, sensors_of_drive(3));
  const HeadingBank bank = bank_over(track_of(simulator), noise_of_drive());
  EXPECT_GT(bank.belief().sigma, 25 * kDegree);
  EXPECT_GE(bank.candidates().size(), 6u);
}

TEST(Trial, LeavesOutOneFixButNotTwo) {
  const Sensors sensors = sensors_of_drive(5);
  Sensors spoilt = sensors;
  const auto with_outliers = [&](double from, double to) {
    spoilt.spoil = [=](double t, GnssFix& fix) {
      if (t > from && t < to) fix.antenna = geodesy::LocalFrame(fix.antenna).to_geodetic({5, 0, 0});
    };
    const DriveSimulator simulator(moving(), spoilt);
    const Track track = track_of(simulator);
    const std::vector<GnssFix> fixes = track.first_fixes(4);
    AlignmentFindings findings =
        findings_in_motion(fixes, track.steps(), noise_of_drive(), Quaterniond::Identity());
    findings.heading = 0.7;
    findings.heading_variance = 1e-4;
    Trial trial(noise_of_drive(), {}, initial_state(findings, noise_of_drive()));
    for (const Step& step : track.steps()) {
      if (const auto* inc = std::get_if<ImuIncrement>(&step)) {
        if (inc->t_begin_ns >= fixes[0].t_ns) trial.propagate(*inc);
      } else if (std::get<GnssFix>(step).t_ns > fixes[0].t_ns) {
        trial.update(std::get<GnssFix>(step));
      }
      const double t = seconds_between(DriveSimulator::kStart,
                                       std::visit([](auto& s) { return stamp(s); }, step));
      if (t > to) break;
    }
    const state::Epoch epoch = trial.epoch();
    EXPECT_LT(trial.level(), 3);
    return geodesy::LocalFrame(simulator.truth(epoch.t_ns).position)
        .to_local(epoch.position)
        .norm();
  };
  EXPECT_LT(with_outliers(17.5, 18.5), 0.1);
  EXPECT_GT(with_outliers(16.5, 18.5), 1);
}

/// The state at an earlier fix, its errors as large as its covariance says.
TEST(CarriedBack, LandsOnTheEarlierAttitude) {
  double squares = 0;
  constexpr int kRuns = 20;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Sensors sensors = sensors_of_drive(seed);
    const DriveSimulator simulator(moving(), sensors);
    const Track track = track_of(simulator);
    state::Epoch found;
    found.t_ns = DriveSimulator::kStart + 30 * kNanosecondsPerSecond;
    const testing::Truth then = simulator.truth(found.t_ns);
    found.position = then.position;
    found.q_n_b = then.q_n_b;
    found.bias = sensors.bias;
    const CarriedBack back =
        carried_back(found, track.steps(), track.first_fixes(1).front().t_ns, noise_of_drive());
    const testing::Truth first = simulator.truth(track.first_fixes(1).front().t_ns);
    const Vector3d error = so3::log(back.q_n_b.conjugate() * first.q_n_b);
    squares += error.dot(back.covariance.topLeftCorner<3, 3>().inverse() * error) / (3 * kRuns);
  }
  EXPECT_GT(squares, 0.5);  // 60 squares: 1 +- 0.18
  EXPECT_LT(squares, 1.6);
}

TEST(CarriedBack, PriorsOfBiasesOutlastTheReuse) {
  CarriedBack back;
  const imu::ImuNoise noise = noise_of_drive();
  back.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-8, 1e-8, 1e-8, 1e-8, 1e-8, 1e-8;
  back.reuse(9, noise);
  EXPECT_NEAR(back.covariance(0, 0), 9e-4, 1e-9);
  // Of the gyroscopes nothing but the prior was known, of the accelerometers much more.
  EXPECT_NEAR(back.covariance(3, 3), 1e-8, 1e-10);
  EXPECT_NEAR(back.covariance(6, 6), 9e-8, 1e-9);
}

/// Velocity at the first fix, with the attitude known: fixes 5 s apart, while the vehicle speeds
/// up.
TEST(StateInMotion, HasTheVelocityOfTheFirstFix) {
  Sensors sensors = sensors_of_drive(2);
  sensors.gnss_interval = 5;
  Drive drive = moving();
  drive.speed = [](double t) { return 2 + t; };
  drive.acceleration = [](double) { return 1.0; };
  const DriveSimulator simulator(drive, sensors);
  const Track track = track_of(simulator);
  const std::vector<GnssFix> fixes = track.first_fixes(10);
  const testing::Truth truth = simulator.truth(fixes.front().t_ns);
  CarriedBack found;
  found.q_n_b = truth.q_n_b;
  found.bias = sensors.bias;
  found.covariance.diagonal().setConstant(1e-8);
  const state::Epoch epoch = state_in_motion(fixes, track.steps(), found);
  const Vector3d error = epoch.velocity_n - truth.velocity_n;
  EXPECT_LT(error.norm(), 0.02);
  EXPECT_LT(error.norm(), 4 * epoch.sigma_of(state::block::velocity).norm());
  EXPECT_LT(geodesy::LocalFrame(truth.position).to_local(epoch.position).norm(), 0.06);
}

/// From 35 deg off, where a single pass of the filter comes out further off than it says.
TEST(Refinement, IsNotMisledByItsFirstLinearization) {
  const imu::ImuNoise noise = noise_of_drive();
  double first_squares = 0, squares = 0;
  constexpr int kRuns = 30;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    Sensors sensors = sensors_of_drive(seed);
    std::mt19937 rng(seed);
    std::normal_distribution<double> normal;
    for (int axis = 0; axis < 3; ++axis) {
      sensors.bias.gyro[axis] = noise.gyro_turn_on_sigma * normal(rng);
      sensors.bias.accel[axis] = noise.accel_turn_on_sigma * normal(rng);
    }
    const DriveSimulator simulator(moving(), sensors);
    const Track track = track_of(simulator);
    AlignmentFindings findings =
        findings_in_motion(track.first_fixes(4), track.steps(), noise, Quaterniond::Identity());
    findings.heading = 0.7 + 35 * kDegree;
    findings.heading_variance = std::pow(15 * kDegree, 2);
    const MakeStart start = [&](const state::Epoch& found, double level) {
      CarriedBack back = carried_back(found, track.steps(), findings.fix.t_ns, noise);
      back.reuse(9 * level, noise);
      return state_in_motion(track.first_fixes(10), track.steps(), back);
    };
    const auto square = [&](const state::Epoch& epoch) {
      const double truth = so3::to_euler(simulator.truth(epoch.t_ns).q_n_b).heading;
      const double sigma = state::vehicle_attitude(epoch, state::Mounting{}).sigma.z();
      return std::pow(so3::wrap(heading_of(epoch) - truth) / sigma, 2);
    };
    const state::Epoch first =
        drive_over(initial_state(findings, noise), track.steps(), noise, {}).end;
    first_squares += square(first) / kRuns;
    const std::optional<Refined> refined = refine(first, 1, track.steps(), noise, {}, start);
    ASSERT_TRUE(refined);
    squares += square(refined->end) / kRuns;
  }
  EXPECT_LT(squares, 1.6);  // thirty squares: 1 +- 0.26
  EXPECT_GT(squares, 0.4);
  EXPECT_GT(first_squares, 1.5 * squares);
}

}  // namespace
}  // namespace foucault::alignment
