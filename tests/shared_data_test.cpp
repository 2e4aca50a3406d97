#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "support/program.h"
#include "support/test_folder.h"

/// Real and simulated recordings that are too large for the repository.
namespace foucault::test {
namespace {

using nlohmann::json;

class SharedData : public testing::Test {
 protected:
  void SetUp() override {
    const std::optional<std::filesystem::path> data = shared_data();
    if (!data) GTEST_SKIP() << "no recordings: neither $FOUCAULT_DATA_DIR nor ../shared/data";
    data_ = *data;
  }

  std::string file(const std::string& name) const { return (data_ / name).string(); }

  void import(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "import");
    arguments.insert(arguments.end(), {"--out", log()});
    const Outcome outcome = foucault(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  json run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"run", log()});
    arguments.insert(arguments.end(), {"--no-report", "--out", folder_ / "run"});
    const Outcome outcome = foucault(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == 0 ? json::parse(folder_.text("run/metrics.json")) : json();
  }

  std::string log() const { return folder_ / "trip.rawlog"; }

  TestFolder folder_;
  std::filesystem::path data_;
};

TEST_F(SharedData, SimulatedCarAgainstItsTruth) {
  const std::string set = "sim_i2nav_adis16465/";
  import({"i2nav", "--imu", file(set + "imu.txt.gz"), "--gnss", file(set + "gnss.pos"),
          "--reference", file(set + "truth.nav"), "--gps-week", "2200", "--lever-arm",
          "0.1,-0.3,-0.8"});
  for (const std::string method : {"refined", "ekf"}) {
    const json m = run({"--method", method, "--set", "imu.preset=ADIS16465", "--set",
                        "output.statistics_from_s=100"});
    // What two public programs reach on these data, with a sixth to spare.
    EXPECT_LT(m["reference"]["horizontal_rmse_m"], 0.014) << method;
    EXPECT_LT(m["reference"]["vertical_rmse_m"], 0.010) << method;
  }
}

}  // namespace
}  // namespace foucault::test
