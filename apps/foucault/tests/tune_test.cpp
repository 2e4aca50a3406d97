#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "foucault/core/error.h"
#include "jobs/simulation_job.h"
#include "jobs/tune_job.h"
#include "support/test_folder.h"

namespace foucault::app {
namespace {

using testing::HasSubstr;
using tuning::MethodTuning;

constexpr const char* kGrid = R"(# A comment with an umlaut: Gitter für rough
base:
  imu: {preset: ADIS16465}
  outages:
    first_s: 100
    length_s: 20
    period_s: 40
    shifts_s: [0]
grid:
  imu.arw_deg_sqrt_h: [0.6, 0.15]
  imu.gyro_bias_deg_h: {from: 2, to: 200, steps: 3, scale: log}
method: ekf
)";

std::string with(std::string from, const std::string& to) {
  std::string yaml = kGrid;
  return yaml.replace(yaml.find(from), from.size(), to);
}

TEST(LoadGrid, ValuesAreTriedOnTheSettings) {
  TuneJob job;
  load_grid_text(kGrid, "grid.yaml", {"outages.length_s=15"}, job);
  EXPECT_EQ(job.base.outages.length_s, 15);
  const Settings at = job.at({1, 2});
  EXPECT_EQ(*at.imu.arw_deg_sqrt_h, 0.6);
  EXPECT_EQ(*at.imu.gyro_bias_deg_h, 200);
  EXPECT_EQ(at.outages.first_s, 100);
  EXPECT_THROW(load_grid_text(with("imu.arw_deg_sqrt_h", "imu.arw"), "grid.yaml", {}, job),
               UsageError);
  EXPECT_THROW(load_grid_text(with("method: ekf", "method: kalman"), "grid.yaml", {}, job),
               UsageError);
}

/// A search of six points on a log of 200 s.
class TuneTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TestFolder;
    Console console(true);
    SimulationSettings trip;
    trip.scenario.duration_s = 200;
    trip.scenario.seed = 5;
    write_simulation(trip, *folder_ / "trip.rawlog", console);
  }
  static void TearDownTestSuite() { delete folder_; }

  static TuneJob job(const std::string& out, const std::string& yaml = kGrid) {
    TuneJob job;
    job.logs = {*folder_ / "trip.rawlog"};
    load_grid_text(yaml, "grid.yaml", {}, job);
    job.out = out;
    job.report = false;
    return job;
  }

  static test::TestFolder* folder_;
};

test::TestFolder* TuneTest::folder_ = nullptr;

/// Half of the runs are in the store already.
TEST_F(TuneTest, AKilledSearchEndsWithTheSameResult) {
  const test::TestFolder out;
  Console console(true);
  RunStore whole({out / "store", "", false}, out / "a", 1);
  tune(job(out / "a"), whole, console);
  EXPECT_EQ(whole.runs().computed(), 6u);
  const std::string results = out.text("a/results.csv");
  EXPECT_EQ(std::count(results.begin(), results.end(), '\n'), 1 + 6);

  int kept = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out / "store")) {
    if (entry.is_regular_file() && ++kept % 2 == 0) std::filesystem::remove(entry.path());
  }
  RunStore half({out / "store", "", false}, out / "b", 2);
  tune(job(out / "b"), half, console);
  EXPECT_GT(half.runs().computed(), 0u);
  EXPECT_LT(half.runs().computed(), 6u);
  for (const char* name : {"results.csv", "metrics.json", "best.yaml"}) {
    EXPECT_EQ(out.text(std::string("b/") + name), out.text(std::string("a/") + name)) << name;
  }
  RunStore merge({out / "store", "", true}, out / "c", 2);
  tune(job(out / "c"), merge, console);
  EXPECT_EQ(out.text("c/points.csv"), out.text("b/points.csv")) << "times of the processor, too";
}

TEST_F(TuneTest, WritesTheBestOfThePoints) {
  const test::TestFolder out;
  Console console(true);
  RunStore store(2);
  const std::vector<MethodTuning> tunings = search(job(out / "a"), store, console);
  tune(job(out / "a"), store, console);
  ASSERT_EQ(tunings.size(), 1u);
  for (const auto& [point, score] : tunings[0].scores) {
    EXPECT_EQ(score.outages, 3);
    EXPECT_GE(score.horizontal_rms, tunings[0].search.value);
  }
  const auto json = nlohmann::json::parse(out.text("a/metrics.json"));
  EXPECT_EQ(json["methods"]["ekf"]["horizontal_rmse_m"], tunings[0].search.value);
  Settings best;
  load_config_text(out.text("a/best.yaml"), "best.yaml", best);
  EXPECT_EQ(best.imu.noise().gyro_noise_density,
            job(out / "a").at(tunings[0].search.best).imu.noise().gyro_noise_density);
  EXPECT_EQ(out.lines("a/heatmaps/ekf_imu_arw_deg_sqrt_h_imu_gyro_bias_deg_h.csv").size(), 7u);
}

/// Runs are found by what they depend on: a wider grid computes what is new, another objective
/// nothing, other outages everything.
TEST_F(TuneTest, AnotherSearchFindsWhatItShares) {
  const test::TestFolder out;
  const auto computed = [&](const std::string& yaml) {
    Console console(true);
    RunStore store({out / "store", "", false}, out / "a", 2);
    search(job(out / "a", yaml), store, console);
    return store.runs().computed();
  };
  EXPECT_EQ(computed(kGrid), 6u);
  EXPECT_EQ(computed(with("0.15]", "0.15, 0.3]")), 3u);
  EXPECT_EQ(computed(with("method: ekf", "method: ekf\nobjective: vertical")), 0u);
  EXPECT_EQ(computed(with("length_s: 20", "length_s: 15")), 6u);
  EXPECT_EQ(computed(with("shifts_s: [0]", "shifts_s: [0, 20]")), 6u) << "the second shift";
}

TEST_F(TuneTest, CoarseToFineFindsTheBestOfTheGrid) {
  const test::TestFolder out;
  Console console(true);
  RunStore store(2);
  const std::string grid = with("{from: 2, to: 200, steps: 3, scale: log}",
                                "{from: 0.5, to: 500, steps: 13, scale: log}");
  const std::string one = std::string(grid).replace(grid.find("[0.6, 0.15]"), 11, "[0.15]");
  const std::vector<MethodTuning> full = search(job(out / "a", one), store, console);
  const std::vector<MethodTuning> fast =
      search(job(out / "b", one + "search: coarse_to_fine\n"), store, console);
  EXPECT_EQ(fast[0].search.best, full[0].search.best);
  EXPECT_LT(fast[0].search.evaluated.size(), full[0].search.evaluated.size());
}

TEST_F(TuneTest, ALogWithoutOutagesIsAnError) {
  const test::TestFolder out;
  Console console(true);
  RunStore store(2);
  try {
    search(job(out / "a", with("first_s: 100", "first_s: 900")), store, console);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no outage fits"));
  }
}

}  // namespace
}  // namespace foucault::app
