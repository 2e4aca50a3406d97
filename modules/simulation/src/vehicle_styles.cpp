#include "vehicle_styles.h"

#include <cmath>
#include <initializer_list>

#include "foucault/core/constants.h"

namespace foucault::simulation {
namespace {

/// A car's springs: parts of the angles that would level the specific force (VehicleStyle).
constexpr double kSprings = -0.06;

struct Wave {
  double amplitude, wavelength;
};

SineSum waves(Draws& draws, double unit, std::initializer_list<Wave> list) {
  std::vector<SineSum::Term> terms;
  for (const Wave& wave : list) {
    terms.push_back({wave.amplitude * unit, wave.wavelength, draws.phase()});
  }
  return SineSum(std::move(terms));
}

Leg straight(double speed, double seconds) {
  Leg leg;
  leg.speed = speed;
  leg.seconds = seconds;
  return leg;
}

/// turn [rad] at a rate [rad/s].
Leg curve(double speed, double turn, double rate) {
  Leg leg = straight(speed, std::abs(turn) / rate);
  leg.turn = turn;
  return leg;
}

/// To either side [rad].
double turn_between(Draws& draws, double low_deg, double high_deg) {
  const double side = draws.sign();
  return side * draws.uniform(low_deg, high_deg) * kDegree;
}

/// A course that bends a little more, and on, at a speed drawn once for both.
std::vector<Leg> straight_and_curve(Draws& draws, double speed, double longest_s, double turn,
                                    double rate) {
  return {straight(speed, draws.uniform(0.2, 1) * longest_s), curve(speed, turn, rate)};
}

std::vector<Leg> next_of_walk(Draws& draws) {
  const double speed = draws.uniform(1.2, 1.6);
  const double turn = turn_between(draws, 20, 120);
  return straight_and_curve(draws, speed, 15, turn, draws.uniform(30, 60) * kDegree);
}

std::vector<Leg> next_of_robot(Draws& draws) {
  const double what = draws.uniform(0, 1);
  if (what < 0.35) return {straight(draws.uniform(0.5, 2.6), draws.uniform(3, 10))};
  if (what < 0.65) {
    const double speed = draws.uniform(0.5, 1.5);
    const double turn = turn_between(draws, 30, 120);
    return {curve(speed, turn, draws.uniform(20, 60) * kDegree)};
  }
  if (what < 0.85) {
    const double turn = turn_between(draws, 45, 180);
    return {curve(0, turn, draws.uniform(30, 90) * kDegree)};
  }
  return {straight(0, draws.uniform(1, 5))};
}

std::vector<Leg> next_of_boat(Draws& draws) {
  const double speed = draws.uniform(3, 8);
  const double turn = turn_between(draws, 20, 150);
  return straight_and_curve(draws, speed, 40, turn, draws.uniform(3, 8) * kDegree);
}

/// Flies anywhere while the nose does what it likes, then hovers.
std::vector<Leg> next_of_copter(Draws& draws) {
  Leg flight = straight(draws.uniform(2, 10), draws.uniform(4, 12));
  flight.direction = draws.uniform(-kPi, kPi);
  flight.altitude = draws.uniform(15, 60);
  if (draws.happens(0.4)) flight.turn = turn_between(draws, 20, 90);
  if (draws.happens(0.6)) flight.yaw = turn_between(draws, 20, 150);
  Leg hover = straight(0, draws.uniform(0.5, 3));
  hover.altitude = flight.altitude;
  return {flight, hover};
}

std::vector<Leg> next_of_fixed_wing(Draws& draws) {
  const double speed = draws.uniform(15, 25);
  const double turn = turn_between(draws, 30, 180);
  const double rate = kStandardGravity * std::tan(draws.uniform(15, 35) * kDegree) / speed;
  std::vector<Leg> legs = straight_and_curve(draws, speed, 20, turn, rate);
  const double altitude = draws.uniform(50, 150);
  for (Leg& leg : legs) leg.altitude = altitude;
  return legs;
}

/// A curve whose lateral acceleration its passengers bear.
std::vector<Leg> next_of_train(Draws& draws) {
  const double speed = draws.uniform(10, 40);
  const double turn = turn_between(draws, 15, 70);
  return straight_and_curve(draws, speed, 40, turn, draws.uniform(0.3, 0.9) / speed);
}

std::vector<Leg> next_of_car(Draws& draws) {
  const double slow = draws.uniform(5, 8);
  const double turn = turn_between(draws, 20, 100);
  std::vector<Leg> legs{straight(draws.uniform(6, 14), draws.uniform(3, 15)),
                        curve(slow, turn, draws.uniform(0.1, 0.35))};
  if (draws.happens(0.2)) legs.push_back(straight(0, draws.uniform(3, 10)));
  return legs;
}

}  // namespace

VehicleStyle walk_style(Draws& draws) {
  // Two steps of 0.7 m are a period to the sides, one is a period up and down.
  constexpr double kStep = 0.7, kPair = 2 * kStep;
  VehicleStyle style;
  style.acceleration = 1;
  style.turn_acceleration = 120 * kDegree;
  style.hills = waves(draws, 1, {{1.5, 300}, {0.4, 80}});
  style.right = waves(draws, 1, {{0.02, kPair}});
  style.up = waves(draws, 1, {{0.02, kStep}});
  style.roll = waves(draws, kDegree, {{2, kPair}});
  style.pitch = waves(draws, kDegree, {{1.5, kStep}});
  style.yaw = waves(draws, kDegree, {{3, kPair}});
  style.next = next_of_walk;
  return style;
}

VehicleStyle robot_style(Draws& draws) {
  VehicleStyle style;
  style.acceleration = 1;
  style.turn_acceleration = 180 * kDegree;
  style.roll_lean = style.pitch_lean = kSprings;
  style.hills = waves(draws, 1, {{0.5, 120}, {0.1, 20}});
  style.up = waves(draws, 1, {{0.002, 0.7}, {0.004, 1.9}});
  style.roll = waves(draws, kDegree, {{0.3, 0.9}, {0.6, 2.3}});
  style.pitch = waves(draws, kDegree, {{0.3, 0.8}, {0.5, 2.1}});
  style.next = next_of_robot;
  return style;
}

VehicleStyle rows_style(Draws& draws) {
  VehicleStyle style;
  style.acceleration = 0.8;
  style.turn_acceleration = 30 * kDegree;
  style.roll_lean = style.pitch_lean = kSprings;
  style.hills = waves(draws, 1, {{1.5, 400}, {0.2, 60}});
  style.up = waves(draws, 1, {{0.01, 2.9}, {0.015, 5.3}});
  style.roll = waves(draws, kDegree, {{0.5, 3.1}, {0.8, 8.3}});
  style.pitch = waves(draws, kDegree, {{0.4, 2.7}, {0.5, 6.1}});
  const double speed = draws.uniform(2, 3);
  const Leg row = straight(speed, draws.uniform(80, 120) / speed);
  const double rate = speed / draws.uniform(3.5, 6);
  style.next = [speed, row, rate](Draws&) -> std::vector<Leg> {
    return {row, curve(speed, kPi, rate), row, curve(speed, -kPi, rate)};
  };
  return style;
}

VehicleStyle boat_style(Draws& draws) {
  VehicleStyle style;
  style.acceleration = 0.5;
  style.turn_acceleration = 3 * kDegree;
  style.roll_lean = -0.3;
  style.up = waves(draws, 1, {{0.15, 17}, {0.1, 26}});
  style.roll = waves(draws, kDegree, {{3, 17}, {2, 26}});
  style.pitch = waves(draws, kDegree, {{1.5, 17}, {1.5, 23}});
  style.yaw = waves(draws, kDegree, {{1, 20}, {2, 270}, {2, 600}});
  // With twice the amplitudes of the yaw, leeway stays below 20 deg.
  Leg setting_out = straight(5, 5);
  setting_out.direction = draws.uniform(-10, 10) * kDegree;
  style.first = {setting_out};
  style.next = next_of_boat;
  return style;
}

VehicleStyle copter_style(Draws& draws) {
  VehicleStyle style;
  style.acceleration = 2.5;
  style.turn_acceleration = 60 * kDegree;
  style.climb_rate = 2.5;
  style.roll_lean = style.pitch_lean = 1;
  Leg take_off = straight(0, 4);
  take_off.altitude = draws.uniform(15, 60);
  style.first = {take_off};
  style.next = next_of_copter;
  return style;
}

VehicleStyle fixed_wing_style(Draws& draws) {
  VehicleStyle style;
  style.acceleration = 2;
  style.turn_acceleration = 10 * kDegree;
  style.climb_rate = 3;
  style.roll_lean = 1;
  style.nose_follows_climb = true;
  style.roll = waves(draws, kDegree, {{0.5, 90}, {0.5, 210}});
  style.pitch = waves(draws, kDegree, {{0.4, 70}, {0.4, 190}});
  // 3.8 m/s across the slowest flight of 15 m/s are a crab angle of 15 deg.
  const double from = draws.phase();
  style.wind_n = draws.uniform(1.5, 3.8) * Eigen::Vector2d(std::cos(from), std::sin(from));
  Leg launch = straight(18, 5);
  launch.altitude = 80;
  style.first = {launch};
  style.next = next_of_fixed_wing;
  return style;
}

VehicleStyle train_style(Draws& draws) {
  VehicleStyle style;
  style.acceleration = draws.uniform(0.3, 0.5);
  style.turn_acceleration = 0.3 * kDegree;
  style.roll_lean = 0.6;  // canted rails
  style.hills = waves(draws, 1, {{4, 2500}, {1.5, 1100}});
  style.up = waves(draws, 1, {{0.003, 25}, {0.004, 43}});
  style.roll = waves(draws, kDegree, {{0.15, 31}, {0.1, 60}});
  style.next = next_of_train;
  return style;
}

VehicleStyle reversing_style(Draws& draws) {
  VehicleStyle style;
  style.acceleration = 1.5;
  style.turn_acceleration = 20 * kDegree;
  style.roll_lean = style.pitch_lean = kSprings;
  style.hills = waves(draws, 1, {{2.5, 1200}, {1, 600}});
  style.up = waves(draws, 1, {{0.004, 17}, {0.006, 31}});
  style.roll = waves(draws, kDegree, {{0.15, 23}, {0.3, 190}});
  style.pitch = waves(draws, kDegree, {{0.1, 19}, {0.15, 47}});
  const double speed = draws.uniform(2, 5);
  const double turn = turn_between(draws, 30, 120);
  Leg backward = straight(speed, draws.uniform(4, 10));
  backward.direction = kPi;
  Leg forward = straight(6, 2);
  forward.direction = 0;
  style.first = {backward, curve(speed, turn, 0.3), straight(speed, draws.uniform(2, 6)),
                 straight(0, draws.uniform(2, 5)), forward};
  style.next = next_of_car;
  return style;
}

}  // namespace foucault::simulation
