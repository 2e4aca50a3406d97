#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"
#include "support/table.h"
#include "support/test_folder.h"

/// Every subcommand of the built program on a small simulated recording.
namespace foucault::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

class Trip : public testing::Test {
 protected:
  Trip() {
    log_ = folder_ / "trip.rawlog";
    const Outcome made =
        foucault({"simulate", "--imu", "ADIS16465", "--duration", "150", "--seed", "7", "--set",
                  "scenario.rest_s=15", "--set", "scenario.imu_rate_hz=100", "--out", log_});
    EXPECT_EQ(made.exit_code, 0) << made.err;
  }

  json metrics(const std::string& run) const {
    return json::parse(folder_.text(run + "/metrics.json"));
  }

  TestFolder folder_;
  std::string log_;
};

TEST(Help, NamesEveryCommandAndTeaches) {
  const Outcome help = foucault({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* command : {"demo", "simulate", "import", "info", "run", "report"}) {
    EXPECT_THAT(help.out, HasSubstr(command));
    const Outcome own = foucault({command, "--help"});
    EXPECT_EQ(own.exit_code, 0) << command;
    EXPECT_THAT(own.out, HasSubstr("--help")) << command;
  }
  EXPECT_THAT(foucault({"run", "--help-config"}).out, HasSubstr("fgo.window_s"));
  EXPECT_THAT(foucault({"simulate", "--help-config"}).out, HasSubstr("scenario.duration_s"));
  EXPECT_THAT(foucault({"import", "csv", "--help-mapping"}).out, HasSubstr("lever_arm_m"));
  EXPECT_THAT(foucault({"--version"}).out, StartsWith("foucault "));
}

TEST_F(Trip, TheSameSeedGivesTheSameRecording) {
  const std::string again = folder_ / "again.rawlog";
  const std::string other = folder_ / "other.rawlog";
  for (const auto& [seed, path] : {std::pair{"7", again}, std::pair{"8", other}}) {
    ASSERT_EQ(foucault({"simulate", "--duration", "150", "--seed", seed, "--set",
                        "scenario.rest_s=15", "--set", "scenario.imu_rate_hz=100", "--out", path})
                  .exit_code,
              0);
  }
  EXPECT_EQ(folder_.text("trip.rawlog"), folder_.text("again.rawlog"));
  EXPECT_NE(folder_.text("trip.rawlog"), folder_.text("other.rawlog"));
}

TEST_F(Trip, InfoTellsWhatIsInIt) {
  const Outcome text = foucault({"info", log_});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("CObservationIMU"));

  const Outcome answer = foucault({"info", log_, "--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const json info = json::parse(answer.out);
  ASSERT_EQ(info["gnss"].size(), 1u);
  bool imu_seen = false;
  for (const json& stream : info["streams"]) {
    if (stream["type"] != "CObservationIMU") continue;
    imu_seen = true;
    EXPECT_NEAR(stream["rate_hz"], 100, 1);
    EXPECT_NEAR(stream["duration_s"], 150, 0.01);
    EXPECT_EQ(stream["backward"], 0);
  }
  EXPECT_TRUE(imu_seen);
}

TEST_F(Trip, CheckJudgesInWordsAsJsonAndByItsExitCode) {
  const Outcome text = foucault({"check", log_});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("lever arm"));
  const json judged = json::parse(foucault({"check", "--json", "-i", log_}).out);
  EXPECT_TRUE(judged["ok"].get<bool>());
  ASSERT_GT(judged["findings"].size(), 5u);
  for (const json& finding : judged["findings"]) {
    EXPECT_THAT(text.out, HasSubstr(finding["text"].get<std::string>()));
  }
  EXPECT_EQ(foucault({"check", "-q", log_}).out, "");
}

TEST_F(Trip, ProfileTellsWhereTheTimeWent) {
  const Outcome run =
      foucault({"run", log_, "--method", "ekf", "--profile", "--out", folder_ / "profiled"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("mechanize"));
  const json profile = metrics("profiled")["profile"];
  double sum = 0;
  for (const auto& [stage, seconds] : profile.items()) {
    if (stage != "total_s") sum += seconds.get<double>();
  }
  EXPECT_NEAR(sum, profile["total_s"], 1e-9);
  for (const char* stage :
       {"start_s", "survey_s", "read_s", "mechanize_s", "covariance_s", "draw_s"}) {
    EXPECT_GT(profile[stage], 0) << stage;
  }
  EXPECT_FALSE(profile.contains("solve_s"));  // a filter has none
}

TEST_F(Trip, RunWritesSolutionMetricsAndReport) {
  const std::string out = folder_ / "run";
  // Without lever arm and clocks, which would be known to 5 cm and 2 ms.
  const Outcome run = foucault({"run", log_, "--set", "calibrate.mode=none", "--out", out});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());  // no warning, and no progress bar in a pipe
  EXPECT_THAT(run.out, HasSubstr("report/index.html"));

  const Table solution(out + "/solution.csv");
  const std::vector<std::string> first{"t_unix_s",    "lat_deg",    "lon_deg",    "height_m",
                                       "v_north_m_s", "v_east_m_s", "v_down_m_s", "roll_deg",
                                       "pitch_deg",   "heading_deg"};
  ASSERT_GE(solution.names().size(), first.size());
  EXPECT_TRUE(std::equal(first.begin(), first.end(), solution.names().begin()));
  EXPECT_EQ(folder_.lines("run/solution.tum").size(), solution.rows());
  EXPECT_THAT(folder_.text("run/solution.kml"), HasSubstr("</kml>"));
  EXPECT_THAT(folder_.text("run/report/index.html"), HasSubstr("<html"));
  EXPECT_THAT(folder_.text("run/report/index.html"), HasSubstr("<b>This run is trustworthy</b>"));
  EXPECT_THAT(last_line(run.out), StartsWith("verdict    trustworthy"));

  const json m = metrics("run");
  EXPECT_EQ(m["method"], "batch") << "the best there is";
  EXPECT_EQ(m["epochs"], solution.rows());
  EXPECT_NEAR(m["duration_s"], 150, 20);
  EXPECT_EQ(m["trustworthy"], true);
  EXPECT_EQ(m["reasons"], json::array());
  EXPECT_GT(m["gnss"]["used"], 100);
  EXPECT_EQ(m["gnss"]["rejected"], 0);
  for (const char* axis : {"north", "east", "down"}) {
    EXPECT_GT(m["gnss"]["innovation_rms_m"][axis], m["gnss"]["postfit_rms_m"][axis]) << axis;
  }
  // The sigmas of the fixes are 1, 1 and 2 cm; a filter is no worse than its measurements.
  EXPECT_LT(m["reference"]["horizontal_rmse_m"], 0.02);
  EXPECT_LT(m["reference"]["vertical_rmse_m"], 0.02);
  // Heading is found from 1 Hz fixes of 1 cm over a few hundred metres.
  EXPECT_LT(m["reference"]["heading_rmse_deg"], 0.5);
  for (const char* key : {"roll_rmse_deg", "pitch_rmse_deg"}) EXPECT_LT(m["reference"][key], 0.2);
  for (const char* key : {"cpu_s", "wall_s", "peak_rss_mb"}) EXPECT_GT(m[key], 0) << key;
}

TEST_F(Trip, EveryMethodRuns) {
  for (const std::string method : {"ekf", "refined", "rough", "full", "rts", "batch"}) {
    const std::string out = folder_ / method;
    // Without the lever arm, which would be known to 5 cm.
    const Outcome run = foucault({"run", log_, "--method", method, "--set", "calibrate.mode=none",
                                  "--no-report", "--out", out});
    ASSERT_EQ(run.exit_code, 0) << method << ": " << run.err;
    EXPECT_EQ(metrics(method)["method"], method);
    EXPECT_LT(metrics(method)["reference"]["horizontal_rmse_m"], 0.02) << method;
    EXPECT_FALSE(fs::exists(out + "/report"));
  }
}

/// The forward run beside the smoothed one is the one that `ekf` gives.
TEST_F(Trip, ASmootherTellsItsForwardRun) {
  for (const std::string method : {"batch", "rts", "ekf"}) {
    const Outcome run = foucault({"run", log_, "--method", method, "--set", "calibrate.mode=none",
                                  "--out", folder_ / method});
    ASSERT_EQ(run.exit_code, 0) << method << ": " << run.err;
    EXPECT_EQ(run.out.find("forward    ekf: RMS error") != std::string::npos, method != "ekf");
    EXPECT_EQ(fs::exists(folder_ / method + "/report/position_separation.png"), method != "ekf");
  }
  EXPECT_FALSE(metrics("ekf").contains("forward"));
  const json expected = metrics("ekf");
  for (const std::string method : {"batch", "rts"}) {
    const json m = metrics(method);
    const json& forward = m["forward"];
    EXPECT_EQ(forward["method"], "ekf");
    EXPECT_EQ(forward["epochs"], expected["epochs"]);
    for (const char* key : {"horizontal_rmse_m", "heading_rmse_deg", "velocity_nees"}) {
      const double value = expected["reference"][key];
      EXPECT_NEAR(forward["reference"][key], value, 1e-6 * value) << method << " " << key;
    }
    EXPECT_EQ(forward["consistency"]["nis"], m["consistency"]["nis"]);
    EXPECT_LT(m["reference"]["horizontal_rmse_m"], forward["reference"]["horizontal_rmse_m"]);
    EXPECT_GT(forward["separation"]["position_rms_m"]["north"], 1e-3);
    EXPECT_LT(forward["separation"]["position_rms_m"]["north"], 0.05);
  }
}

/// 150 fixes in parts of 106: what the first pass said, the second does not say again.
TEST_F(Trip, SmoothedInPartsItSaysEverythingOnce) {
  for (const std::string memory : {"1", "2000"}) {
    const Outcome run =
        foucault({"run", log_, "--set", "calibrate.mode=none", "--set", "batch.memory_mb=" + memory,
                  "--no-report", "--out", folder_ / memory});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.out.find("a second pass") != std::string::npos, memory == "1") << run.out;
    const std::size_t start = run.out.find("start      ");
    ASSERT_NE(start, std::string::npos);
    EXPECT_EQ(run.out.find("start      ", start + 1), std::string::npos) << run.out;
    EXPECT_EQ(run.err, "");
  }
  const double whole = metrics("2000")["reference"]["horizontal_rmse_m"];
  EXPECT_NEAR(metrics("1")["reference"]["horizontal_rmse_m"], whole, 0.01 * whole);
}

TEST_F(Trip, TheWrittenConfigurationGivesTheSameRunAgain) {
  ASSERT_EQ(foucault({"run", log_, "--set", "fgo.window_s=7", "--set", "imu.preset=ICM20602",
                      "--no-report", "--out", folder_ / "a"})
                .exit_code,
            0);
  ASSERT_EQ(foucault({"run", log_, "--config", folder_ / "a/config.yaml", "--no-report", "--out",
                      folder_ / "b"})
                .exit_code,
            0);
  EXPECT_EQ(folder_.text("a/config.yaml"), folder_.text("b/config.yaml"));
  EXPECT_EQ(folder_.text("a/solution.csv"), folder_.text("b/solution.csv"));
  ASSERT_EQ(foucault({"run", log_, "--no-report", "--out", folder_ / "c"}).exit_code, 0);
  EXPECT_NE(folder_.text("a/solution.csv"), folder_.text("c/solution.csv"));
}

/// An offset of 0.2 s that is none, told as known: the passes before the run take it back.
TEST_F(Trip, TimeOffsetAndLeverArmAreEstimates) {
  ASSERT_EQ(foucault({"run", log_, "--method", "full", "--set", "calibrate.time_offset=on", "--set",
                      "calibrate.lever_arm=on", "--set", "calibrate.time_offset_s=0.2",
                      "--no-report", "--out", folder_ / "a"})
                .exit_code,
            0);
  const json calibration = metrics("a")["calibration"];
  const json& offset = calibration["time_offset"];
  EXPECT_EQ(offset["unit"], "s");
  const double sigma = offset["sigma"][0];
  EXPECT_LT(sigma, 0.01);
  EXPECT_LT(std::abs(offset["value"][0].get<double>()), 5 * sigma);
  const double given[] = {0.1, -0.3, -0.8};  // the whole arm, along forward, right, down
  for (std::size_t i = 0; i < 3; ++i) {
    const json& arm = calibration["lever_arm"];
    EXPECT_LT(std::abs(arm["value"][i].get<double>() - given[i]),
              5 * arm["sigma"][i].get<double>());
  }
  EXPECT_LT(metrics("a")["reference"]["horizontal_rmse_m"], 0.1);
}

TEST_F(Trip, OutputAtImuRateHasARowForEverySample) {
  const std::string out = folder_ / "imu";
  ASSERT_EQ(foucault({"run", log_, "--set", "output.rate=imu", "--method", "ekf", "--no-report",
                      "--out", out})
                .exit_code,
            0);
  const std::vector<double> t = Table(out + "/solution.csv").column("t_unix_s");
  EXPECT_TRUE(std::is_sorted(t.begin(), t.end()));
  EXPECT_NEAR(static_cast<double>(t.size()), 100 * (t.back() - t.front()), 5);
}

TEST_F(Trip, StatisticsCanLeaveOutTheSettling) {
  ASSERT_EQ(foucault({"run", log_, "--no-report", "--out", folder_ / "all"}).exit_code, 0);
  ASSERT_EQ(foucault({"run", log_, "--set", "output.statistics_from_s=100", "--no-report", "--out",
                      folder_ / "late"})
                .exit_code,
            0);
  EXPECT_EQ(metrics("late")["epochs"], metrics("all")["epochs"]);
  EXPECT_NEAR(metrics("late")["gnss"]["samples"], 50, 2);
}

TEST_F(Trip, ReportDrawsTheSameBytesAgain) {
  ASSERT_EQ(foucault({"run", log_, "--method", "ekf", "--out", folder_ / "run"}).exit_code, 0);
  std::vector<std::pair<std::string, std::string>> before;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "run/report")) {
    const std::string name = "run/report/" + entry.path().filename().string();
    before.emplace_back(name, folder_.text(name));
  }
  ASSERT_GT(before.size(), 10u);
  fs::remove(folder_ / "run/report/index.html");
  for (const auto& [name, text] : before) {
    if (fs::path(name).extension() == ".png") fs::remove(folder_.path() / name);
  }
  const Outcome report = foucault({"report", folder_ / "run"});
  ASSERT_EQ(report.exit_code, 0) << report.err;
  for (const auto& [name, text] : before) EXPECT_EQ(folder_.text(name), text) << name;
}

TEST_F(Trip, RunAgainReplacesResultsAndLeavesWhatIsNotOurs) {
  ASSERT_EQ(foucault({"run", log_, "--method", "ekf", "--out", folder_ / "run"}).exit_code, 0);
  folder_.write("run/notes.txt", "mine");
  ASSERT_EQ(foucault({"run", log_, "--method", "rough", "--out", folder_ / "run"}).exit_code, 0);
  EXPECT_EQ(metrics("run")["method"], "rough");
  EXPECT_EQ(folder_.text("run/notes.txt"), "mine");
}

TEST_F(Trip, QuietSaysNothing) {
  const Outcome run = foucault(
      {"run", log_, "--quiet", "--no-report", "--method", "ekf", "--out", folder_ / "run"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_THAT(run.err, IsEmpty());
}

/// The sigmas of its fixes a tenth of what they are.
TEST_F(Trip, ARunThatCannotBeBelievedSaysSo) {
  const std::vector<std::string> call{"run",      log_,
                                      "--method", "ekf",
                                      "--set",    "gnss.sigma_scale=0.1",
                                      "--set",    "calibrate.noise=off"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), call.begin(), call.end());
    return foucault(more);
  };
  const Outcome run = with({"--out", folder_ / "run"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(last_line(run.out), StartsWith("verdict    NOT TRUSTWORTHY: innovations are"));
  const json m = metrics("run");
  EXPECT_EQ(m["trustworthy"], false);
  EXPECT_THAT(m["reasons"][0].get<std::string>(), HasSubstr("times as large as their sigmas"));
  EXPECT_THAT(folder_.text("run/report/index.html"), HasSubstr("class=\"banner alarming\""));

  const Outcome plain = with({"--no-report", "--out", folder_ / "plain"});
  EXPECT_EQ(last_line(plain.out), last_line(run.out));
  const Outcome quiet = with({"--quiet", "--no-report", "--out", folder_ / "quiet"});
  EXPECT_THAT(quiet.out, IsEmpty());
  EXPECT_THAT(quiet.err, HasSubstr("warning: not trustworthy: innovations are"));
}

/// Ten minutes: white noise to a few hundredths (the fits' own 2 % and one sigma more), and nothing
/// of biases that wander for an hour.
TEST(Allan, TellsWhatTheLengthShowsHoweverSamplesAreRead) {
  const TestFolder folder;
  const std::string log = folder / "bench.rawlog";
  ASSERT_EQ(foucault({"simulate", "--imu", "ADIS16465", "--duration", "600", "--seed", "3", "--set",
                      "scenario.name=static", "--set", "scenario.imu_rate_hz=50", "--set",
                      "scenario.reference_rate_hz=0", "--out", log})
                .exit_code,
            0);
  const Outcome outcome = foucault({"allan", log, "--out", folder / "noise"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("not told by this recording"));
  EXPECT_THAT(folder.text("noise/report/index.html"), HasSubstr("Allan deviation"));
  const json m = json::parse(folder.text("noise/metrics.json"));
  EXPECT_EQ(m["rests"], 1);
  EXPECT_NEAR(m["rest_s"].get<double>(), 600, 6);
  EXPECT_NEAR(m["gyroscope"]["all"]["arw_deg_sqrt_h"]["value"].get<double>(), 0.15, 0.05 * 0.15);
  EXPECT_NEAR(m["accelerometer"]["all"]["vrw_m_s_sqrt_h"]["value"].get<double>(), 0.012,
              0.05 * 0.012);
  EXPECT_TRUE(m["gyroscope"]["all"]["bias_instability_deg_h"].is_null());
  EXPECT_TRUE(m["gyroscope"]["all"]["gyro_bias_deg_h"].is_null());
  EXPECT_TRUE(m["accelerometer"]["vibration"]["at_rest"].empty());
  ASSERT_EQ(foucault({"allan", log, "--no-report", "--set", "imu.samples=instantaneous", "--out",
                      folder / "instantaneous"})
                .exit_code,
            0);
  EXPECT_EQ(folder.text("noise/allan.csv"), folder.text("instantaneous/allan.csv"));
}

TEST(Allan, ALogThatNeverRestsIsRefusedInOneLine) {
  const TestFolder folder;
  const std::string log = folder / "motorway.rawlog";
  ASSERT_EQ(foucault({"simulate", "--duration", "120", "--set", "scenario.name=motorway", "--set",
                      "scenario.skip_s=80", "--set", "scenario.imu_rate_hz=50", "--out", log})
                .exit_code,
            0);
  const Outcome outcome = foucault({"allan", log, "--out", folder / "noise"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("nowhere at rest"));
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_FALSE(fs::exists(folder / "noise"));
}

/// A line of 25 Hz that grows with the speed.
TEST(Allan, NamesWhatShakesInMotion) {
  const TestFolder folder;
  const std::string log = folder / "car.rawlog";
  ASSERT_EQ(foucault({"simulate", "--imu", "ADIS16465", "--duration", "200", "--set",
                      "scenario.vibration_hz=25.4", "--set", "scenario.vibration_m_s2=0.5", "--set",
                      "scenario.vibration_growth=1", "--out", log})
                .exit_code,
            0);
  const Outcome outcome = foucault({"allan", log, "--no-report", "--out", folder / "noise"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Accelerometer shakes in motion at 25.4"));
  const json m = json::parse(folder.text("noise/metrics.json"));
  EXPECT_NEAR(m["accelerometer"]["vibration"]["in_motion"][0]["frequency_hz"].get<double>(), 25.4,
              0.1);
}

/// Ten minutes of rest, and only these, have an Allan deviation beside what was learned.
TEST(Learn, ShowsTheAllanDeviationOfALongRest) {
  const TestFolder folder;
  for (const char* rest : {"60", "680"}) {
    const std::string log = folder / (std::string(rest) + ".rawlog");
    const std::string out = folder / (std::string(rest) + "-noise");
    ASSERT_EQ(foucault({"simulate", "--duration", "840", "--set", "scenario.imu_rate_hz=50",
                        "--set", std::string("scenario.rest_s=") + rest, "--out", log})
                  .exit_code,
              0);
    const Outcome outcome = foucault({"learn", log, "--out", out});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string page = folder.text(std::string(rest) + "-noise/report/index.html");
    EXPECT_EQ(page.find("allan_gyroscope") != std::string::npos, std::string(rest) == "680");
  }
}

TEST_F(Trip, ANoiseThatNobodyToldIsLearnedAndKept) {
  const Outcome outcome = foucault({"run", log_, "--method", "ekf", "--set", "imu.preset=auto",
                                    "--no-report", "--out", folder_ / "auto"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("nearest preset"));
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("as configured")));
  const std::string config = folder_.text("auto/config.yaml");
  EXPECT_THAT(config, testing::Not(HasSubstr("preset: auto")));
  const std::string key = "arw_deg_sqrt_h: ";
  const double learned = std::stod(config.substr(config.find(key) + key.size()));
  EXPECT_GT(learned, 0.15 / 3);  // a minute and a half of fixes: a factor of two is one sigma
  EXPECT_LT(learned, 0.15 * 3);
}

TEST(Auto, WhatIsTooShortToTellItsNoiseIsTakenAsCoarse) {
  const TestFolder folder;
  const std::string log = folder / "short.rawlog";
  ASSERT_EQ(foucault({"simulate", "--duration", "70", "--seed", "1", "--out", log}).exit_code, 0);
  const Outcome outcome = foucault({"run", log, "--method", "ekf", "--set", "imu.preset=auto",
                                    "--no-report", "--out", folder / "run"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("imu.preset=consumer instead of auto"));
  EXPECT_THAT(folder.text("run/config.yaml"), HasSubstr("consumer"));
}

TEST_F(Trip, AutoIsNoNoiseByItself) {
  const Outcome told = foucault({"run", log_, "--set", "imu.preset=auto", "--set",
                                 "imu.arw_deg_sqrt_h=0.1", "--out", folder_ / "run"});
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.err, HasSubstr("imu.arw_deg_sqrt_h"));
  const Outcome simulated =
      foucault({"simulate", "--imu", "auto", "--out", folder_ / "auto.rawlog"});
  EXPECT_EQ(simulated.exit_code, 2);
  EXPECT_THAT(simulated.err, HasSubstr("imu.preset"));
}

}  // namespace
}  // namespace foucault::test
