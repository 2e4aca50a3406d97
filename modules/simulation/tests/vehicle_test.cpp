#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/simulation/scenario.h"

/// What each vehicle is drawn for: its speeds, where it goes relative to its nose, how it leans.
namespace foucault::simulation {
namespace {

constexpr double kStep = 0.05;  ///< [s]

/// A motion as the tests look at it.
struct Look {
  double t;
  double speed;     ///< horizontal [m/s]
  double height;    ///< above the start [m]
  double crab;      ///< course less heading, in (-pi, pi]
  double turn;      ///< heading less that of the start, in (-pi, pi]
  double yaw_rate;  ///< [rad/s]
  so3::Euler euler;
  Eigen::Vector3d f_v;
  Eigen::Vector3d f_level;  ///< forward, right of the heading, down
};

Look look_at(const Trajectory& trip, double t, const ScenarioOptions& options) {
  const Motion motion = trip.at(t);
  Look look;
  look.t = t;
  look.speed = motion.velocity_n.head<2>().norm();
  look.height = motion.position.height - options.height_m;
  look.euler = so3::to_euler(motion.q_n_v);
  const double course = std::atan2(motion.velocity_n.y(), motion.velocity_n.x());
  look.crab = std::remainder(course - look.euler.heading, 2 * kPi);
  look.turn = std::remainder(look.euler.heading - *options.heading_deg * kDegree, 2 * kPi);
  look.yaw_rate = motion.omega_iv_v.z();
  look.f_v = motion.f_v;
  look.f_level =
      so3::from_euler({0, 0, look.euler.heading}).conjugate() * (motion.q_n_v * motion.f_v);
  return look;
}

std::vector<Look> trip_of(const std::string& name, int64_t seed) {
  ScenarioOptions options;
  options.name = name;
  options.seed = seed;
  options.rest_s = 10;
  options.duration_s = 600;
  options.heading_deg = 30;
  const Trajectory trip = make_trajectory(options);
  std::vector<Look> all;
  for (double t = 0; t < options.duration_s; t += kStep) {
    all.push_back(look_at(trip, t, options));
  }
  return all;
}

using Value = std::function<double(const Look&)>;
using Choice = std::function<bool(const Look&)>;

bool moves(const Look& look) { return look.speed > 0.3; }
bool always(const Look&) { return true; }

double largest(const std::vector<Look>& trip, const Value& value, const Choice& choice = always) {
  double most = 0;
  for (const Look& look : trip) {
    if (choice(look)) most = std::max(most, std::abs(value(look)));
  }
  return most;
}

double rms(const std::vector<Look>& trip, const Value& value, const Choice& choice = always) {
  double sum = 0, count = 0;
  for (const Look& look : trip) {
    if (!choice(look)) continue;
    sum += value(look) * value(look);
    ++count;
  }
  return std::sqrt(sum / count);
}

double share(const std::vector<Look>& trip, const Choice& choice) {
  const auto chosen = std::count_if(trip.begin(), trip.end(), choice);
  return static_cast<double>(chosen) / static_cast<double>(trip.size());
}

double speed_of(const Look& look) { return look.speed; }
double crab_of(const Look& look) { return look.crab; }
double side_force(const Look& look) { return look.f_v.y(); }
double level_side_force(const Look& look) { return look.f_level.y(); }

class VehicleOfSeed : public ::testing::TestWithParam<int64_t> {
 protected:
  static std::vector<Look> trip(const std::string& name) { return trip_of(name, GetParam()); }
};

INSTANTIATE_TEST_SUITE_P(Seeds, VehicleOfSeed, ::testing::Range<int64_t>(1, 5));

TEST_P(VehicleOfSeed, WalkSwaysWithItsSteps) {
  const std::vector<Look> walk = trip("walk");
  // Sway of 2 cm at 1 Hz is 0.13 m/s, beside the 1.6 of the way.
  EXPECT_LT(largest(walk, speed_of), 1.8);
  EXPECT_NEAR(share(walk, [](const Look& l) { return l.speed > 1.0; }), 590.0 / 600, 0.01);
  double steps = 0;
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const auto above = [&](std::size_t k) { return walk[k].f_level.z() > -9.8; };
    steps += !above(i - 1) && above(i);
  }
  EXPECT_NEAR(steps / 590, 2.0, 0.15);
  const Value bounce = [](const Look& l) { return l.f_level.z() + 9.8; };
  EXPECT_GT(rms(walk, bounce, moves), 1);
  EXPECT_LT(rms(walk, bounce, moves), 3);
  EXPECT_NEAR(rms(
                  walk, [](const Look& l) { return l.euler.roll; }, moves),
              1.4 * kDegree, 0.2 * kDegree);
  EXPECT_GT(share(walk, [](const Look& l) { return std::abs(l.turn) > 90 * kDegree; }), 0.1);
}

TEST_P(VehicleOfSeed, RobotTurnsOnTheSpotAndStops) {
  const std::vector<Look> robot = trip("robot");
  EXPECT_GT(largest(robot, speed_of), 2);
  EXPECT_LT(largest(robot, speed_of), 2.65);
  EXPECT_LT(largest(robot, crab_of, [](const Look& l) { return l.speed > 0.5; }), 4 * kDegree);
  const double on_the_spot = share(
      robot, [](const Look& l) { return l.speed < 0.02 && std::abs(l.yaw_rate) > 20 * kDegree; });
  const double still = share(robot, [](const Look& l) {
    return l.t > 10 && l.speed < 0.02 && std::abs(l.yaw_rate) < 0.1 * kDegree;
  });
  EXPECT_GT(on_the_spot, 0.03);
  EXPECT_GT(still, 0.02);
}

TEST_P(VehicleOfSeed, TractorGoesUpAndDownAtARegularInterval) {
  const std::vector<Look> rows = trip("rows");
  EXPECT_GT(rms(rows, speed_of, moves), 1.9);
  EXPECT_LT(largest(rows, speed_of), 3.1);
  const auto in_row = [](const Look& l) { return std::abs(std::sin(l.turn)) < 0.02; };
  EXPECT_GT(share(rows, in_row), 0.75);
  std::vector<double> turns;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double before = std::cos(rows[i - 1].turn), after = std::cos(rows[i].turn);
    if (before * after < 0) turns.push_back(rows[i].t);
  }
  ASSERT_GT(turns.size(), 8u);
  for (std::size_t i = 2; i < turns.size(); ++i) {
    EXPECT_NEAR(turns[i] - turns[i - 1], turns[1] - turns[0], 0.11);
  }
}

TEST_P(VehicleOfSeed, BoatDriftsAndRolls) {
  const std::vector<Look> boat = trip("boat");
  EXPECT_LT(largest(boat, speed_of), 8.3);
  const Choice sails = [](const Look& l) { return l.speed > 2; };
  EXPECT_GT(share(boat, [](const Look& l) { return l.speed > 2.9; }), 0.9);
  EXPECT_LT(largest(boat, crab_of, sails), 20 * kDegree);
  EXPECT_GT(largest(boat, crab_of, sails), 4 * kDegree);
  const Value roll = [](const Look& l) { return l.euler.roll; };
  const Value pitch = [](const Look& l) { return l.euler.pitch; };
  EXPECT_GT(rms(boat, roll, sails), 2 * kDegree);
  EXPECT_GT(rms(boat, pitch, sails), 1 * kDegree);
  EXPECT_GT(rms(boat, side_force, sails), 0.3);
}

TEST(Vehicle, BoatsHaveLeewayToEitherSideUpToTwentyDegrees) {
  double most = 0, least = 0;
  for (int64_t seed = 1; seed <= 20; ++seed) {
    for (const Look& look : trip_of("boat", seed)) {
      if (look.speed < 2) continue;
      most = std::max(most, look.crab);
      least = std::min(least, look.crab);
    }
  }
  EXPECT_GT(most, 14 * kDegree);
  EXPECT_LT(least, -14 * kDegree);
}

TEST_P(VehicleOfSeed, CopterFliesAnywhereAndItsThrustFollows) {
  const std::vector<Look> copter = trip("copter");
  EXPECT_LT(largest(copter, speed_of), 10.1);
  EXPECT_GT(largest(copter, [](const Look& l) { return l.height; }), 20);
  EXPECT_GT(share(copter, [](const Look& l) { return l.height > 10; }), 0.9);
  const Choice flies = [](const Look& l) { return l.speed > 1; };
  for (double side = -kPi; side < kPi; side += kPi / 2) {
    const double quarter = share(copter, [&](const Look& l) {
      return flies(l) && l.crab >= side && l.crab < side + kPi / 2;
    });
    EXPECT_GT(quarter, 0.05);
  }
  // Specific force along the vertical axis, but while thrust is changed within a knot interval.
  const Value level = [](const Look& l) { return l.f_level.head<2>().norm(); };
  const Value aside = [](const Look& l) { return l.f_v.head<2>().norm(); };
  EXPECT_GT(rms(copter, level), 1);
  EXPECT_LT(rms(copter, aside), 0.15 * rms(copter, level));
  EXPECT_GT(share(copter, [](const Look& l) { return std::abs(l.yaw_rate) > 3 * kDegree; }), 0.2);
}

TEST_P(VehicleOfSeed, FixedWingBanksAndCrabs) {
  const std::vector<Look> wing = trip("fixed_wing");
  const Choice flies = [](const Look& l) { return l.t > 30; };
  EXPECT_LT(largest(wing, speed_of), 25 + 3.8);
  EXPECT_GT(share(wing, [](const Look& l) { return l.speed > 15 - 3.8 && l.height > 30; }), 0.9);
  EXPECT_GT(largest(wing, crab_of, flies), 3 * kDegree);
  EXPECT_LT(largest(wing, crab_of, flies), 15 * kDegree);
  const Value bank = [](const Look& l) { return l.euler.roll; };
  EXPECT_GT(largest(wing, bank), 25 * kDegree);
  // 35 deg, more while a climb is levelled off by 1 m/s^2, and air that is not still.
  EXPECT_LT(largest(wing, bank), 40 * kDegree);
  EXPECT_LT(rms(wing, side_force, flies), 0.1 * rms(wing, level_side_force, flies));
}

TEST_P(VehicleOfSeed, TrainTakesItsTime) {
  const std::vector<Look> train = trip("train");
  EXPECT_LT(largest(train, speed_of), 40.1);
  EXPECT_GT(largest(train, speed_of), 25);
  EXPECT_LT(largest(train, level_side_force), 1.0);
  EXPECT_GT(largest(train, level_side_force), 0.4);
  // The rails are canted for six tenths of it.
  const Choice in_curve = [](const Look& l) { return std::abs(l.f_level.y()) > 0.2; };
  EXPECT_NEAR(rms(train, side_force, in_curve) / rms(train, level_side_force, in_curve), 0.4, 0.05);
  const Choice on_the_way = [](const Look& l) { return l.speed > 5; };
  EXPECT_LT(largest(train, crab_of, on_the_way), 0.5 * kDegree);
  double fastest_change = 0;
  for (std::size_t i = 20; i < train.size(); ++i) {
    fastest_change = std::max(fastest_change, std::abs(train[i].speed - train[i - 20].speed));
  }
  EXPECT_GT(fastest_change, 0.29);
  EXPECT_LT(fastest_change, 0.51);
}

TEST_P(VehicleOfSeed, ReversingCarGoesBackwardThenForward) {
  const std::vector<Look> car = trip("reversing");
  const auto moving = [](const Look& l) { return l.speed > 1; };
  const auto stops = std::find_if(std::find_if(car.begin(), car.end(), moving), car.end(),
                                  [](const Look& l) { return l.speed < 0.001; });
  ASSERT_NE(stops, car.end());
  const std::vector<Look> before(car.begin(), stops), after(stops, car.end());
  EXPECT_LT(
      largest(
          before, [](const Look& l) { return std::remainder(l.crab - kPi, 2 * kPi); }, moving),
      2 * kDegree);
  EXPECT_GT(largest(before, speed_of), 1.9);
  EXPECT_GT(largest(before, [](const Look& l) { return l.turn; }), 25 * kDegree);
  EXPECT_LT(largest(after, crab_of, moving), 2 * kDegree);
  EXPECT_GT(largest(after, speed_of), 8);
  EXPECT_LT(largest(car, level_side_force), 3.5);
}

}  // namespace
}  // namespace foucault::simulation
