#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <string>

#include "support/program.h"
#include "support/test_folder.h"

/// Disks that are full, folders that vanish, signals: what was there before stays as it was, and
/// nothing half made carries a final name.
namespace foucault::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr int kBadData = 1;
constexpr int kBadUsage = 2;

/// Path and contents of everything below a folder; folders have none.
std::map<std::string, std::string> contents(const TestFolder& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
    const std::string name = fs::relative(entry.path(), folder.path()).string();
    files[name] = entry.is_regular_file() ? folder.text(name) : "";
  }
  return files;
}

/// Also what somebody is filling meanwhile.
void remove_for_good(const fs::path& folder) {
  std::error_code busy;
  for (int i = 0; i < 100 && fs::exists(folder); ++i) fs::remove_all(folder, busy);
}

void expect_one_line_error(const Outcome& outcome) {
  EXPECT_THAT(outcome.err, StartsWith("foucault: error: "));
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

/// Recordings for all tests: one of two minutes, one that takes about a second to process.
class FileFaults : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    logs_ = std::make_unique<TestFolder>();
    for (const char* duration : {"120", "600"}) {
      const Outcome made =
          foucault({"simulate", "--duration", duration, "--seed", "7", "--set",
                    "scenario.rest_s=15", "--out", *logs_ / (std::string(duration) + ".rawlog")});
      ASSERT_EQ(made.exit_code, 0) << made.err;
    }
  }
  static void TearDownTestSuite() { logs_.reset(); }

  static std::vector<std::string> run(const std::string& out, const char* duration = "120") {
    return {"run", *logs_ / (std::string(duration) + ".rawlog"), "--method", "ekf", "--out", out};
  }
  static std::vector<std::string> simulate(const std::string& out, const char* duration) {
    return {"simulate", "--duration", duration, "--out", out};
  }

  void keep_as_earlier() { earlier_ = contents(folder_); }
  void expect_earlier() const { EXPECT_EQ(contents(folder_), earlier_); }
  std::function<bool()> something_is_written() const {
    return [this] { return contents(folder_) != earlier_; };
  }

  static std::unique_ptr<TestFolder> logs_;
  TestFolder folder_;
  std::map<std::string, std::string> earlier_;
};

std::unique_ptr<TestFolder> FileFaults::logs_;

// ---- signals

struct Stop {
  int signal;
  int exit_code;
  const char* error;
};

const std::vector<Stop> kStops{{SIGINT, 130, "foucault: error: interrupted\n"},
                               {SIGTERM, 143, "foucault: error: terminated\n"},
                               {SIGHUP, 129, "foucault: error: the terminal has gone\n"}};

/// Two hours take the simulator much longer than it takes to send a signal.
TEST_F(FileFaults, AStoppedSimulationLeavesTheEarlierOne) {
  folder_.write("trip.rawlog", "earlier");
  keep_as_earlier();
  for (const Stop& stop : kStops) {
    const Outcome stopped = foucault_interrupted(simulate(folder_ / "trip.rawlog", "7200"),
                                                 something_is_written(), stop.signal);
    EXPECT_EQ(stopped.exit_code, stop.exit_code);
    EXPECT_EQ(stopped.err, stop.error);
    expect_earlier();
  }
}

TEST_F(FileFaults, AStoppedRunLeavesTheEarlierOne) {
  ASSERT_EQ(foucault(run(folder_ / "out")).exit_code, 0);
  keep_as_earlier();
  for (const Stop& stop : kStops) {
    const Outcome stopped =
        foucault_interrupted(run(folder_ / "out", "600"), something_is_written(), stop.signal);
    EXPECT_EQ(stopped.exit_code, stop.exit_code);
    EXPECT_THAT(stopped.err, testing::EndsWith(stop.error));
    expect_earlier();
  }
}

/// What is left of a process that was killed is hidden, and the next one clears it away.
TEST_F(FileFaults, AKilledRunIsClearedAwayByTheNext) {
  for (const char* earlier : {"", "out"}) {  // a new folder, and one with results
    const bool is_new = std::string(earlier).empty();
    keep_as_earlier();
    const Outcome killed =
        foucault_interrupted(run(folder_ / "out", "600"), something_is_written(), SIGKILL);
    EXPECT_EQ(killed.exit_code, -1);
    for (const auto& [name, text] : contents(folder_)) {
      const bool hidden = name.front() == '.' || name.find("/.") != std::string::npos;
      EXPECT_TRUE(hidden || earlier_.count(name) > 0) << name;
      if (earlier_.count(name) > 0) {
        EXPECT_EQ(text, earlier_[name]) << name;
      }
    }
    EXPECT_NE(contents(folder_), earlier_) << "killed too late";

    ASSERT_EQ(foucault(run(folder_ / "out")).exit_code, 0);
    EXPECT_EQ(folder_.entries(), 1u) << is_new;
    for (const auto& [name, text] : contents(folder_)) EXPECT_THAT(name, Not(HasSubstr("/.")));
  }
}

TEST_F(FileFaults, AKilledSimulationIsClearedAwayByTheNext) {
  keep_as_earlier();
  foucault_interrupted(simulate(folder_ / "trip.rawlog", "7200"), something_is_written(), SIGKILL);
  EXPECT_EQ(folder_.entries(), 1u);
  EXPECT_FALSE(fs::exists(folder_ / "trip.rawlog"));
  ASSERT_EQ(foucault(simulate(folder_ / "trip.rawlog", "90")).exit_code, 0);
  EXPECT_EQ(folder_.entries(), 1u);
  EXPECT_EQ(foucault({"info", folder_ / "trip.rawlog"}).exit_code, 0);
}

TEST_F(FileFaults, AReportThatIsDrawnAgain) {
  ASSERT_EQ(foucault(run(folder_ / "out")).exit_code, 0);
  keep_as_earlier();
  for (const Stop& stop : kStops) {
    const Outcome stopped =
        foucault_interrupted({"report", folder_ / "out"}, something_is_written(), stop.signal);
    EXPECT_EQ(stopped.exit_code, stop.exit_code);
    EXPECT_EQ(stopped.err, stop.error);
    expect_earlier();
  }
  foucault_interrupted({"report", folder_ / "out"}, something_is_written(), SIGKILL);
  EXPECT_EQ(foucault_after("ulimit -f 60", {"report", folder_ / "out"}).exit_code, kBadData);
  expect_earlier();
  EXPECT_EQ(foucault({"report", folder_ / "out/report"}).exit_code, 0);
  expect_earlier();  // the same bytes
}

// ---- several at once

TEST_F(FileFaults, TwoSimulationsOfOneName) {
  Outcome second;
  const Outcome first = foucault_disturbed(
      simulate(folder_ / "trip.rawlog", "7200"), something_is_written(), [&](pid_t pid) {
        second = foucault(simulate(folder_ / "trip.rawlog", "90"));
        kill(pid, SIGINT);
      });
  EXPECT_EQ(first.exit_code, 130);
  EXPECT_EQ(second.exit_code, kBadData);
  expect_one_line_error(second);
  EXPECT_THAT(second.err, HasSubstr("another process is writing it"));
  EXPECT_EQ(folder_.entries(), 0u);
}

/// Both results are whole; those of the one that ends last stay.
TEST_F(FileFaults, TwoRunsIntoOneFolder) {
  Outcome second;
  const Outcome first = foucault_disturbed(run(folder_ / "out", "600"), something_is_written(),
                                           [&](pid_t) { second = foucault(run(folder_ / "out")); });
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(folder_.entries(), 1u);
  const std::string metrics = folder_.text("out/metrics.json");
  const std::string of = metrics.find("600.rawlog") != std::string::npos ? "600" : "120";
  ASSERT_EQ(foucault(run(folder_ / "alone", of.c_str())).exit_code, 0);
  EXPECT_EQ(folder_.text("out/solution.csv"), folder_.text("alone/solution.csv"));
  EXPECT_EQ(contents(folder_).count("out/report/index.html"), 1u);
}

// ---- full disks; a limit of the size of files (in blocks of 512 bytes) stands for one

TEST_F(FileFaults, NoRoomForASolution) {
  ASSERT_EQ(foucault(run(folder_ / "out")).exit_code, 0);
  keep_as_earlier();
  for (const char* limit : {"ulimit -f 4", "ulimit -f 60", "ulimit -f 200"}) {
    const Outcome full = foucault_after(limit, run(folder_ / "out"));
    EXPECT_EQ(full.exit_code, kBadData) << limit;
    EXPECT_THAT(full.err, AllOf(HasSubstr("foucault: error: "), HasSubstr("File too large")));
    EXPECT_THAT(full.err, Not(HasSubstr("120.rawlog'")));  // is not to blame
    expect_earlier();
  }
}

TEST_F(FileFaults, NoRoomForARecording) {
  folder_.write("trip.rawlog", "earlier");
  keep_as_earlier();
  for (const char* duration : {"90", "600"}) {
    const Outcome full =
        foucault_after("ulimit -f 100", simulate(folder_ / "trip.rawlog", duration));
    EXPECT_EQ(full.exit_code, kBadData);
    expect_one_line_error(full);
    EXPECT_THAT(full.err,
                AllOf(HasSubstr("trip.rawlog' cannot be written"), HasSubstr("File too large")));
    expect_earlier();
  }
}

TEST_F(FileFaults, NoRoomForWhatIsSaid) {
  const Outcome info = foucault_after("exec > /dev/full", {"info", *logs_ / "120.rawlog"});
  EXPECT_EQ(info.exit_code, kBadData);
  expect_one_line_error(info);
  EXPECT_THAT(info.err, HasSubstr("No space left on device"));
  // Results are more than words.
  const Outcome full = foucault_after("exec > /dev/full", run(folder_ / "out"));
  EXPECT_EQ(full.exit_code, kBadData);
  EXPECT_TRUE(fs::exists(folder_ / "out/report/index.html"));
}

/// As in `foucault info trip.rawlog | head -1`.
TEST_F(FileFaults, NobodyReadsWhatIsSaid) {
  const Outcome silent =
      foucault_after("mkfifo \"" + (folder_ / "pipe") + "\"; : < \"" + (folder_ / "pipe") +
                         "\" & exec > \"" + (folder_ / "pipe") + "\"; wait",
                     run(folder_ / "out"));
  EXPECT_EQ(silent.exit_code, 141);
  EXPECT_THAT(silent.err, Not(HasSubstr("error")));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_EQ(folder_.entries(), 1u);
}

// ---- folders

TEST_F(FileFaults, AFolderThatVanishes) {
  fs::create_directories(folder_ / "deep/out");
  for (const char* gone : {"deep/out", "deep"}) {
    keep_as_earlier();
    const Outcome run =
        foucault_disturbed(FileFaults::run(folder_ / "deep/out", "600"), something_is_written(),
                           [&](pid_t) { remove_for_good(folder_ / gone); });
    EXPECT_EQ(run.exit_code, kBadData) << gone;
    EXPECT_THAT(run.err, AllOf(HasSubstr("foucault: error: "), HasSubstr("/deep/")));
    EXPECT_FALSE(fs::exists(folder_ / "deep/out/metrics.json"));
  }
}

/// Not even root can make a folder in /proc.
TEST_F(FileFaults, AFolderThatCannotBeMade) {
  if (!fs::exists("/proc/self")) GTEST_SKIP() << "/proc is not mounted";
  for (const auto& arguments :
       {run("/proc/foucault"), run("/proc/foucault/out"), simulate("/proc/trip.rawlog", "7200")}) {
    const Outcome refused = foucault(arguments);
    EXPECT_EQ(refused.exit_code, kBadData);
    expect_one_line_error(refused);
    EXPECT_THAT(refused.err, HasSubstr("/proc/"));
  }
}

TEST_F(FileFaults, FoldersMadeOnTheWayAreTakenAway) {
  folder_.write("empty.rawlog", "");
  keep_as_earlier();
  EXPECT_EQ(foucault({"run", folder_ / "empty.rawlog", "--out", folder_ / "a/b/c"}).exit_code,
            kBadData);
  expect_earlier();
}

// ---- what must not be written over

TEST_F(FileFaults, AnInputAsOutput) {
  std::string imu;
  for (int i = 0; i <= 1000; ++i) imu += std::to_string(1000 + 0.01 * i) + " 0 0 0 0 0 -0.0981\n";
  folder_.write("imu.txt", imu);
  std::string gnss;
  for (int i = 0; i <= 10; ++i) gnss += std::to_string(1000 + i) + " 30 114 20 0.01 0.01 0.02\n";
  folder_.write("gnss.pos", gnss);
  keep_as_earlier();
  for (const char* input : {"imu.txt", "gnss.pos", "../"}) {
    const std::string out = folder_ / input;
    const Outcome import =
        foucault({"import", "i2nav", "--imu", folder_ / "imu.txt", "--gnss", folder_ / "gnss.pos",
                  "--gps-week", "2200", "--lever-arm", "0,0,0", "--out", out});
    EXPECT_EQ(import.exit_code, fs::is_directory(out) ? kBadData : kBadUsage) << import.err;
    expect_one_line_error(import);
    expect_earlier();
  }
}

TEST_F(FileFaults, ALinkStaysALink) {
  folder_.write("real.rawlog", "earlier");
  fs::create_symlink("real.rawlog", folder_ / "trip.rawlog");
  ASSERT_EQ(foucault(simulate(folder_ / "trip.rawlog", "90")).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "trip.rawlog"));
  EXPECT_EQ(foucault({"info", folder_ / "real.rawlog"}).exit_code, 0);
}

TEST_F(FileFaults, ADeviceOrAPipeStaysOne) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  const Outcome refused = foucault(simulate(folder_ / "pipe", "90"));
  EXPECT_EQ(refused.exit_code, kBadData);
  expect_one_line_error(refused);
  EXPECT_TRUE(fs::is_fifo(folder_ / "pipe"));
}

/// Too short to be processed: the damage is named, not only what is missing because of it.
TEST_F(FileFaults, DamageBeforeTheStart) {
  fs::copy_file(*logs_ / "120.rawlog", folder_ / "cut.rawlog");
  fs::resize_file(folder_ / "cut.rawlog", 4000);
  const Outcome cut = foucault({"run", folder_ / "cut.rawlog", "--out", folder_ / "out"});
  EXPECT_EQ(cut.exit_code, kBadData);
  expect_one_line_error(cut);
  EXPECT_THAT(cut.err, HasSubstr("cut.rawlog' is truncated: it ends at byte "));
}

}  // namespace
}  // namespace foucault::test
