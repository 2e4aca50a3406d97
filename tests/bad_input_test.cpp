#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>

#include "support/log_surgery.h"
#include "support/program.h"
#include "support/test_folder.h"

/// Bad input: one clear line on stderr, the right exit code, no output left, earlier output as it
/// was.
namespace foucault::test {
namespace {

namespace fs = std::filesystem;
using mrpt::obs::CObservationGPS;
using mrpt::obs::CObservationIMU;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr int kBadData = 1;
constexpr int kBadUsage = 2;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

class BadInput : public testing::Test {
 protected:
  BadInput() {
    log_ = folder_ / "trip.rawlog";
    bad_ = folder_ / "bad.rawlog";
    const Outcome made =
        foucault({"simulate", "--duration", "120", "--seed", "7", "--set", "scenario.rest_s=15",
                  "--set", "scenario.imu_rate_hz=100", "--out", log_});
    EXPECT_EQ(made.exit_code, 0) << made.err;
  }

  /// Runs `arguments` with --out and expects it to fail cleanly, for a reason named `reason`.
  template <class Matcher>
  void expect_failure(std::vector<std::string> arguments, int exit_code, Matcher reason) const {
    arguments.insert(arguments.end(), {"--out", folder_ / "out"});
    const std::size_t before = folder_.entries();
    const Outcome outcome = foucault(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_THAT(outcome.err, StartsWith("foucault: error: "));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, reason);
    EXPECT_EQ(folder_.entries(), before) << "something was left behind";
  }

  template <class Matcher>
  void expect_bad_log(Matcher reason) const {
    expect_failure({"run", bad_}, kBadData, AllOf(HasSubstr("bad.rawlog"), reason));
  }

  TestFolder folder_;
  std::string log_;
  std::string bad_;
};

TEST_F(BadInput, MissingFile) {
  expect_failure({"run", folder_ / "none.rawlog"}, kBadData, HasSubstr("none.rawlog"));
  EXPECT_EQ(foucault({"info", folder_ / "none.rawlog"}).exit_code, kBadData);
  EXPECT_EQ(foucault({"report", folder_ / "none"}).exit_code, kBadData);
}

TEST_F(BadInput, NotARawlog) {
  folder_.write("bad.rawlog", "t,x,y\n1,2,3\n");
  expect_bad_log(HasSubstr("rawlog"));
  EXPECT_EQ(foucault({"info", bad_}).exit_code, kBadData);
}

TEST_F(BadInput, Empty) {
  folder_.write("bad.rawlog", "");
  expect_bad_log(HasSubstr("empty"));
}

TEST_F(BadInput, ADirectory) {
  fs::create_directory(bad_);
  expect_bad_log(HasSubstr("directory"));
}

/// What was recorded before the damage is processed and written whole; the exit code tells.
TEST_F(BadInput, Truncated) {
  fs::copy_file(log_, bad_);
  fs::resize_file(bad_, fs::file_size(log_) * 2 / 3);
  const Outcome info = foucault({"info", bad_});
  EXPECT_EQ(info.exit_code, kBadData);
  EXPECT_THAT(info.out, HasSubstr("CObservationIMU"));

  const Outcome run = foucault(
      {"run", bad_, "--method", "ekf", "--set", "calibrate.mode=none", "--out", folder_ / "out"});
  EXPECT_EQ(run.exit_code, kBadData);
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_THAT(run.err, AllOf(HasSubstr("bad.rawlog' is truncated: it ends at byte"),
                             HasSubstr("of what came before")));
  EXPECT_TRUE(fs::exists(folder_ / "out/report/index.html"));
  EXPECT_THAT(folder_.text("out/metrics.json"), HasSubstr("is truncated"));
  const Outcome whole = foucault(
      {"run", log_, "--method", "ekf", "--set", "calibrate.mode=none", "--out", folder_ / "whole"});
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  const std::string cut_track = folder_.text("out/solution.tum");
  EXPECT_GT(cut_track.size(), 1000U);
  EXPECT_EQ(folder_.text("whole/solution.tum").substr(0, cut_track.size()), cut_track);
}

TEST_F(BadInput, TruncatedInAComparison) {
  fs::copy_file(log_, bad_);
  fs::resize_file(bad_, fs::file_size(log_) * 9 / 10);
  const Outcome evaluation =
      foucault({"evaluate", bad_, "--methods", "ekf", "--set", "outages.first_s=60", "--set",
                "outages.length_s=10", "--set", "outages.shifts_s=[0]", "--no-report", "--out",
                folder_ / "out"});
  EXPECT_EQ(evaluation.exit_code, kBadData);
  EXPECT_THAT(evaluation.err, AllOf(HasSubstr("bad.rawlog' is truncated: it ends at byte"),
                                    HasSubstr("of what is there")));
  EXPECT_TRUE(fs::exists(folder_ / "out/drift.csv"));
}

TEST_F(BadInput, NoImu) {
  operate_on_log(log_, bad_, on_imu([](CObservationIMU&) { return false; }));
  expect_bad_log(HasSubstr("IMU"));
}

TEST_F(BadInput, NoGnss) {
  operate_on_log(log_, bad_, on_gnss([](CObservationGPS&) { return false; }));
  expect_bad_log(HasSubstr("GNSS"));
}

TEST_F(BadInput, EverySigmaZeroOrNaN) {
  for (const float sigma : {0.0F, kNaN}) {
    operate_on_log(log_, bad_, on_gnss([sigma](CObservationGPS& gps) {
                     set_sigma(gps, sigma);
                     return true;
                   }));
    expect_bad_log(AnyOf(HasSubstr("sigma"), HasSubstr("finite")));
  }
}

TEST_F(BadInput, AZeroSigmaHereAndThereIsLeftOutWithAWarning) {
  int count = 0;
  operate_on_log(log_, bad_, on_gnss([&count](CObservationGPS& gps) {
                   if (++count % 20 == 0) set_sigma(gps, 0.0F);
                   return true;
                 }));
  const Outcome run = foucault({"run", bad_, "--no-report", "--out", folder_ / "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, AllOf(StartsWith("foucault: warning: "), HasSubstr("sigma")));
}

TEST_F(BadInput, ASampleHereAndThereThatIsNotUsable) {
  int count = 0;
  operate_on_log(log_, bad_, on_imu([&count](CObservationIMU& imu) {
                   ++count;
                   if (count == 5000) imu.timestamp -= std::chrono::milliseconds(500);
                   if (count == 6000) imu.set(mrpt::obs::IMU_WZ, kNaN);
                   return true;
                 }));
  const Outcome run = foucault({"run", bad_, "--no-report", "--out", folder_ / "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, AllOf(HasSubstr("1 x CObservationIMU (stamp comes twice)"),
                             HasSubstr("1 x CObservationIMU (not finite)")));
  EXPECT_THAT(foucault({"info", bad_}).out, HasSubstr("1 IMU samples are not finite"));
}

TEST_F(BadInput, NeverMoves) {
  const Outcome made =
      foucault({"simulate", "--set", "scenario.name=static", "--duration", "60", "--out", bad_});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  expect_failure({"run", bad_}, kBadData, HasSubstr("heading"));
}

TEST_F(BadInput, WrongUsage) {
  expect_failure({"run"}, kBadUsage, HasSubstr("LOG"));
  expect_failure({"run", log_, "--method", "kalman"}, kBadUsage,
                 AllOf(HasSubstr("kalman"), HasSubstr("refined")));
  expect_failure({"run", log_, "--method", "kal\nman\x1b[2J"}, kBadUsage,
                 AllOf(HasSubstr("'kal man [2J'"), Not(HasSubstr("\x1b"))));
  expect_failure({"run", log_, "--set", "imu.preset=unknown"}, kBadUsage, HasSubstr("ADIS16465"));
  expect_failure({"run", log_, "--set", "fgo.windows_s=3"}, kBadUsage, HasSubstr("fgo.window_s"));
  expect_failure({"run", log_, "--set", "fgo.window_s"}, kBadUsage, HasSubstr("fgo.window_s"));
  expect_failure({"run", log_, "--set", "imu.bias_tau_s=0"}, kBadUsage, HasSubstr("bias_tau_s"));
  expect_failure({"run", log_, "--set", "imu.bias_tau_s=nan"}, kBadUsage, HasSubstr("bias_tau_s"));
  expect_failure({"run", log_, "--unknown"}, kBadUsage, HasSubstr("--unknown"));
  expect_failure({"simulate", "--imu", "unknown"}, kBadUsage, HasSubstr("ADIS16465"));
  expect_failure({"simulate", "--set", "scenario.name=moon"}, kBadUsage, HasSubstr("city"));
  expect_failure({"simulate", "--duration", "-5"}, kBadUsage, HasSubstr("duration_s"));
  EXPECT_EQ(foucault({"run", log_}).exit_code, kBadUsage);
  EXPECT_EQ(foucault({}).exit_code, kBadUsage);
  EXPECT_THAT(foucault({"runn"}).err, AllOf(HasSubstr("runn"), HasSubstr("simulate")));
}

TEST_F(BadInput, WrongConfiguration) {
  folder_.write("bad.yaml", "fgo:\n  window_s: 20\n  windows: 3\n");
  expect_failure({"run", log_, "--config", folder_ / "bad.yaml"}, kBadUsage,
                 AllOf(HasSubstr("bad.yaml"), HasSubstr("windows"), HasSubstr("3")));
  folder_.write("broken.yaml", "fgo: [1, 2\n");
  expect_failure({"run", log_, "--config", folder_ / "broken.yaml"}, kBadUsage,
                 HasSubstr("broken.yaml"));
  expect_failure({"run", log_, "--config", folder_ / "none.yaml"}, kBadData,
                 HasSubstr("none.yaml"));
  for (const char* command : {"run", "tune"}) {
    expect_failure({command, log_, "--config", folder_ / "."}, kBadData,
                   HasSubstr("is a directory"));
  }
}

TEST_F(BadInput, EarlierResultsOutliveARunThatFails) {
  ASSERT_EQ(foucault({"run", log_, "--method", "ekf", "--out", folder_ / "out"}).exit_code, 0);
  const std::string solution = folder_.text("out/solution.csv");
  int count = 0;
  operate_on_log(log_, bad_, on_imu([&count](CObservationIMU& imu) {
                   if (++count > 6000) imu.timestamp -= std::chrono::seconds(30);
                   return true;
                 }));
  expect_bad_log(HasSubstr("sort the log"));  // in the middle of the run
  EXPECT_EQ(folder_.text("out/solution.csv"), solution);
  const fs::directory_iterator begin(folder_.path() / "out");
  EXPECT_EQ(std::distance(begin, fs::directory_iterator{}), 7);  // four, metrics, config, report
}

TEST_F(BadInput, OutputThatCannotBeWritten) {
  folder_.write("file", "");
  for (const std::string out : {"file", "file/run"}) {
    const Outcome run = foucault({"run", log_, "--out", folder_ / out});
    EXPECT_EQ(run.exit_code, kBadData);
    EXPECT_THAT(run.err, AllOf(StartsWith("foucault: error: "), HasSubstr("file")));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
  const Outcome simulate =
      foucault({"simulate", "--duration", "60", "--out", folder_ / "file/trip.rawlog"});
  EXPECT_EQ(simulate.exit_code, kBadData) << simulate.err;
}

class BadImport : public BadInput {
 protected:
  BadImport() {
    for (int i = 0; i <= 1000; ++i) imu_ += row(i, "0 0 0 0 0 -0.0981");
    for (int i = 0; i <= 10; ++i) gnss_ += fix(i, "0.01");
  }

  static std::string row(int hundredths, const std::string& values) {
    return std::to_string(1000 + 0.01 * hundredths) + " " + values + "\n";
  }
  static std::string fix(int second, const std::string& sigma) {
    return std::to_string(1000 + second) + " 30.0 114.0 20.0 0.01 " + sigma + " 0.02\n";
  }

  template <class Matcher>
  void expect_bad_import(Matcher reason) const {
    folder_.write("imu.txt", imu_);
    folder_.write("gnss.pos", gnss_);
    expect_failure({"import", "i2nav", "--imu", folder_ / "imu.txt", "--gnss", folder_ / "gnss.pos",
                    "--gps-week", "2200", "--lever-arm", "0,0,0"},
                   kBadData, reason);
  }

  std::string imu_;
  std::string gnss_;
};

TEST_F(BadImport, SigmaZeroOrNaN) {
  const std::string good = gnss_;
  for (const std::string sigma : {"0", "nan", "-0.01"}) {
    gnss_ = good + fix(11, sigma);
    expect_bad_import(HasSubstr("gnss.pos:12"));
  }
}

TEST_F(BadImport, StampsThatGoBack) {
  imu_ += row(500, "0 0 0 0 0 -0.0981");
  expect_bad_import(HasSubstr("imu.txt:1002"));
}

TEST_F(BadImport, TooFewColumns) {
  imu_ += row(1001, "0 0 0");
  expect_bad_import(HasSubstr("imu.txt:1002"));
}

TEST_F(BadImport, NotANumber) {
  gnss_ += fix(11, "one");
  expect_bad_import(HasSubstr("gnss.pos:12"));
}

TEST_F(BadImport, MissingFile) {
  expect_failure({"import", "i2nav", "--imu", folder_ / "none.txt", "--gnss", log_, "--gps-week",
                  "2200", "--lever-arm", "0,0,0"},
                 kBadData, HasSubstr("none.txt"));
  expect_failure({"import", "csv", "--mapping", folder_ / "none.yaml"}, kBadData,
                 HasSubstr("none.yaml"));
}

TEST_F(BadImport, WrongLeverArm) {
  expect_failure({"import", "i2nav", "--imu", log_, "--gnss", log_, "--gps-week", "2200",
                  "--lever-arm", "1,2"},
                 kBadUsage, HasSubstr("--lever-arm"));
}

}  // namespace
}  // namespace foucault::test
