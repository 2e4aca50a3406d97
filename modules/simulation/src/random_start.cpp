#include "foucault/simulation/random_start.h"

#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/simulation/random.h"

namespace foucault::simulation {
namespace {

constexpr double kDuration = 180;  ///< [s]
constexpr double kEarliest = 5;    ///< in a trip, of a recording that begins in motion [s]
constexpr double kLatest = 200;    ///< [s]
constexpr double kMoving = 0.5;    ///< [m/s]
constexpr int kCandidates = 20;    ///< for the instant at which it turns most
constexpr double kLookStep = 0.1;  ///< [s]

template <class T>
const T& one_of(const std::vector<T>& all, Draws& draws) {
  return all[static_cast<std::size_t>(draws.uniform(0, static_cast<double>(all.size())))];
}

double speed_at(const Trajectory& trip, double t) { return trip.at(t).velocity_n.norm(); }

/// Of the course [rad/s].
double turn_rate_at(const Trajectory& trip, double t) {
  const Eigen::Vector3d before = trip.at(t - kLookStep).velocity_n;
  const Eigen::Vector3d after = trip.at(t + kLookStep).velocity_n;
  const double cross = before.x() * after.y() - before.y() * after.x();
  return std::atan2(cross, before.head<2>().dot(after.head<2>())) / (2 * kLookStep);
}

/// An instant of the trip at which the vehicle moves. There is one: no stop is as long as the trip.
double moving_instant(const Trajectory& trip, Draws& draws) {
  double t = draws.uniform(kEarliest, kLatest);
  while (speed_at(trip, t) < kMoving) t = draws.uniform(kEarliest, kLatest);
  return t;
}

/// Of several such instants that at which it turns most.
double turning_instant(const Trajectory& trip, Draws& draws) {
  double best = moving_instant(trip, draws);
  for (int i = 1; i < kCandidates; ++i) {
    const double t = moving_instant(trip, draws);
    if (std::abs(turn_rate_at(trip, t)) > std::abs(turn_rate_at(trip, best))) best = t;
  }
  return best;
}

void draw_beginning(ScenarioOptions& scenario, Draws& draws) {
  const double kind = draws.uniform(0, 3);
  scenario.rest_s = 0;
  if (kind < 1) {
    scenario.rest_s = draws.uniform(5, 40);
    return;
  }
  scenario.duration_s = kLatest + 1;
  const Trajectory trip = make_trajectory(scenario);
  scenario.skip_s = kind < 2 ? moving_instant(trip, draws) : turning_instant(trip, draws);
}

void draw_gnss(ScenarioOptions& scenario, Draws& draws) {
  scenario.gnss_rate_hz = std::exp(draws.uniform(std::log(0.2), std::log(10)));
  scenario.gnss_phase_s = draws.uniform(0, 1 / scenario.gnss_rate_hz);
  const bool rtk = draws.happens(0.5);
  const double horizontal = rtk ? draws.uniform(0.01, 0.02) : draws.uniform(1.5, 3);
  // Heights are twice as uncertain under the usual sky.
  scenario.gnss_sigma_m = {horizontal, horizontal, 2 * horizontal};
  if (rtk) return;
  scenario.gnss_quality = "single";
  if (draws.happens(0.5)) scenario.gnss_velocity_sigma_m_s = draws.uniform(0.05, 0.2);
}

}  // namespace

RandomStart random_start(int64_t seed) {
  static const std::vector<std::string> kMotions{
      "walk", "robot", "boat", "city", "reversing", "copter", "fixed_wing", "train", "rows"};
  Draws draws(seed, RandomStream::start);
  RandomStart start;
  ScenarioOptions& scenario = start.scenario;
  start.imu = one_of(imu::imu_preset_names(), draws);
  scenario.name = one_of(kMotions, draws);
  scenario.seed = seed;
  scenario.latitude_deg = draws.uniform(-70, 70);
  scenario.longitude_deg = draws.uniform(-180, 180);
  scenario.lever_arm_m = {draws.uniform(-0.5, 0.5), draws.uniform(-0.3, 0.3), draws.uniform(-1, 0)};
  draw_gnss(scenario, draws);
  draw_beginning(scenario, draws);
  scenario.duration_s = kDuration;
  return start;
}

}  // namespace foucault::simulation
