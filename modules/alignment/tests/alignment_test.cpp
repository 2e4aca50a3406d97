#include "foucault/alignment/alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "test_drive.h"

namespace foucault::alignment {
namespace {

using namespace state::block;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::Drive;
using testing::DriveSimulator;
using testing::rest_and_drive;
using testing::Sensors;
using testing::Truth;

imu::ImuNoise noise_of(const Sensors& sensors, double gyro_turn_on, double accel_turn_on) {
  imu::ImuNoise noise;
  noise.gyro_noise_density = sensors.gyro_density;
  noise.accel_noise_density = sensors.accel_density;
  noise.gyro_turn_on_sigma = gyro_turn_on;
  noise.accel_turn_on_sigma = accel_turn_on;
  noise.gyro_bias_sigma = 1e-7;
  noise.accel_bias_sigma = 1e-5;
  return noise;
}

struct Outcome {
  std::optional<state::Epoch> initial;
  int64_t known_at_ns = 0;
  std::string why_not;
};

Outcome align(const DriveSimulator& simulator, const Sensors& sensors, const imu::ImuNoise& noise,
              const AlignmentOptions& options = {}, const state::Layout& layout = {},
              const Vector3d& accel_scale = Vector3d::Zero()) {
  Aligner aligner(options, noise, state::Mounting{sensors.q_v_b}, layout);
  for (const Measurement& m : simulator.stream()) {
    if (const auto* fix = std::get_if<GnssFix>(&m)) aligner.add(*fix);
    if (const auto* increment = std::get_if<ImuIncrement>(&m)) {
      ImuIncrement scaled = *increment;
      scaled.dvel_b.array() *= 1 + accel_scale.array();
      aligner.add(scaled);
    }
    if (aligner.initial()) return {aligner.initial(), stamp(m), ""};
  }
  aligner.finish();
  return {aligner.initial(), stamp(simulator.stream().back()), aligner.why_not()};
}

/// Truth minus estimate by the blocks of a node.
state::NodeVector error_of(const state::Epoch& epoch, const Truth& truth,
                           const state::ImuBias& bias) {
  state::NodeVector error;
  error << geodesy::LocalFrame(epoch.position).to_local(truth.position),
      truth.velocity_n - epoch.velocity_n, so3::log(epoch.q_n_b.conjugate() * truth.q_n_b),
      bias.gyro - epoch.bias.gyro, bias.accel - epoch.bias.accel;
  return error;
}

double heading_error(const state::Epoch& epoch, const Truth& truth, const Quaterniond& q_v_b) {
  return so3::wrap(so3::to_euler(epoch.q_n_b * q_v_b.conjugate()).heading -
                   so3::to_euler(truth.q_n_b * q_v_b.conjugate()).heading);
}

double heading_sigma(const state::Epoch& epoch) {
  const Vector3d down_b = epoch.q_n_b.conjugate() * Vector3d::UnitZ();
  return std::sqrt(down_b.dot(epoch.covariance_of(state::block::attitude) * down_b));
}

TEST(AlignmentAtRest, WithPerfectSensorsLandsOnTheTruthAtTheFirstFix) {
  Sensors sensors;
  sensors.gnss_noise = false;
  const DriveSimulator simulator(rest_and_drive(20, 1.1), sensors);
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 1e-2));
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  const state::Epoch& epoch = *outcome.initial;
  EXPECT_EQ(epoch.t_ns, DriveSimulator::kStart);
  const state::NodeVector error = error_of(epoch, simulator.truth(epoch.t_ns), {});
  EXPECT_LT(state::part(error, position).norm(), 1e-4);
  EXPECT_LT(state::part(error, velocity).norm(), 1e-12);
  // Carrying the attitude the Earth's horizontal rate counts as bias: 1e-5 rad in 20 s.
  EXPECT_LT(state::part(error, state::block::attitude).norm(), 1e-4);
  EXPECT_LT(state::part(error, gyro_bias).norm(), 1e-8);
  EXPECT_LT(state::part(error, accel_bias).norm(), 1e-5);
}

TEST(AlignmentAtRest, WorksForAnyMounting) {
  for (const Vector3d& rpy : {Vector3d(180, 0, 180), Vector3d(180, 6.79, 185.35),
                              Vector3d(0, 0, 90), Vector3d(90, 0, 0), Vector3d(0, -80, 30)}) {
    Sensors sensors;
    sensors.gnss_noise = false;
    sensors.q_v_b = so3::from_euler({rpy.x() * kDegree, rpy.y() * kDegree, rpy.z() * kDegree});
    const DriveSimulator simulator(rest_and_drive(10, -2.0), sensors);
    const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 1e-2));
    ASSERT_TRUE(outcome.initial) << rpy.transpose() << outcome.why_not;
    const state::NodeVector error =
        error_of(*outcome.initial, simulator.truth(outcome.initial->t_ns), {});
    EXPECT_LT(state::part(error, state::block::attitude).norm(), 1e-4) << rpy.transpose();
    EXPECT_LT(state::part(error, position).norm(), 1e-3) << rpy.transpose();
  }
}

/// Mean squares of normalized errors over seeded runs.
struct Consistency {
  Vector3d attitude_n = Vector3d::Zero();  ///< about north, east, down
  Vector3d gyro_bias = Vector3d::Zero();
  double velocity = 0;
  double worst = 0;  ///< largest normalized error of any kind
  int runs = 0;
};

double square(double x) { return x * x; }

void add_run(Consistency& sum, const state::Epoch& epoch, const Truth& truth,
             const state::ImuBias& bias) {
  const state::NodeVector error = error_of(epoch, truth, bias);
  const Eigen::Matrix3d R = epoch.q_n_b.toRotationMatrix();
  const Vector3d attitude = R * part(error, state::block::attitude);
  const Eigen::Matrix3d attitude_P =
      R * epoch.covariance_of(state::block::attitude) * R.transpose();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = square(attitude[axis]) / attitude_P(axis, axis);
    const double g =
        square(state::part(error, gyro_bias)[axis]) / square(epoch.sigma_of(gyro_bias)[axis]);
    const double v =
        square(state::part(error, velocity)[axis]) / square(epoch.sigma_of(velocity)[axis]);
    sum.attitude_n[axis] += a;
    sum.gyro_bias[axis] += g;
    sum.velocity += v / 3;
    sum.worst = std::max({sum.worst, std::sqrt(a), std::sqrt(g), std::sqrt(v)});
  }
  ++sum.runs;
}

template <class MakeDrive>
Consistency run_seeds(int runs, const MakeDrive& make_drive, Sensors sensors,
                      const AlignmentOptions& options = {}) {
  const double gyro_turn_on = 100 * kDegree / 3600, accel_turn_on = 1.5e-3 * 9.8;
  Consistency sum;
  for (int seed = 1; seed <= runs; ++seed) {
    std::mt19937 rng(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> angle(-kPi, kPi);
    const auto draw = [&](double sigma) {
      return Vector3d(sigma * normal(rng), sigma * normal(rng), sigma * normal(rng));
    };
    sensors.seed = static_cast<unsigned>(seed);
    sensors.bias.gyro = draw(gyro_turn_on);
    sensors.bias.accel = draw(accel_turn_on);
    const DriveSimulator simulator(make_drive(angle(rng)), sensors);
    const Outcome outcome =
        align(simulator, sensors, noise_of(sensors, gyro_turn_on, accel_turn_on), options);
    EXPECT_TRUE(outcome.initial) << "seed " << seed << ": " << outcome.why_not;
    if (!outcome.initial) continue;
    add_run(sum, *outcome.initial, simulator.truth(outcome.initial->t_ns), sensors.bias);
  }
  return sum;
}

Sensors industrial_sensors() {
  Sensors sensors;
  sensors.gyro_density = 0.15 * kDegree / 60;
  sensors.accel_density = 0.012 / 60;
  return sensors;
}

TEST(AlignmentAtRest, ErrorsAreAsLargeAsTheirSigmasSay) {
  Sensors sensors = industrial_sensors();
  sensors.gnss_sigma = 0.1;  // at 12 m/s and 1 s: 0.7 deg a course, above the floors
  const Consistency sum = run_seeds(
      60, [](double heading) { return rest_and_drive(20, heading); }, sensors);
  ASSERT_EQ(sum.runs, 60);
  EXPECT_LT(sum.worst, 4);
  // Mean of 60 squares: 1 +- 0.18 (1 sigma).
  for (int axis : {0, 1}) {
    EXPECT_GT(sum.attitude_n[axis] / sum.runs, 0.5);
    EXPECT_LT(sum.attitude_n[axis] / sum.runs, 1.6);
  }
  // Heading and gyroscope bias have their variances doubled, for they rest on data used again.
  // Courses allow for crab angles besides, and take as independent what shares a fix: the errors of
  // three ways in a row telescope to a third of the variance.
  EXPECT_GT(sum.attitude_n[2] / sum.runs, 0.05);
  EXPECT_LT(sum.attitude_n[2] / sum.runs, 0.9);
  for (int axis : {0, 1, 2}) {
    EXPECT_GT(sum.gyro_bias[axis] / sum.runs, 0.2);
    EXPECT_LT(sum.gyro_bias[axis] / sum.runs, 0.9);
  }
}

TEST(AlignmentAtRest, LevelErrorAndAccelerometerBiasAreTied) {
  Sensors sensors = industrial_sensors();
  const DriveSimulator simulator(rest_and_drive(20, 0.3), sensors);
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 0.015));
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  // Levelled at rest, g x dtheta = b_a across g: the difference is known far better than either.
  const state::NodeMatrix& P = outcome.initial->covariance;
  const double g = 9.81;
  const Vector3d up_b = outcome.initial->q_n_b.conjugate() * Vector3d(0, 0, -1);
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0)}) {
    state::NodeRow H = state::NodeRow::Zero();
    state::part(H, state::block::attitude) = g * axis.cross(up_b);  // of up x dtheta
    state::part(H, accel_bias) = axis;
    const double tied = std::sqrt((H * P * H.transpose())(0, 0));
    const double bias = std::sqrt(state::part(P, accel_bias, accel_bias)(0, 0));
    EXPECT_LT(tied, 0.05 * bias);
    EXPECT_NEAR(bias, 0.015, 0.001);
  }
}

/// Gravity tells the sum of bias and scale along it, and which of them it is nobody knows.
TEST(AlignmentAtRest, ScaleFactorsAreNotTakenForBiases) {
  constexpr double kScale = 0.02, kSigma = 0.015;
  const Sensors sensors = industrial_sensors();
  const DriveSimulator simulator(rest_and_drive(20, 0.3), sensors);
  const state::Layout layout =
      state::Layout().add(state::block::gyro_scale, 1e-3).add(state::block::accel_scale, 0.02);
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, kSigma), {}, layout,
                                Vector3d::Constant(kScale));
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  const state::Epoch& epoch = *outcome.initial;
  const state::SlowBlock& scale = *layout.find(state::block::accel_scale);
  const double g = 9.81;
  state::StateVector sum = state::StateVector::Zero(layout.size());
  state::part(sum, accel_bias).z() = 1;
  state::part(sum, scale).z() = -g;
  const double error =
      sensors.bias.accel.z() - epoch.bias.accel.z() - g * (kScale - epoch.slow[scale.index + 2]);
  const double tied = std::sqrt(sum.dot(epoch.covariance * sum));
  EXPECT_LT(tied, 2e-3);
  EXPECT_LT(std::abs(error), 3.3 * tied);
  const double alone = std::sqrt(state::part(epoch.covariance.diagonal(), scale).z());
  EXPECT_LT(std::abs(kScale - epoch.slow[scale.index + 2]), 3 * alone);
  EXPECT_GT(alone, 1e-3);
  EXPECT_NEAR(std::sqrt(state::part(epoch.covariance.diagonal(), layout.slow()[0])[0]), 1e-3, 1e-9);
}

Drive drive_without_rest(double heading) {
  Drive drive = rest_and_drive(0, heading, 1.0, 15);
  const Drive from_rest = drive;
  // Cut off the first seconds: the log begins at 5 m/s and accelerates gently.
  drive.speed = [=](double t) { return from_rest.speed(t + 5); };
  drive.acceleration = [=](double t) { return from_rest.acceleration(t + 5); };
  drive.heading = [=](double t) { return from_rest.heading(t + 5); };
  drive.turn_rate = [=](double t) { return from_rest.turn_rate(t + 5); };
  drive.duration = from_rest.duration - 5;
  return drive;
}

TEST(AlignmentWhileMoving, WithPerfectSensorsLandsOnTheTruth) {
  Sensors sensors;
  sensors.gnss_noise = false;
  sensors.q_v_b = so3::from_euler({kPi, 0.1, 0.2});
  const DriveSimulator simulator(drive_without_rest(2.0), sensors);
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 1e-2));
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  const state::NodeVector error =
      error_of(*outcome.initial, simulator.truth(outcome.initial->t_ns), {});
  EXPECT_LT(state::part(error, position).norm(), 1e-3);
  EXPECT_LT(state::part(error, velocity).norm(), 0.05);
  EXPECT_LT(state::part(error, state::block::attitude).norm(), 0.1 * kDegree);
}

TEST(AlignmentWhileMoving, ErrorsStayWithinTheirSigmas) {
  const Consistency sum = run_seeds(50, drive_without_rest, industrial_sensors());
  ASSERT_EQ(sum.runs, 50);
  EXPECT_LT(sum.worst, 3.5);
  // The sigmas allow for a car's jerk, latency and crab angle, none of which is simulated: errors
  // are smaller, but not out of all proportion.
  for (int axis : {0, 1}) {
    EXPECT_GT(sum.attitude_n[axis] / sum.runs, 0.01);
    EXPECT_LT(sum.attitude_n[axis] / sum.runs, 1.3);
  }
  EXPECT_LT(sum.attitude_n[2] / sum.runs, 1.3);
  EXPECT_LT(sum.velocity / sum.runs, 1.3);
}

TEST(AlignmentWhileMoving, CoarsePositionsWithVelocityServe) {
  Sensors sensors = industrial_sensors();
  sensors.gnss_sigma = 2;
  sensors.velocity_sigma = 0.1;
  sensors.gnss_interval = 0.2;
  const Consistency sum = run_seeds(50, drive_without_rest, sensors);
  ASSERT_EQ(sum.runs, 50);
  EXPECT_LT(sum.worst, 3.5);
  EXPECT_LT(sum.attitude_n[2] / sum.runs, 1.3);
}

TEST(Alignment, ReversingOutOfAParkingPlaceIsNotForward) {
  Sensors sensors = industrial_sensors();
  sensors.gnss_interval = 0.5;
  Drive drive;
  drive.speed = [](double t) {
    if (t < 20) return 0.0;
    if (t < 40) return -std::min(t - 20, 4.0) + std::max(0.0, t - 36);
    return std::min(1.5 * (t - 40), 12.0);
  };
  drive.acceleration = [](double t) {
    if (t > 20 && t < 24) return -1.0;
    if (t > 36 && t < 40) return 1.0;
    return t > 40 && t < 48 ? 1.5 : 0.0;
  };
  drive.heading = [](double) { return 1.0; };
  drive.duration = 70;
  const DriveSimulator simulator(drive, sensors);
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 0.015));
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  const double error =
      heading_error(*outcome.initial, simulator.truth(outcome.initial->t_ns), sensors.q_v_b);
  EXPECT_LT(std::abs(error), 3 * heading_sigma(*outcome.initial));
}

TEST(Alignment, GivenAnglesStartAtTheFirstFix) {
  Sensors sensors = industrial_sensors();
  const double heading = 1.0;
  const DriveSimulator simulator(drive_without_rest(heading), sensors);
  AlignmentOptions options;
  options.mode = "given";
  options.roll_deg = 0.3;
  options.pitch_deg = -0.2;
  options.heading_deg = heading / kDegree + 0.5;
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 0.015), options);
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  const state::Epoch& epoch = *outcome.initial;
  EXPECT_EQ(epoch.t_ns, DriveSimulator::kStart);
  const so3::Euler euler = so3::to_euler(epoch.q_n_b);
  EXPECT_NEAR(euler.roll, 0.3 * kDegree, 1e-9);
  EXPECT_NEAR(euler.pitch, -0.2 * kDegree, 1e-9);
  EXPECT_NEAR(euler.heading, heading + 0.5 * kDegree, 1e-9);
  const state::NodeVector error = error_of(epoch, simulator.truth(epoch.t_ns), sensors.bias);
  for (int i = 0; i < 15; ++i) {
    EXPECT_LT(std::abs(error[i]), 3.5 * std::sqrt(epoch.covariance(i, i)) + 1e-9) << i;
  }
  EXPECT_NEAR(heading_sigma(epoch), options.heading_sigma_deg * kDegree, 1e-3 * kDegree);
}

TEST(Alignment, GivenModeNamesMissingAngles) {
  AlignmentOptions options;
  options.mode = "given";
  options.heading_deg = 10;
  try {
    Aligner(options, imu::imu_preset("ADIS16465"), state::Mounting{});
    FAIL() << "accepted";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("roll_deg, pitch_deg"), std::string::npos);
  }
}

TEST(Alignment, HeadingAloneCompletesARest) {
  Sensors sensors = industrial_sensors();
  Drive standing;
  standing.duration = 30;
  const DriveSimulator simulator(standing, sensors);
  AlignmentOptions options;
  options.heading_deg = 0.7 / kDegree;
  options.heading_sigma_deg = 2;
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 0.015), options);
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  const state::NodeVector error =
      error_of(*outcome.initial, simulator.truth(outcome.initial->t_ns), sensors.bias);
  EXPECT_LT(state::part(error, state::block::attitude).norm(), 0.02 * kDegree);
  EXPECT_NEAR(heading_sigma(*outcome.initial), 2 * kDegree, 1e-3 * kDegree);
}

TEST(Alignment, OptionsRoundTrip) {
  AlignmentOptions options;
  load_config_text(
      "{mode: given, roll_deg: 1, pitch_deg: -2, heading_deg: 300, roll_sigma_deg: 0.1,"
      " pitch_sigma_deg: 0.2, heading_sigma_deg: 0.3, min_rest_s: 8, max_rest_s: 90}",
      "test", options);
  AlignmentOptions again;
  load_config_text(dump_config(options), "again", again);
  EXPECT_EQ(again.mode, "given");
  EXPECT_EQ(again.roll_deg, 1);
  EXPECT_EQ(again.pitch_deg, -2);
  EXPECT_EQ(again.heading_deg, 300);
  EXPECT_EQ(again.roll_sigma_deg, 0.1);
  EXPECT_EQ(again.pitch_sigma_deg, 0.2);
  EXPECT_EQ(again.heading_sigma_deg, 0.3);
  EXPECT_EQ(again.min_rest_s, 8);
  EXPECT_EQ(again.max_rest_s, 90);
  EXPECT_THROW(set_config("pitch_deg=91", options), UsageError);
  EXPECT_THROW(set_config("mode=manual", options), UsageError);
  EXPECT_THROW(set_config("min_speed_m_s=4", options), UsageError);
}

/// On its right side until `until_s`, as in a slow roll, straight ahead at 20 m/s.
std::vector<Measurement> on_its_side(double until_s, double duration_s) {
  Drive drive;
  drive.speed = [](double) { return 20.0; };
  drive.duration = duration_s;
  const DriveSimulator simulator(drive, Sensors());
  const Quaterniond q_rolled_level(Eigen::AngleAxisd(-90 * kDegree, Vector3d::UnitX()));
  std::vector<Measurement> stream = simulator.stream();
  for (Measurement& m : stream) {
    auto* increment = std::get_if<ImuIncrement>(&m);
    if (!increment || seconds_between(DriveSimulator::kStart, increment->t_end_ns) > until_s) {
      continue;
    }
    increment->dtheta_b = q_rolled_level * increment->dtheta_b;
    increment->dvel_b = q_rolled_level * increment->dvel_b;
  }
  return stream;
}

TEST(AlignmentWhileMoving, ARollIsNoProofOfWrongAxes) {
  const Sensors sensors;
  Aligner aligner(AlignmentOptions(), noise_of(sensors, 1e-4, 1e-2), state::Mounting{});
  for (const Measurement& m : on_its_side(12, 40)) {
    if (const auto* fix = std::get_if<GnssFix>(&m)) aligner.add(*fix);
    if (const auto* increment = std::get_if<ImuIncrement>(&m)) aligner.add(*increment);
  }
  EXPECT_EQ(aligner.why_not().find("gravity points the wrong way"), std::string::npos);
}

TEST(AlignmentWhileMoving, AxesThatStayWrongAreRefused) {
  const Sensors sensors;
  const auto feed = [&](double duration_s) {
    Aligner aligner(AlignmentOptions(), noise_of(sensors, 1e-4, 1e-2), state::Mounting{});
    for (const Measurement& m : on_its_side(1e9, duration_s)) {
      if (const auto* fix = std::get_if<GnssFix>(&m)) aligner.add(*fix);
      if (const auto* increment = std::get_if<ImuIncrement>(&m)) aligner.add(*increment);
    }
    EXPECT_FALSE(aligner.initial().has_value());
    return aligner.why_not();
  };
  EXPECT_NE(feed(20).find("gravity points the wrong way"), std::string::npos);
  EXPECT_THROW(feed(60), DataError);
}

/// Phones have gyroscopes that are off by degrees a second.
TEST(Alignment, ABiasBeyondItsPriorIsFound) {
  Sensors sensors = industrial_sensors();
  sensors.bias.gyro = Vector3d(-0.01, 0.035, 0.068);
  const DriveSimulator simulator(drive_without_rest(0.8), sensors);
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-3, 0.015));
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  const state::NodeVector error =
      error_of(*outcome.initial, simulator.truth(outcome.initial->t_ns), sensors.bias);
  EXPECT_LT(state::part(error, gyro_bias).norm(), 5e-3);
  const double heading =
      heading_error(*outcome.initial, simulator.truth(outcome.initial->t_ns), sensors.q_v_b);
  EXPECT_LT(std::abs(heading), 3 * heading_sigma(*outcome.initial));
}

/// All filters begin from it.
TEST(Alignment, AWrongFirstFixIsLeftOut) {
  for (const auto& [rest_s, away] : {std::pair(0.0, 100.0), {20.0, 100.0}, {0.0, 6e4}}) {
    Sensors sensors = industrial_sensors();
    sensors.spoil = [east = away](double t, GnssFix& fix) {
      if (t < 0.5) fix.antenna = geodesy::LocalFrame(fix.antenna).to_geodetic({0, east, 0});
    };
    const Drive drive = rest_s > 0 ? rest_and_drive(rest_s, 0.4) : drive_without_rest(0.4);
    const DriveSimulator simulator(drive, sensors);
    const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 0.015));
    ASSERT_TRUE(outcome.initial) << outcome.why_not;
    const Truth truth = simulator.truth(outcome.initial->t_ns);
    const double error = heading_error(*outcome.initial, truth, sensors.q_v_b);
    EXPECT_LT(std::abs(error), 3 * heading_sigma(*outcome.initial)) << rest_s;
    EXPECT_LT(heading_sigma(*outcome.initial), 5 * kDegree) << rest_s;
    EXPECT_LT(geodesy::LocalFrame(truth.position).to_local(outcome.initial->position).norm(), 1);
  }
}

/// Nothing tells the heading but that most vehicles go along their nose.
TEST(AlignmentWhileMoving, StraightAndSteadyMotionIsTakenForTheCourse) {
  Sensors sensors = industrial_sensors();
  Drive straight;
  straight.speed = [](double) { return 20.0; };
  straight.heading = [](double) { return -2.0; };
  straight.duration = 40;
  const DriveSimulator simulator(straight, sensors);
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 0.015));
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  const double error =
      heading_error(*outcome.initial, simulator.truth(outcome.initial->t_ns), sensors.q_v_b);
  EXPECT_LT(std::abs(error), 1 * kDegree);
  EXPECT_NEAR(heading_sigma(*outcome.initial), 10 * kDegree, 1 * kDegree);
}

/// A boat with leeway, or a vehicle that crabs: its nose is 25 deg off its course.
TEST(AlignmentWhileMoving, TheCourseIsNoHeadingWhereAccelerationsTellIt) {
  Sensors sensors = industrial_sensors();
  const Drive ahead = rest_and_drive(0, 0.4, 1.0, 8);
  const Quaterniond q_crab = so3::from_euler({0, 0, -25 * kDegree});  // the vehicle on its course
  sensors.q_v_b = q_crab;
  const DriveSimulator simulator(ahead, sensors);
  Sensors as_told = sensors;
  as_told.q_v_b = Quaterniond::Identity();
  const Outcome outcome = align(simulator, as_told, noise_of(sensors, 1e-4, 0.015));
  ASSERT_TRUE(outcome.initial) << outcome.why_not;
  const Truth truth = simulator.truth(outcome.initial->t_ns);
  const double error = heading_error(*outcome.initial, truth, as_told.q_v_b);
  EXPECT_LT(std::abs(error), 3 * heading_sigma(*outcome.initial));
  EXPECT_LT(heading_sigma(*outcome.initial), 5 * kDegree);
}

TEST(Alignment, SaysWhyThereIsNone) {
  Sensors sensors = industrial_sensors();
  Drive standing;
  standing.duration = 20;
  const DriveSimulator simulator(standing, sensors);
  const Outcome outcome = align(simulator, sensors, noise_of(sensors, 1e-4, 0.015));
  EXPECT_FALSE(outcome.initial);
  EXPECT_NE(outcome.why_not.find("rested all the time"), std::string::npos) << outcome.why_not;
  EXPECT_NE(outcome.why_not.find("alignment.heading_deg"), std::string::npos) << outcome.why_not;
}

/// What was done already is not advised again, and what is advised suffices.
TEST(Alignment, SaysWhatAShortRestNeeds) {
  Sensors sensors = industrial_sensors();
  Drive standing;
  standing.duration = 6;
  const DriveSimulator simulator(standing, sensors);
  const imu::ImuNoise noise = noise_of(sensors, 1e-4, 0.015);
  AlignmentOptions options;
  options.heading_deg = 10;
  const std::string given = align(simulator, sensors, noise, options).why_not;
  EXPECT_NE(given.find("rested for all of 6.0 s"), std::string::npos) << given;
  EXPECT_NE(given.find("record 10 s"), std::string::npos) << given;
  standing.duration = 20;
  const DriveSimulator longer(standing, sensors);
  EXPECT_TRUE(align(longer, sensors, noise, options).initial);
}

TEST(Alignment, VibrationAtRestDoesNotHideIt) {
  Sensors sensors = industrial_sensors();
  // As a running engine: 2.3 deg/s and 0.14 m/s^2 a sample at 100 Hz, white.
  sensors.gyro_density = 2.3 * kDegree * 0.1;
  sensors.accel_density = 0.14 * 0.1;
  const Consistency sum = run_seeds(
      20, [](double heading) { return rest_and_drive(30, heading); }, sensors);
  ASSERT_EQ(sum.runs, 20);
  EXPECT_LT(sum.worst, 4);
}

TEST(Alignment, MemoryIsBoundedByTheOldestStart) {
  Sensors sensors = industrial_sensors();
  Drive standing;
  standing.duration = 400;
  const DriveSimulator simulator(standing, sensors);
  AlignmentOptions options;
  options.max_rest_s = 60;
  Aligner aligner(options, noise_of(sensors, 1e-4, 0.015), state::Mounting{});
  for (const Measurement& m : simulator.stream()) {
    if (const auto* fix = std::get_if<GnssFix>(&m)) aligner.add(*fix);
    if (const auto* increment = std::get_if<ImuIncrement>(&m)) aligner.add(*increment);
    if (stamp(m) - DriveSimulator::kStart > kNanosecondsPerSecond) {
      EXPECT_LE(seconds_between(aligner.earliest_start_ns(), stamp(m)), 62);
    }
  }
}

}  // namespace
}  // namespace foucault::alignment
