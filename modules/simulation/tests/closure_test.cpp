#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "foucault/simulation/scenario.h"
#include "free_inertial.h"

/// Free-inertial navigation over 60 s lands on the truth: what the simulator says about rates,
/// forces, gravity and the Earth fits together, and its increments are their integrals.
namespace foucault::simulation {
namespace {

using namespace testing;

constexpr double kSpan = 60;  ///< [s]
constexpr int64_t kMillisecond_ns = 1'000'000;
constexpr int64_t kInterval_ns = 5 * kMillisecond_ns;  ///< 200 Hz

struct Case {
  std::string scenario;
  double latitude_deg, longitude_deg;
  double begin;                        ///< [s]
  int64_t interval_ns = kInterval_ns;  ///< of the navigators: the livelier the motion, the shorter
  double interval() const { return static_cast<double>(interval_ns) * 1e-9; }  ///< [s]
};

void PrintTo(const Case& test, std::ostream* out) { *out << test.scenario; }

Trajectory trip(const std::string& name, double latitude_deg, double longitude_deg) {
  ScenarioOptions options;
  options.name = name;
  options.latitude_deg = latitude_deg;
  options.longitude_deg = longitude_deg;
  options.duration_s = 1200;
  return make_trajectory(options);
}

class ClosureOf : public ::testing::TestWithParam<Case> {
 protected:
  Trajectory trajectory() const {
    return trip(GetParam().scenario, GetParam().latitude_deg, GetParam().longitude_deg);
  }
};

// Runge-Kutta of order 4 is exact to its rounding: ECEF metres are good to 1 nm.
TEST_P(ClosureOf, DifferentialEquations) {
  const Closure closure =
      close_runge_kutta(trajectory(), GetParam().begin, kSpan, GetParam().interval());
  EXPECT_LT(closure.position, 1e-7);
  EXPECT_LT(closure.velocity, 1e-8);
  EXPECT_LT(closure.angle, 1e-11);
}

// 10 um is the strapdown algorithm's own error (the next test shows its order), a
// hundredth of the 1 mm that is asked for.
TEST_P(ClosureOf, Increments) {
  const Closure closure =
      close_strapdown(trajectory(), GetParam().begin, kSpan, GetParam().interval_ns);
  EXPECT_LT(closure.position, 2e-5);
  EXPECT_LT(closure.velocity, 1e-7);
  EXPECT_LT(closure.angle, 2e-10);
}

TEST_P(ClosureOf, IncrementsConvergeWithSecondOrder) {
  const Trajectory truth = trajectory();
  const Closure coarse =
      close_strapdown(truth, GetParam().begin, kSpan, 4 * GetParam().interval_ns);
  const Closure fine = close_strapdown(truth, GetParam().begin, kSpan, GetParam().interval_ns);
  EXPECT_GT(coarse.position / fine.position, 12);  // 16 in the limit of small dt
}

INSTANTIATE_TEST_SUITE_P(
    Scenarios, ClosureOf,
    ::testing::Values(Case{"city", 30.45, 114.47, 60}, Case{"city", -33, 18, 500},
                      Case{"motorway", 50, 8, 300}, Case{"airliner", 30.45, 114.47, 50},
                      Case{"airliner", 80, 179.99, 700},
                      Case{"walk", 50, 8, 60, kMillisecond_ns / 2},
                      Case{"robot", -33, 18, 60, kMillisecond_ns},
                      Case{"rows", 50, 8, 60, 2 * kMillisecond_ns}, Case{"boat", 60, -179.99, 60},
                      Case{"copter", 30, 114, 60, kMillisecond_ns},
                      Case{"fixed_wing", -20, 30, 60, 2 * kMillisecond_ns},
                      Case{"train", 48, 2, 200}, Case{"reversing", 30.45, 114.47, 40}),
    [](const auto& test) { return test.param.scenario + std::to_string(test.index); });

TEST(ClosureControl, NeedsTheEarthRate) {
  Earth still;
  still.rate_e.setZero();
  const Trajectory city = trip("city", 30.45, 114.47);
  EXPECT_GT(close_strapdown(city, 60, kSpan, kInterval_ns, still).position, 2);
  EXPECT_GT(close_runge_kutta(city, 60, kSpan, 0.005, still).position, 2);
}

TEST(ClosureControl, NeedsTheTransportRate) {
  Earth flat;
  flat.gravity_follows_place = false;
  // g v / R t^3 / 6 = 0.5 m at 10 m/s and 14 m at 250 m/s.
  const Trajectory airliner = trip("airliner", 30.45, 114.47);
  EXPECT_GT(close_strapdown(airliner, 600, kSpan, kInterval_ns, flat).position, 5);
  const Trajectory city = trip("city", 30.45, 114.47);
  EXPECT_GT(close_strapdown(city, 60, kSpan, kInterval_ns, flat).position, 0.2);
}

// A vibration at 5 Hz whose axes are a quarter of a period apart: the angles cone.
TEST(ClosureControl, NeedsConing) {
  ScenarioOptions options;
  options.name = "static";
  options.duration_s = 100;
  options.vibration_hz = 5;
  options.vibration_m_s2 = 1;
  options.vibration_deg = 0.1;
  const Trajectory vibrating = make_trajectory(options);
  const Eigen::Quaterniond same = Eigen::Quaterniond::Identity();
  Strapdown navigator(vibrating.at(10), Earth{});
  Closure without;
  for (int64_t t = 10'000'000'000; t < 70'000'000'000; t += kInterval_ns) {
    const ImuIncrement increment = exact_increment(vibrating, same, 0, t, t + kInterval_ns);
    navigator.step(increment, increment);  // its own predecessor: the coning term vanishes
    const double end = 1e-9 * static_cast<double>(t + kInterval_ns);
    without.compare(navigator.state(), ecef_state(vibrating.at(end)));
  }
  const Closure with = close_strapdown(vibrating, 10, kSpan, kInterval_ns);
  EXPECT_GT(without.angle, 10 * with.angle);
  EXPECT_GT(without.position, 10 * with.position);
}

}  // namespace
}  // namespace foucault::simulation
