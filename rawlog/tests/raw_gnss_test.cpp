#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "child_process.h"
#include "csv_readers.h"
#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/rawlog/import_raw_gnss.h"
#include "foucault/rawlog/rawlog_source.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ChildProcess, ArgumentsAreNotASentenceForAShell) {
  std::string said;
  run_program({"printf", {"%s|%s", "a b;$HOME", "'\"*"}, "coreutils"},
              [&](std::string_view words) { said += words; });
  EXPECT_EQ(said, "a b;$HOME|'\"*");
}

TEST(ChildProcess, FailureTellsTheLastWords) {
  const Program program{"sh", {"-c", "echo first; echo 'the reason' >&2; exit 3"}, "dash"};
  EXPECT_EQ(error_of<DataError>([&] { run_program(program, [](std::string_view) {}); }),
            "sh failed (3): the reason");
}

TEST(ChildProcess, NoSuchProgramNamesThePackage) {
  const Program program{"foucault-has-no-such-program", {}, "rtklib"};
  EXPECT_THAT(error_of<DataError>([&] { run_program(program, [](std::string_view) {}); }),
              AllOf(HasSubstr("'foucault-has-no-such-program' is not there"),
                    HasSubstr("install the package rtklib")));
}

/// A listener that throws ends the program, which would go on for a minute.
TEST(ChildProcess, EndsWithItsListener) {
  Scratch scratch;
  const std::string mark = scratch.path("mark");
  const Program program{"sh", {"-c", "sleep 60; touch " + mark}, "dash"};
  int calls = 0;
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THROW(run_program(program,
                           [&](std::string_view) {
                             if (++calls == 3) throw UsageError("stop");
                           }),
               UsageError);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
  EXPECT_FALSE(std::filesystem::exists(mark));
}

// RTKLIB ------------------------------------------------------------------------------------------

bool is_installed(const std::string& program) {
  return std::system(("command -v " + program + " > /dev/null").c_str()) == 0;
}

std::string raw_dir() { return test::data_dir() + "/raw_gnss/"; }

constexpr double kBaseLatitude = 48.780735783 * kDegree;
constexpr double kBaseLongitude = 9.171992250 * kDegree;

class RawGnss : public ::testing::Test {
 protected:
  RawGnss() {
    options_.rover = raw_dir() + "rover.obs.gz";
    options_.base = raw_dir() + "base.obs.gz";
    options_.nav = {raw_dir() + "gps.23N", raw_dir() + "gal.23L"};
    options_.base_position = Geodetic{kBaseLatitude, kBaseLongitude, 320};
    options_.out = scratch_.path("out.rawlog");
    options_.mapping = test::imu_at_all_times(scratch_);
    setenv("TMPDIR", scratch_.path("").c_str(), 1);
  }
  ~RawGnss() override { unsetenv("TMPDIR"); }

  /// What RTKLIB's run left behind, beside the log.
  std::vector<std::string> folders() const {
    std::vector<std::string> found;
    for (const std::string& name : scratch_.names()) {
      if (name.rfind("foucault-", 0) == 0) found.push_back(name);
    }
    return found;
  }

  std::vector<GnssFix> fixes() {
    RawlogSource source(options_.out);
    std::vector<GnssFix> found;
    while (const std::optional<Measurement> m = source.next()) {
      if (const auto* fix = std::get_if<GnssFix>(&*m)) found.push_back(*fix);
    }
    return found;
  }

  Scratch scratch_;
  UbxImport options_;
};

/// The programs and the recordings: both are not everywhere.
class RawByRtklib : public RawGnss {
 protected:
  void SetUp() override {
    // The program does without the package, so its tests do; recordings of raw observations are
    // not in the repository. What is ours (child processes, UBX, .pos) is tested without both.
    if (!is_installed("rnx2rtkp")) GTEST_SKIP() << "no rnx2rtkp; install the package rtklib";
    if (!std::filesystem::exists(options_.rover)) {
      GTEST_SKIP() << "no recordings in " << raw_dir() << "; set FOUCAULT_DATA_DIR";
    }
  }
};

struct RawErrors {
  double position = 0, velocity = 0;  ///< RMS, of three axes together [m], [m/s]
  double normalized = 0;              ///< mean square over the covariance, of three
  size_t count = 0;
};

/// The simulator's trajectory at 10 Hz: seconds of week, ECEF position and velocity.
RawErrors compare_with_truth(const std::vector<GnssFix>& fixes) {
  TextTable truth(raw_dir() + "rover_truth_pva.csv.gz", TextTable::Separator::comma, "");
  truth.next();  // names
  RawErrors errors;
  size_t next = 0;
  while (const Row* row = truth.next()) {
    const int64_t t_ns = gps_to_unix_ns(2244, row->number(3));
    while (next < fixes.size() && fixes[next].t_ns < t_ns - 1'000'000) ++next;
    if (next == fixes.size()) break;
    const GnssFix& fix = fixes[next];
    if (std::abs(fix.t_ns - t_ns) > 1'000'000) continue;
    const Eigen::Matrix3d R = geodesy::wgs84::R_e_n(fix.antenna.latitude, fix.antenna.longitude);
    const Eigen::Vector3d p(row->number(4), row->number(5), row->number(6));
    const Eigen::Vector3d v(row->number(7), row->number(8), row->number(9));
    const Eigen::Vector3d dp = R.transpose() * (geodesy::wgs84::geodetic_to_ecef(fix.antenna) - p);
    errors.position += dp.squaredNorm();
    errors.velocity += (*fix.velocity_n - R.transpose() * v).squaredNorm();
    errors.normalized += dp.dot(fix.position_covariance.ldlt().solve(dp)) / 3;
    ++errors.count;
  }
  const auto n = static_cast<double>(errors.count);
  errors.position = std::sqrt(errors.position / n);
  errors.velocity = std::sqrt(errors.velocity / n);
  errors.normalized /= n;
  return errors;
}

TEST_F(RawByRtklib, BaseAndRoverToFixes) {
  const ImportSummary summary = import_rinex(options_);
  EXPECT_EQ(summary.gnss.written, 601);
  EXPECT_EQ(summary.with_velocity, 601);
  EXPECT_GE(summary.qualities.at(FixQuality::fixed_rtk), 600);
  EXPECT_THAT(summary.gnss.notices, IsEmpty());
  EXPECT_EQ(summary.gnss.file, options_.rover);
  EXPECT_THAT(folders(), IsEmpty());
  const std::vector<GnssFix> found = fixes();
  const RawErrors errors = compare_with_truth(found);
  EXPECT_EQ(errors.count, 601U);
  EXPECT_LT(errors.position, 0.003);                                // 0.4 mm; 21 mm with niter 1
  EXPECT_LT(errors.velocity, 0.02);                                 // 4 mm/s by Doppler
  EXPECT_LT(errors.normalized, 1);                                  // the simulator has no noise
  EXPECT_GT(std::abs(found[300].position_covariance(0, 2)), 1e-8);  // full, not diagonal
  EXPECT_GT(std::abs(found[300].velocity_covariance(0, 2)), 1e-8);
}

/// Everything is as far off as the base is, and the header's word is told.
TEST_F(RawByRtklib, WhereTheBaseIs) {
  options_.base_position->height += 10;
  import_rinex(options_);
  EXPECT_NEAR(compare_with_truth(fixes()).position, 10, 0.01);
  options_.base_position.reset();
  EXPECT_THAT(import_rinex(options_).gnss.notices,
              Contains(AllOf(HasSubstr("where its header says"), HasSubstr("--base-position"))));
  EXPECT_LT(compare_with_truth(fixes()).position, 0.003);
}

TEST_F(RawByRtklib, WithoutABaseSingle) {
  options_.base.reset();
  const ImportSummary summary = import_rinex(options_);
  EXPECT_EQ(summary.qualities.at(FixQuality::single), 601);
  const RawErrors errors = compare_with_truth(fixes());
  EXPECT_GT(errors.position, 0.5);
  EXPECT_LT(errors.position, 30);
  EXPECT_LT(errors.velocity, 0.05);
}

TEST_F(RawByRtklib, OptionsOfTheUser) {
  options_.rtklib_options =
      scratch_.text_file("mine.conf", "pos1-posmode=dgps\nout-timeform=hms\nout-outvel=on\n");
  EXPECT_EQ(import_rinex(options_).qualities.count(FixQuality::fixed_rtk), 0U);
}

TEST_F(RawByRtklib, WhatStops) {
  options_.progress = [](double part) {
    if (part > 0.1) throw UsageError("stop");
  };
  error_of<UsageError>([&] { import_rinex(options_); });
  EXPECT_THAT(folders(), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(options_.out));
}

/// A base of an hour later shares no epoch with the rover.
TEST_F(RawByRtklib, ABaseOfAnotherTime) {
  TextTable table(*options_.base, TextTable::Separator::comma, "");
  std::string later;
  while (const std::optional<std::string_view> line = table.next_line()) {
    std::string text(*line);
    if (text.rfind("> 2023 01 08 10", 0) == 0) text.replace(13, 2, "11");
    later += text + "\n";
  }
  options_.base = scratch_.text_file("later.obs", later);
  EXPECT_THAT(error_of<DataError>([&] { import_rinex(options_); }),
              AllOf(HasSubstr("none of"), HasSubstr("later.obs")));
}

/// RXM-RAWX, no NAV: single fixes. Static: velocities are zero.
TEST_F(RawByRtklib, UbxToFixes) {
  options_.rover = raw_dir() + "ublox_f9p_static.ubx";
  options_.base.reset();
  options_.nav.clear();
  const ImportSummary summary = import_ubx(options_);
  EXPECT_GT(summary.gnss.written, 900);
  EXPECT_EQ(summary.with_velocity, summary.gnss.written);
  double speed = 0;
  const std::vector<GnssFix> found = fixes();
  for (const GnssFix& fix : found) {
    EXPECT_NEAR(fix.antenna.latitude / kDegree, 30, 1e-4);
    EXPECT_NEAR(fix.antenna.longitude / kDegree, 95, 1e-4);
    speed += fix.velocity_n->norm() < 0.2 ? 1 : 0;
  }
  EXPECT_GT(speed / static_cast<double>(found.size()), 0.95);
  // An epoch 4.2 ms before the full second stays there.
  EXPECT_EQ(found.front().t_ns / 1'000'000 % 1000, 995);
}

/// A receiver as its own base stands still beside itself.
TEST_F(RawByRtklib, UbxAsRoverAndBase) {
  options_.rover = raw_dir() + "ublox_f9p_static.ubx";
  options_.base = options_.rover;
  options_.nav.clear();
  options_.base_position = Geodetic{30 * kDegree, 95 * kDegree, 0};
  import_ubx(options_);
  int relative = 0;
  for (const GnssFix& fix : fixes()) {
    if (fix.quality == FixQuality::single) continue;
    ++relative;
    EXPECT_NEAR(fix.antenna.latitude / kDegree, 30, 1e-8);
    EXPECT_NEAR(fix.antenna.height, 0, 1e-3);
  }
  EXPECT_GT(relative, 900);
}

// What needs no program ---------------------------------------------------------------------------

std::string rinex(char type) {
  return fmt::format(
      "     3.04           {:<20}M: MIXED            RINEX VERSION / TYPE\n{:60}{}\n", type, "",
      "END OF HEADER");
}

class RawGnssErrors : public RawGnss {
 protected:
  RawGnssErrors() {
    options_.rover = scratch_.text_file("rover.obs", rinex('O'));
    options_.base = scratch_.text_file("base.obs", rinex('O'));
    options_.nav = {scratch_.text_file("day.nav", rinex('N'))};
    path_ = std::getenv("PATH");
  }
  ~RawGnssErrors() override { setenv("PATH", path_.c_str(), 1); }

  template <class Error>
  std::string error() {
    const std::string what = error_of<Error>([&] { import_rinex(options_); });
    EXPECT_THAT(folders(), IsEmpty());
    return what;
  }

  std::string path_;
};

TEST_F(RawGnssErrors, WithoutThePackage) {
  setenv("PATH", scratch_.path("").c_str(), 1);
  EXPECT_THAT(error<DataError>(),
              AllOf(HasSubstr("'rnx2rtkp' is not there"), HasSubstr("package rtklib")));
}

TEST_F(RawGnssErrors, WhereTheBaseIsIsUnknown) {
  options_.base_position.reset();
  EXPECT_THAT(error<UsageError>(), AllOf(HasSubstr("base.obs"), HasSubstr("--base-position")));
}

TEST_F(RawGnssErrors, FilesThatAreNotWhatIsNeeded) {
  options_.base = options_.nav[0];
  EXPECT_THAT(error<DataError>(), HasSubstr("RINEX of type 'N', not observations"));
  options_.base = scratch_.text_file(
      "base.crx", fmt::format("{:<60}{}\n", "3.0                 COMPACT RINEX FORMAT",
                              "CRINEX VERS   / TYPE"));
  EXPECT_THAT(error<DataError>(), AllOf(HasSubstr("Hatanaka"), HasSubstr("crx2rnx")));
  options_.base = scratch_.text_file("base.txt", "nothing\n");
  EXPECT_THAT(error<DataError>(), HasSubstr("does not begin as RINEX does"));
  options_.base = scratch_.path("not_there.obs");
  EXPECT_THAT(error<DataError>(), HasSubstr("not_there.obs"));
  options_.base.reset();
  options_.nav.clear();
  EXPECT_THAT(error<UsageError>(), HasSubstr("--nav"));
}

}  // namespace
}  // namespace foucault::rawlog
