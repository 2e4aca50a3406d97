#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "foucault/rawlog/rawlog_source.h"
#include "foucault/simulation/simulated_source.h"
#include "jobs/simulation_job.h"
#include "support/test_folder.h"

namespace foucault::app {
namespace {

std::vector<WheelSpeed> wheel_speeds_of(state::Source& source) {
  std::vector<WheelSpeed> speeds;
  while (const std::optional<Measurement> m = source.next()) {
    if (const auto* speed = std::get_if<WheelSpeed>(&*m)) speeds.push_back(*speed);
  }
  return speeds;
}

TEST(SimulationJob, RecordsWheelSpeeds) {
  const test::TestFolder folder;
  Console quiet(true);
  SimulationSettings trip;
  trip.scenario.duration_s = 60;
  trip.scenario.imu_rate_hz = 50;
  set_config("scenario.wheel_rate_hz=10", trip);
  set_config("scenario.wheel_sigma_m_s=0.02", trip);
  const SimulationCounts counts = write_simulation(trip, folder / "trip.rawlog", quiet);
  EXPECT_EQ(counts.wheel_speeds, 601);
  simulation::SimulatedSource simulated(trip.scenario, trip.imu.noise());
  rawlog::RawlogSource recorded(folder / "trip.rawlog");
  const std::vector<WheelSpeed> expected = wheel_speeds_of(simulated);
  const std::vector<WheelSpeed> speeds = wheel_speeds_of(recorded);
  ASSERT_EQ(speeds.size(), expected.size());
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    EXPECT_EQ(speeds[i].t_ns, expected[i].t_ns);
    EXPECT_EQ(speeds[i].forward, expected[i].forward);
  }
  EXPECT_GT(speeds.back().forward, 1);
}

}  // namespace
}  // namespace foucault::app
