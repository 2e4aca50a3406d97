#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"
#include "support/table.h"
#include "support/test_folder.h"

/// `evaluate` and `tune` of the built program on a small simulated recording.
namespace foucault::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;

using Arguments = std::vector<std::string>;

Arguments joined(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Outages of 10 s at 60 s and 80 s.
const Arguments kOutages{"--set", "outages.first_s=60",  "--set", "outages.length_s=10",
                         "--set", "outages.period_s=20", "--set", "outages.shifts_s=[0]"};

class Evaluate : public testing::Test {
 protected:
  Evaluate() {
    log_ = folder_ / "trip.rawlog";
    const Outcome made =
        foucault({"simulate", "--duration", "100", "--seed", "7", "--set", "scenario.rest_s=15",
                  "--set", "scenario.imu_rate_hz=50", "--out", log_});
    EXPECT_EQ(made.exit_code, 0) << made.err;
  }

  Outcome evaluate(const std::string& out, const Arguments& more) const {
    return foucault(joined(joined({"evaluate", log_, "--out", folder_ / out}, kOutages), more));
  }

  void expect_refused(const Arguments& arguments, int exit_code,
                      const testing::Matcher<std::string>& reason) const {
    const std::size_t before = folder_.entries();
    const Outcome outcome = foucault(joined(arguments, {"--out", folder_ / "out"}));
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(testing::StartsWith("foucault: error: "), reason));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(folder_.entries(), before) << "something was left behind";
  }

  TestFolder folder_;
  std::string log_;
};

TEST_F(Evaluate, WritesTablesNumbersAndReport) {
  const Outcome outcome = evaluate("out", {"--paper"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("2 of 10 s in 1 recording; truth: the reference"),
                                 HasSubstr("ekf Hor"), HasSubstr("rough - ekf (%)")));
  const json metrics = json::parse(folder_.text("out/metrics.json"));
  const Table drifts(folder_ / "out/drift.csv");
  EXPECT_THAT(drifts.column("length_s"), Each(10));
  EXPECT_EQ(drifts.rows(), 6u);
  for (const char* method : {"ekf", "refined", "rough"}) {
    EXPECT_EQ(metrics["methods"][method]["outages"], 2) << method;
    EXPECT_GT(metrics["methods"][method]["horizontal_rmse_m"], 0) << method;
  }
  // Three methods, 5 s and the middle, two axes.
  EXPECT_EQ(metrics["normalized_drift"].size(), 12u);
  for (const json& entry : metrics["normalized_drift"]) {
    EXPECT_EQ(entry["after_s"], 5) << "the middle, too";
    EXPECT_EQ(entry["outages"], 2);
    EXPECT_GT(entry["mean_square"], 0);
    EXPECT_LT(entry["band_low"], 1);
    EXPECT_GT(entry["band_high"], 1);
  }
  ASSERT_EQ(metrics["after_return"].size(), 3u);
  for (const json& entry : metrics["after_return"]) {
    EXPECT_LT(entry["horizontal_max_m"], 0.2) << "centimetres, as with fixes";
    EXPECT_EQ(entry["never_settled"], 0);
  }
  EXPECT_THAT(drifts.column("return_max_horizontal_m"), Each(testing::Lt(0.2)));
  EXPECT_THAT(folder_.text("out/report/index.html"),
              AllOf(HasSubstr("RMSEs of horizontal"), HasSubstr("Consistency in outages")));
  for (const char* name :
       {"out/tables/table_iii.csv", "out/tables/table_iv.md", "out/tables/normalized_drift.csv",
        "out/tables/after_return.md", "out/report/drift_rms.png",
        "out/report/normalized_drift_trip.png", "out/report/drift_curves_trip.png",
        "out/report/error_timeline_trip.png"}) {
    EXPECT_TRUE(fs::exists(folder_.path() / name)) << name;
  }
}

TEST_F(Evaluate, TellsWhatPartsOfTheConfigurationAreWorth) {
  const Outcome outcome =
      evaluate("out", {"--ablate", "--methods", "ekf", "--set", "aids.nonholonomic=on", "--set",
                       "aids.gnss_velocity=off", "--set", "aids.zero_velocity=off", "--set",
                       "aids.wheel_speed=off", "--set", "aids.heading=off", "--set",
                       "calibrate.mounting=on"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> parts{"", "nonholonomic", "aids", "calibration",
                                       "aids and calibration"};
  const json metrics = json::parse(folder_.text("out/metrics.json"));
  ASSERT_EQ(metrics["ablation"].size(), parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const json& row = metrics["ablation"][i];
    EXPECT_EQ(row["without"], parts[i]);
    EXPECT_EQ(row["horizontal_relative"].is_null(), i == 0);
    const std::string label = i == 0 ? "ekf" : "ekf without " + parts[i];
    EXPECT_EQ(metrics["methods"][label]["horizontal_rmse_m"], row["horizontal_rmse_m"]);
    EXPECT_THAT(outcome.out, HasSubstr(label + " "));
  }
  const json& rows = metrics["ablation"];
  EXPECT_NE(rows[1]["horizontal_rmse_m"], rows[0]["horizontal_rmse_m"]);
  EXPECT_EQ(rows[1]["vertical_rmse_m"], rows[2]["vertical_rmse_m"]) << "there is no other aid";
  EXPECT_NE(rows[3]["horizontal_rmse_m"], rows[0]["horizontal_rmse_m"]);
  ASSERT_EQ(evaluate("bare", {"--methods", "ekf", "--no-report", "--set", "aids.mode=none", "--set",
                              "calibrate.mode=none"})
                .exit_code,
            0);
  EXPECT_EQ(json::parse(folder_.text("bare/metrics.json"))["methods"]["ekf"]["horizontal_rmse_m"],
            rows[4]["horizontal_rmse_m"]);
  EXPECT_EQ(Table(folder_ / "out/drift.csv").rows(), 2 * parts.size());

  const std::string page = folder_.text("out/report/index.html");
  EXPECT_THAT(page, HasSubstr("ekf without calibration"));
  const json curves = json::parse(folder_.text("out/report/drift_growth_trip.json"));
  for (const json& series : curves["panels"][0]["series"])
    EXPECT_THAT(series.dump(), Not(HasSubstr("without"))) << "figures are of the full one";
  EXPECT_TRUE(fs::exists(folder_.path() / "out/tables/ablation.csv"));
}

TEST_F(Evaluate, NumbersDoNotDependOnJobs) {
  ASSERT_EQ(evaluate("one", {"--jobs", "1", "--no-report", "--quiet"}).exit_code, 0);
  ASSERT_EQ(evaluate("two", {"--jobs", "2", "--no-report"}).exit_code, 0);
  for (const char* name : {"/drift.csv", "/tables/table_iii.csv", "/tables/statistics.csv"}) {
    EXPECT_EQ(folder_.text(std::string("one") + name), folder_.text(std::string("two") + name));
  }
  EXPECT_FALSE(fs::exists(folder_.path() / "one/report"));
}

TEST_F(Evaluate, WrongUsage) {
  expect_refused({"evaluate", log_, "--methods", "ekf,kalman"}, 2, HasSubstr("kalman"));
  expect_refused({"evaluate", log_, log_}, 2, HasSubstr("given twice"));
  expect_refused({"evaluate", log_, "--jobs", "0"}, 2, HasSubstr("--jobs"));
  expect_refused({"evaluate", log_, "--set", "outages.period_s=30"}, 2, HasSubstr("period_s"));
  expect_refused(
      {"evaluate", log_, "--ablate", "--set", "aids.mode=none", "--set", "calibrate.mode=none"}, 2,
      HasSubstr("nothing can be switched off"));
  expect_refused({"tune", log_}, 2, HasSubstr("--config"));
}

TEST_F(Evaluate, BadData) {
  expect_refused({"evaluate", log_}, 1,
                 AllOf(HasSubstr("no outage fits"), HasSubstr("outages.first_s")));
  expect_refused({"evaluate", log_, folder_ / "none.rawlog"}, 1, HasSubstr("none.rawlog"));
  expect_refused({"tune", log_, "--config", folder_ / "none.yaml"}, 1, HasSubstr("none.yaml"));
}

class Tune : public Evaluate {
 protected:
  Tune() {
    folder_.write("grid.yaml",
                  "base:\n"
                  "  outages: {first_s: 60, length_s: 10, period_s: 20, shifts_s: [0]}\n"
                  "grid:\n"
                  "  imu.arw_deg_sqrt_h: {from: 0.02, to: 2, steps: 5, scale: log}\n"
                  "  imu.gyro_bias_deg_h: {from: 1, to: 100, steps: 5, scale: log}\n"
                  "method: ekf\n");
  }

  Arguments tune(const std::string& out) const {
    return {"tune", log_, "--config", folder_ / "grid.yaml", "--out", folder_ / out, "--no-report"};
  }
};

TEST_F(Tune, GoesOnAfterItWasStopped) {
  ASSERT_EQ(foucault(tune("whole")).exit_code, 0);
  const fs::path store = folder_.path() / ".parts.foucault-records";
  const auto half_done = [&] {
    std::error_code ignored;
    const fs::recursive_directory_iterator records(store, ignored);
    return std::distance(records, {}) > 24;  // each in a folder, nearly
  };
  const Outcome stopped = foucault_interrupted(tune("parts"), half_done, SIGTERM);
  EXPECT_EQ(stopped.exit_code, 143) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("runs are kept in"));
  EXPECT_FALSE(fs::exists(folder_.path() / "parts/best.yaml"));

  const Outcome resumed = foucault(tune("parts"));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.out, HasSubstr("found in"));
  EXPECT_FALSE(fs::exists(store));
  for (const char* name : {"/best.yaml", "/results.csv", "/metrics.json"}) {
    EXPECT_EQ(folder_.text(std::string("parts") + name), folder_.text(std::string("whole") + name))
        << name;
  }
}

TEST_F(Tune, TheBestIsReadyForRun) {
  ASSERT_EQ(foucault(joined(tune("out"), {"--set", "outages.length_s=12"})).exit_code, 0);
  const Outcome run = foucault({"run", log_, "--config", folder_ / "out/best.yaml", "--method",
                                "ekf", "--out", folder_ / "run", "--no-report"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

}  // namespace
}  // namespace foucault::test
