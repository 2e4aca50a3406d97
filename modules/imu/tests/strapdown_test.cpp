#include "foucault/imu/strapdown.h"

#include <gtest/gtest.h>

#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/place.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/simulation/imu_simulator.h"
#include "foucault/simulation/scenario.h"

namespace foucault::imu {
namespace {

simulation::ScenarioOptions scenario(const std::string& name, double duration_s) {
  simulation::ScenarioOptions options;
  options.name = name;
  options.duration_s = duration_s;
  options.seed = 3;
  return options;
}

state::NavState true_state(const simulation::Trajectory& trajectory, int64_t t_ns) {
  const simulation::Motion motion = trajectory.at(to_seconds(t_ns));
  state::NavState state;
  state.t_ns = t_ns;
  state.position = motion.position;
  state.velocity_n = motion.velocity_n;
  state.q_n_b = motion.q_n_v;
  return state;
}

/// The window of a free-inertial run and what is left out of the algorithm in it.
struct Window {
  double begin_s = 0;
  double length_s = 60;
  double rate_hz = 200;
  bool use_previous = true;  ///< coning and sculling
  bool feel_earth = true;    ///< false: the gyroscopes do not sense the Earth's rotation
};

struct Closure {
  double position = 0;  ///< [m]
  double velocity = 0;  ///< [m/s]
  double attitude = 0;  ///< [rad]
};

/// Integrates exact increments from the exact state and compares with the exact end.
Closure free_inertial_closure(const simulation::Trajectory& trajectory, const Window& run) {
  const int64_t begin_ns = nanoseconds(run.begin_s);
  const int64_t step_ns = nanoseconds(1 / run.rate_hz);
  const int64_t steps = static_cast<int64_t>(std::lround(run.length_s * run.rate_hz));
  state::NavState state = true_state(trajectory, begin_ns);
  ImuIncrement previous;
  for (int64_t k = 0; k < steps; ++k) {
    ImuIncrement increment =
        simulation::exact_increment(trajectory, Eigen::Quaterniond::Identity(), 0,
                                    begin_ns + k * step_ns, begin_ns + (k + 1) * step_ns);
    if (!run.feel_earth) {
      increment.dtheta_b -= state.q_n_b.conjugate() *
                            geodesy::wgs84::earth_rate_n(state.position.latitude) * increment.dt();
    }
    state = advance(state, run.use_previous ? previous : ImuIncrement{}, increment);
    previous = increment;
  }
  const state::NavState truth = true_state(trajectory, begin_ns + steps * step_ns);
  return {geodesy::displacement_n(truth.position, state.position, geodesy::Place(truth.position))
              .norm(),
          (state.velocity_n - truth.velocity_n).norm(),
          so3::log(truth.q_n_b.conjugate() * state.q_n_b).norm()};
}

/// The worst of several windows of a trip.
Closure worst_closure(const simulation::Trajectory& trajectory, Window run, double first_s,
                      double last_s) {
  Closure worst;
  for (run.begin_s = first_s; run.begin_s + run.length_s <= last_s; run.begin_s += run.length_s) {
    const Closure closure = free_inertial_closure(trajectory, run);
    worst.position = std::max(worst.position, closure.position);
    worst.velocity = std::max(worst.velocity, closure.velocity);
    worst.attitude = std::max(worst.attitude, closure.attitude);
  }
  return worst;
}

TEST(Strapdown, CityDriveClosesBelowAMillimetre) {
  const simulation::Trajectory city = simulation::make_trajectory(scenario("city", 460));
  const Closure worst = worst_closure(city, Window{}, 40, 460);
  // Second-order terms leave about 10 um and 10 nm/s; a wrong term leaves far more.
  EXPECT_LT(worst.position, 5e-5);
  EXPECT_LT(worst.velocity, 5e-8);
  EXPECT_LT(worst.attitude, 1e-9);
}

TEST(Strapdown, AirlinerClosesBelowAMillimetre) {
  const simulation::Trajectory airliner = simulation::make_trajectory(scenario("airliner", 1500));
  const Closure worst = worst_closure(airliner, Window{}, 600, 1200);
  // Second-order terms leave about 10 um and 10 nm/s; a wrong term leaves far more.
  EXPECT_LT(worst.position, 5e-5);
  EXPECT_LT(worst.velocity, 5e-8);
  EXPECT_LT(worst.attitude, 1e-9);
}

TEST(Strapdown, ErrorFallsAtLeastWithTheSquareOfTheInterval) {
  const simulation::Trajectory city = simulation::make_trajectory(scenario("city", 280));
  Window run;
  run.begin_s = 100;
  run.rate_hz = 12.5;
  double coarser = free_inertial_closure(city, run).position;
  for (const double rate_hz : {25.0, 50.0, 100.0}) {
    run.rate_hz = rate_hz;
    const double finer = free_inertial_closure(city, run).position;
    EXPECT_GT(coarser / finer, 3.5) << "at " << rate_hz << " Hz";
    coarser = finer;
  }
}

TEST(Strapdown, ConingAndScullingTermsMatterUnderVibration) {
  simulation::ScenarioOptions options = scenario("city", 180);
  options.vibration_hz = 10;
  options.vibration_m_s2 = 2;
  options.vibration_deg = 0.2;
  const simulation::Trajectory shaking = simulation::make_trajectory(options);
  Window run;
  run.begin_s = 60;
  const Closure with = free_inertial_closure(shaking, run);
  run.use_previous = false;
  const Closure without = free_inertial_closure(shaking, run);
  EXPECT_LT(with.position, 0.1 * without.position);
  EXPECT_LT(with.attitude, 0.1 * without.attitude);
  EXPECT_GT(without.position, 0.05);
}

TEST(Strapdown, GyroscopesBlindToTheEarthFailTheClosure) {
  const simulation::Trajectory city = simulation::make_trajectory(scenario("city", 160));
  Window run;
  run.begin_s = 60;
  run.feel_earth = false;
  // Earth rate * g * t^3 / 6 = 25 m at 30 deg, times the share that turns about the level axes.
  EXPECT_GT(free_inertial_closure(city, run).position, 10);
}

TEST(Strapdown, ClosesAcrossTheDateLineAndAtHighLatitude) {
  for (const double latitude_deg : {80.0, -75.0, 0.0}) {
    simulation::ScenarioOptions options = scenario("airliner", 1300);
    options.latitude_deg = latitude_deg;
    options.longitude_deg = 179.2;
    options.heading_deg = 90;
    const simulation::Trajectory airliner = simulation::make_trajectory(options);
    Window run;
    run.begin_s = 100;
    run.length_s = 1200;
    run.rate_hz = 50;
    const double begin = airliner.at(run.begin_s).position.longitude;
    const double end = airliner.at(run.begin_s + run.length_s).position.longitude;
    EXPECT_GT(begin, 0);
    EXPECT_LT(end, 0) << "the flight does not cross the date line";
    // 0.3 mm after 1200 s at 50 Hz; a longitude that jumps would be kilometres off.
    EXPECT_LT(free_inertial_closure(airliner, run).position, 1e-3) << "at " << latitude_deg;
  }
}

TEST(Strapdown, RestStaysAtRestForAnHour) {
  state::NavState state;
  state.position = {45 * kDegree, 7 * kDegree, 300};
  state.q_n_b = so3::from_euler({0.02, -0.03, 1.0});
  const geodesy::Place place(state.position);
  const Geodetic start = state.position;
  ImuIncrement increment;
  increment.t_end_ns = nanoseconds(0.01);
  increment.dtheta_b = state.q_n_b.conjugate() * place.omega_ie_n * 0.01;
  increment.dvel_b = state.q_n_b.conjugate() * Eigen::Vector3d(0, 0, -place.gravity * 0.01);
  for (int64_t k = 0; k < 360'000; ++k) {
    increment.t_begin_ns = state.t_ns;
    increment.t_end_ns = state.t_ns + nanoseconds(0.01);
    state = advance(state, k == 0 ? ImuIncrement{} : increment, increment);
  }
  EXPECT_LT(geodesy::displacement_n(start, state.position, place).norm(), 1e-3);
  EXPECT_LT(state.velocity_n.norm(), 1e-6);
}

TEST(Strapdown, DisplacementInvertsDisplaced) {
  const Geodetic here{-33 * kDegree, 179.9999 * kDegree, 55};
  const geodesy::Place place(here);
  const Eigen::Vector3d d_n(120, 340, -12);
  const Geodetic there = geodesy::displaced(here, d_n, place);
  EXPECT_LT(there.longitude, 0);
  // Rounding of radians: 2e-16 * pi * Earth radius.
  EXPECT_LT((geodesy::displacement_n(here, there, place) - d_n).norm(), 1e-8);
  const Eigen::Vector3d chord_n =
      geodesy::wgs84::R_e_n(here.latitude, here.longitude).transpose() *
      (geodesy::wgs84::geodetic_to_ecef(there) - geodesy::wgs84::geodetic_to_ecef(here));
  // Curvature: d^2 / 2R = 1 cm.
  EXPECT_LT((chord_n - d_n).norm(), 0.02);
}

TEST(Strapdown, BiasIsTakenOff) {
  ImuIncrement increment;
  increment.t_end_ns = nanoseconds(0.5);
  increment.dtheta_b = {0.1, 0.2, 0.3};
  increment.dvel_b = {1, 2, 3};
  const ImuIncrement clean = without_bias(increment, {{0.02, 0, 0}, {0, 0.4, 0}});
  EXPECT_NEAR(clean.dtheta_b.x(), 0.09, 1e-15);
  EXPECT_NEAR(clean.dvel_b.y(), 1.8, 1e-15);
  EXPECT_EQ(clean.dvel_b.z(), 3);
}

}  // namespace
}  // namespace foucault::imu
