#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <regex>
#include <string>
#include <thread>

#include "support/program.h"
#include "support/results.h"
#include "support/test_folder.h"

/// `evaluate` and `tune` with their runs in a store: kills, workers, engines that start workers.
namespace foucault::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kOutages =
    "--set outages.first_s=60 --set outages.length_s=10 --set outages.period_s=20 "
    "--set outages.shifts_s=[0,10] --set calibrate.noise=off --jobs 1";

/// Inodes of the records in a store: a record that is written again has another one.
std::map<std::string, ino_t> records_in(const fs::path& store) {
  std::map<std::string, ino_t> records;
  if (!fs::exists(store)) return records;
  for (const auto& entry : fs::recursive_directory_iterator(store)) {
    struct stat there {};
    if (entry.path().extension() == ".tmp" || stat(entry.path().c_str(), &there) != 0) continue;
    if (S_ISREG(there.st_mode)) records[entry.path().filename()] = there.st_ino;
  }
  return records;
}

int sum_of(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  int sum = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) {
    sum += std::stoi((*it)[1]);
  }
  return sum;
}

int computed(const std::string& text) { return sum_of(text, "([0-9]+) runs computed"); }

/// Four logs. Commands run in a folder of their own, so that
/// all of them read the same.
class Store : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TestFolder;
    for (const char* seed : {"1", "2", "3", "4"}) {
      const Outcome made = foucault({"simulate", "--duration", "100", "--seed", seed, "--set",
                                     "scenario.rest_s=15", "--set", "scenario.imu_rate_hz=50",
                                     "--out", *folder_ / (std::string("log") + seed + ".rawlog")});
      ASSERT_EQ(made.exit_code, 0) << made.err;
    }
    folder_->write("grid.yaml",
                   "base:\n"
                   "  outages: {first_s: 60, length_s: 10, period_s: 20, shifts_s: [0]}\n"
                   "  aids: {mode: none}\n"
                   "  calibrate: {mode: none}\n"
                   "grid:\n"
                   "  imu.arw_deg_sqrt_h: {from: 0.02, to: 2, steps: 9, scale: log}\n"
                   "  imu.gyro_bias_deg_h: {from: 1, to: 100, steps: 9, scale: log}\n"
                   "method: ekf\n"
                   "search: coarse_to_fine\n");
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string evaluate(const std::string& methods = "ekf,rts") {
    return "\"$0\" evaluate ../log?.rawlog --methods " + methods + " --store store --out out " +
           kOutages;
  }
  static std::string tune() {
    return "\"$0\" tune ../log?.rawlog --config ../grid.yaml --store store --out out --jobs 1";
  }

  static std::string command(const std::string& which) {
    if (which == kSlow) return evaluate("ekf,refined");
    return which == "tune" ? tune() : evaluate();
  }
  static constexpr const char* kSlow = "evaluate-slow";  ///< 3 s instead of half a second

  /// Runs a script in a folder.
  static Outcome in(const std::string& name, const std::string& script) {
    fs::create_directories(*folder_ / name);
    return shell("cd '" + *folder_ / name + "' && " + script);
  }

  /// What the single process makes of it.
  static std::map<std::string, std::string> whole(const std::string& which) {
    const std::string name = "whole-" + which;
    if (!fs::exists(*folder_ / name)) {
      const Outcome made = in(name, command(which));
      EXPECT_EQ(made.exit_code, 0) << made.err;
    }
    return timeless_files(*folder_ / (name + "/out"));
  }

  static void expect_as_whole(const std::string& name, const std::string& which) {
    const auto expected = whole(which);
    const auto found = timeless_files(*folder_ / (name + "/out"));
    ASSERT_GT(expected.size(), 5u);
    for (const auto& [file, text] : expected) {
      ASSERT_TRUE(found.count(file)) << file;
      EXPECT_TRUE(found.at(file) == text) << file << " differs";
    }
    EXPECT_EQ(found.size(), expected.size());
  }

  /// The merge computes nothing, and equals the single process.
  static void expect_merge_as_whole(const std::string& name, const std::string& which) {
    const Outcome merged = in(name, command(which));
    EXPECT_EQ(merged.exit_code, 0) << merged.err;
    EXPECT_THAT(merged.out, HasSubstr("0 runs computed"));
    expect_as_whole(name, which);
  }

  static TestFolder* folder_;
};

TestFolder* Store::folder_ = nullptr;

bool has_programs(const std::string& names) {
  return shell("for p in " + names + "; do command -v $p || exit 1; done").exit_code == 0;
}

TEST_F(Store, WorkersAddUpToTheSingleProcess) {
  for (const char* which : {"evaluate", "tune"}) {
    const std::string name = std::string("workers-") + which;
    const std::string command = Store::command(which);
    const Outcome none = in(name, command + " --no-compute");
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_THAT(none.err, HasSubstr("there is no store"));
    const Outcome worked = in(name, "for i in 1 2 3; do " + command +
                                        " --shard $i/3 & pids=\"$pids $!\"; done; "
                                        "for p in $pids; do wait $p || exit 1; done");
    EXPECT_EQ(worked.exit_code, 0) << worked.err;
    EXPECT_FALSE(fs::exists(*folder_ / (name + "/out"))) << "workers write no results";
    expect_merge_as_whole(name, which);
  }
}

TEST_F(Store, SaysHowManyRunsAreMissing) {
  in("missing", evaluate());
  fs::remove_all(*folder_ / "missing/out");
  int removed = 0;
  // Contents of logs and what they show are records, too, and shorter.
  for (const auto& entry : fs::recursive_directory_iterator(*folder_ / "missing/store")) {
    if (!entry.is_regular_file() || entry.file_size() < 5'000 || removed == 3) continue;
    fs::remove(entry.path());
    ++removed;
  }
  ASSERT_EQ(removed, 3);
  const Outcome outcome = in("missing", evaluate() + " --no-compute");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("3 of 16 runs are missing"));
  EXPECT_FALSE(fs::exists(*folder_ / "missing/out"));
  const Outcome completed = in("missing", evaluate());
  EXPECT_EQ(computed(completed.out), 3) << completed.out;
  expect_as_whole("missing", "evaluate");
}

TEST_F(Store, ADamagedRecordIsNamedAndComputedAgain) {
  in("damaged", evaluate());
  fs::path damaged;
  for (const auto& entry : fs::recursive_directory_iterator(*folder_ / "damaged/store")) {
    if (entry.is_regular_file() && entry.file_size() > 5'000) damaged = entry.path();
  }
  std::fstream(damaged, std::ios::in | std::ios::out | std::ios::binary).seekp(3000).put('\x7f');
  const Outcome outcome = in("damaged", evaluate());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr(damaged.filename().string()), HasSubstr("damaged")));
  EXPECT_EQ(computed(outcome.out), 1) << outcome.out;
  expect_as_whole("damaged", "evaluate");
}

/// One with other bytes, in itself or in the part that reads logs.
TEST_F(Store, TwoVersionsOfTheProgramDoNotMix) {
  in("versions", evaluate());
  for (const char* changed : {"other", "foucault_mrpt.so"}) {
    const Outcome other =
        in("versions", "cp \"$0\" other && cp \"$(dirname \"$0\")\"/foucault_*.so . && echo >> " +
                           std::string(changed) + " && ./other " +
                           evaluate().substr(std::string("\"$0\" ").size()));
    EXPECT_EQ(other.exit_code, 0) << other.err;
    EXPECT_THAT(other.out, testing::Not(HasSubstr("found in"))) << "all was computed";
  }
}

/// A log that changes under its name, and one that has moved.
TEST_F(Store, WhatCountsIsTheContentOfALog) {
  const std::string command =
      "\"$0\" evaluate log.rawlog --methods ekf --store store --out out " + std::string(kOutages);
  EXPECT_EQ(in("content", "cp ../log1.rawlog log.rawlog && " + command).exit_code, 0);
  const Outcome changed = in("content", "cp ../log2.rawlog log.rawlog && " + command);
  EXPECT_THAT(changed.out, testing::Not(HasSubstr("found in"))) << "all was computed";
  const Outcome moved = in("content",
                           "mkdir -p moved && cp ../log1.rawlog moved/log.rawlog && "
                           "\"$0\" evaluate moved/log.rawlog --methods ekf --store "
                           "store --out out " +
                               std::string(kOutages));
  EXPECT_THAT(moved.out, HasSubstr("0 runs computed, 2 found"));
}

TEST_F(Store, WhatCannotBeWrittenIsOneLine) {
  const auto one_line = [](const Outcome& outcome) {
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("cannot write to the store"), HasSubstr("--store")));
  };
  one_line(in("unwritable", "\"$0\" evaluate ../log1.rawlog --store /proc/none --out out " +
                                std::string(kOutages)));
  // No room: files end at a few kilobytes.
  one_line(in("unwritable", "ulimit -f 4 && " + evaluate()));
  EXPECT_FALSE(fs::exists(*folder_ / "unwritable/out"));
}

TEST_F(Store, WrongSharesAreRefused) {
  for (const char* wrong : {"--shard 0/2", "--shard 3/2", "--shard auto", "--shard x"}) {
    const Outcome outcome = in("wrong", evaluate() + " " + wrong);
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_THAT(outcome.err, HasSubstr("--shard"));
  }
  EXPECT_EQ(in("wrong", evaluate() + " --shard 1/2 --no-compute").exit_code, 2);
}

/// Without --store: in a hidden folder, until the results are there.
TEST_F(Store, AHiddenOneGoesOnceTheResultsAreWritten) {
  const fs::path here = *folder_ / "hidden";
  const std::string command =
      std::regex_replace(evaluate(), std::regex("--store store "), std::string());
  EXPECT_EQ(in("hidden", command + " --shard 1/2").exit_code, 0);
  EXPECT_TRUE(fs::exists(here / ".out.foucault-records"));
  const Outcome merged = in("hidden", command);
  EXPECT_THAT(merged.out, HasSubstr("0 runs computed, 16 found"));
  EXPECT_FALSE(fs::exists(here / ".out.foucault-records"));
  EXPECT_TRUE(fs::exists(here / "out/drift.csv"));
}

/// The only worker, killed again and again: what was finished stays, and nothing is done twice.
/// (Fifty kills: tests/benchmarks/store.sh.)
TEST_F(Store, KilledAtRandomMomentsTheResultIsTheSame) {
  for (const char* which : {"evaluate", "tune"}) {
    const std::string name = std::string("killed-") + which;
    const std::string command = Store::command(which);
    std::mt19937 rng{42};
    std::map<std::string, ino_t> before;
    int kills = 0;
    for (; kills < 8; ++kills) {
      const int wait_ms = static_cast<int>(rng() % 400);
      in(name, command + " --quiet & pid=$!; sleep " + std::to_string(wait_ms / 1000.0) +
                   "; kill -KILL $pid; wait $pid");
      const std::map<std::string, ino_t> after = records_in(*folder_ / (name + "/store"));
      for (const auto& [record, inode] : before) {
        ASSERT_TRUE(after.count(record)) << record;
        EXPECT_EQ(after.at(record), inode) << "was computed twice";
      }
      before = after;
    }
    const Outcome last = in(name, command);
    EXPECT_EQ(last.exit_code, 0) << last.err;
    expect_as_whole(name, which);
  }
}

TEST_F(Store, GnuParallel) {
  if (!has_programs("parallel")) GTEST_SKIP() << "no GNU parallel here: package parallel";
  for (const char* which : {"evaluate", "tune"}) {
    const std::string name = std::string("parallel-") + which;
    const std::string command = Store::command(which);
    const Outcome worked =
        in(name, "export FOUCAULT=\"$0\"; parallel -j2 '" +
                     std::regex_replace(command, std::regex("\"\\$0\""), "$FOUCAULT") +
                     " --shard {}/2' ::: 1 2");
    EXPECT_EQ(worked.exit_code, 0) << worked.err;
    expect_merge_as_whole(name, which);
  }
}

TEST_F(Store, MpiRanks) {
  if (!has_programs("mpirun")) GTEST_SKIP() << "no mpirun here: package openmpi-bin";
  for (const char* which : {"evaluate", "tune"}) {
    const std::string name = std::string("mpi-") + which;
    const std::string command = Store::command(which);
    const Outcome worked =
        in(name, "mpirun --allow-run-as-root --oversubscribe --bind-to none -np 2 " + command +
                     " --shard auto");
    EXPECT_EQ(worked.exit_code, 0) << worked.err;
    expect_merge_as_whole(name, which);
  }
}

/// Two nodes of a Slurm of our own.
class Slurm {
 public:
  Slurm() {
    const Outcome up = script("up", "2");
    if (up.exit_code != 0) throw std::runtime_error("slurm.sh up: " + up.err);
  }
  ~Slurm() { script("down", ""); }

  /// Submits an array of `tasks` in `folder`; each tells who it is, for kill_node().
  Outcome submit(const fs::path& folder, const std::string& command, int tasks) const {
    std::ofstream(folder / "job.sh") << "#!/bin/sh\n"
                                     << "echo $$ $PPID >> '" << folder_ / "tasks/"
                                     << "'$SLURMD_NODENAME\n"
                                     << "exec " << command << "\n";
    return shell("cd '" + folder.string() + "' && export FOUCAULT=\"$0\" SLURM_CONF='" +
                 folder_ / "slurm.conf" + "' && sbatch --array=1-" + std::to_string(tasks) +
                 " job.sh");
  }

  bool is_empty() const {
    return shell("SLURM_CONF='" + folder_ / "slurm.conf" + "' squeue --noheader").out.empty();
  }
  Outcome kill_node(const std::string& name) const { return script("kill-node", name); }
  /// How many tasks have begun so far.
  int started() const { return std::stoi(shell("cat '" + folder_ / "tasks/" + "'* | wc -l").out); }

 private:
  Outcome script(const std::string& verb, const std::string& argument) const {
    return shell("'" + (tests_folder() / "support/slurm.sh").string() + "' " + verb + " '" +
                 folder_.path().string() + "' " + argument);
  }

  TestFolder folder_;
};

template <class Done>
bool wait_until(Done done) {
  for (int i = 0; i < 1800; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return false;
}

/// One node dies in the middle: its machine is gone, with all that ran on it.
TEST_F(Store, SlurmArrayWithANodeThatDies) {
  if (!has_programs("slurmctld slurmd sbatch munged")) {
    GTEST_SKIP() << "no Slurm here: packages slurmctld slurmd slurm-client munge";
  }
  const Slurm slurm;
  for (const char* which : {kSlow, "tune"}) {
    const fs::path here = *folder_ / (std::string("slurm-") + which);
    fs::create_directories(here);
    const std::string with_path =
        std::regex_replace(command(which), std::regex("\"\\$0\""), "\"$FOUCAULT\"");
    const Outcome submitted = slurm.submit(here, with_path + " --shard auto", 4);
    ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  }
  const auto is_under_way = [&](const std::string& which) {
    return records_in(*folder_ / ("slurm-" + which + "/store")).size() > 10;
  };
  ASSERT_TRUE(wait_until([&] { return is_under_way(kSlow) && is_under_way("tune"); }));
  EXPECT_EQ(slurm.kill_node("n2").exit_code, 0);
  EXPECT_TRUE(wait_until([&] { return slurm.is_empty(); }));
  EXPECT_GT(slurm.started(), 2 * 4) << "tasks of the node begin again on the other one";
  for (const std::string which : {kSlow, "tune"}) expect_merge_as_whole("slurm-" + which, which);
}

}  // namespace
}  // namespace foucault::test
