/// What users of the installed package get: the programs of apps/examples, built outside of this
/// tree, against the truth; and the program itself.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "support/test_folder.h"

namespace foucault::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Lt;
using ::testing::Not;

/// In a folder of its own.
void shell(const TestFolder& folder, const std::string& command) {
  const std::string all = "cd '" + folder.path().string() + "' && " + command;
  ASSERT_EQ(std::system(all.c_str()), 0) << command;
}

std::string example(const std::string& name) { return FOUCAULT_EXAMPLES "/" + name; }

std::vector<double> numbers(const std::string& line) {
  std::vector<double> row;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) row.push_back(std::stod(cell));
  return row;
}

/// Rows by their stamp in ms.
std::map<long, std::vector<double>> table(const std::vector<std::string>& lines) {
  std::map<long, std::vector<double>> rows;
  for (const std::string& line : lines) {
    const std::vector<double> row = numbers(line);
    rows[std::lround(1e3 * row[0])] = row;
  }
  return rows;
}

TEST(EmbedEkf, IsWhereTheTruthIs) {
  const TestFolder folder;
  shell(folder, example("tables_of_a_trip") + " 300");
  shell(folder, example("embed_ekf") + " > solution.csv");
  const auto truth = table(folder.lines("truth.csv"));
  const auto solution = table(folder.lines("solution.csv"));
  ASSERT_GT(solution.size(), 250u);
  double squares = 0;
  for (const auto& [stamp, row] : solution) {
    ASSERT_EQ(truth.count(stamp), 1u) << stamp;
    const std::vector<double>& at = truth.at(stamp);
    const double north = (row[1] - at[1]) * 111e3;
    const double east = (row[2] - at[2]) * 111e3 * std::cos(at[1] * M_PI / 180);
    const double down = at[3] - row[3];
    squares += (north * north + east * east + down * down) / (row[4] * row[4]);
    EXPECT_LT(std::hypot(north, east), 5 * 0.0145);  // fixes of 1 cm along north and east
  }
  // 1 if sigmas are right; errors of neighbouring epochs belong together, so the mean of 300
  // varies.
  EXPECT_GT(squares / static_cast<double>(solution.size()), 0.67);
  EXPECT_LT(squares / static_cast<double>(solution.size()), 1.33);
}

TEST(EmbedEkf, SaysInOneLineThatItsTablesAreMissing) {
  const TestFolder folder;
  shell(folder, "! " + example("embed_ekf") + " 2> said");
  EXPECT_EQ(folder.text("said"), "no imu.csv or gnss.csv\n");
}

TEST(EmbedEkf, NeedsFewLibrariesAndNoneOfMrptAndOpencv) {
  const TestFolder folder;
  shell(folder, "ldd " + example("embed_ekf") + " > libraries");
  EXPECT_THAT(folder.lines("libraries").size(), Lt(21u));
  EXPECT_THAT(folder.text("libraries"), HasSubstr("libstdc++"));
  EXPECT_THAT(folder.text("libraries"), Not(HasSubstr("mrpt")));
  EXPECT_THAT(folder.text("libraries"), Not(HasSubstr("opencv")));
}

std::map<std::string, double> distances_off(const std::string& arguments) {
  const TestFolder folder;
  shell(folder, example("own_measurement") + arguments + " > distances");
  std::map<std::string, double> off;
  for (const std::string& line : folder.lines("distances")) {
    off[line.substr(0, line.find(','))] = std::stod(line.substr(line.find(',') + 1));
  }
  return off;
}

TEST(OwnMeasurement, HoldsEveryEstimatorInAnOutage) {
  const std::map<std::string, double> with = distances_off("");
  const std::map<std::string, double> without = distances_off(" none");
  for (const char* name : {"ekf", "refined", "rough", "full", "rts", "batch"}) {
    ASSERT_EQ(with.count(name), 1u) << name;
    EXPECT_LT(with.at(name), 0.3) << name;     // ranges of 5 cm, seen at a sharp angle
    EXPECT_GT(without.at(name), 1.0) << name;  // 40 s of a consumer IMU
  }
}

/// What README and pages promise.
TEST(Examples, AreFilesOfFortyLines) {
  for (const char* name : {"embed_ekf.cpp", "own_measurement.cpp"}) {
    std::ifstream file(std::string(FOUCAULT_PREFIX "/share/doc/libfoucault-dev/examples/") + name);
    const std::ptrdiff_t lines = std::count(std::istreambuf_iterator<char>(file), {}, '\n');
    EXPECT_GT(lines, 20) << name;
    EXPECT_LE(lines, 40) << name;
  }
}

TEST(InstalledProgram, IsThisVersion) {
  const TestFolder folder;
  shell(folder, FOUCAULT_PREFIX "/bin/foucault -V > version");
  EXPECT_EQ(folder.text("version"), "foucault " FOUCAULT_VERSION "\n");
}

TEST(InstalledProgram, HasItsManualAndCompletions) {
  for (const char* file :
       {"share/man/man1/foucault.1", "share/bash-completion/completions/foucault",
        "share/zsh/vendor-completions/_foucault", "share/foucault/configs/consumer_mems.yaml"}) {
    EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::path(FOUCAULT_PREFIX) / file))
        << file;
  }
}

TEST(InstalledProgram, NeedsNeitherMrptNorOpencvToBegin) {
  const TestFolder folder;
  shell(folder, "ldd " FOUCAULT_PREFIX "/bin/foucault > libraries");
  EXPECT_THAT(folder.lines("libraries").size(), Lt(45u));
  EXPECT_THAT(folder.text("libraries"), Not(HasSubstr("mrpt")));
  EXPECT_THAT(folder.text("libraries"), Not(HasSubstr("opencv")));
}

/// The installed program and its parts, moved to another place.
class MovedProgram : public testing::Test {
 protected:
  MovedProgram() {
    shell(folder_, "mkdir bin lib && cp " FOUCAULT_PREFIX
                   "/bin/foucault bin && cp -r " FOUCAULT_PREFIX "/lib/foucault lib");
    shell(folder_, "bin/foucault simulate -q --duration 60 --out trip.rawlog");
  }

  TestFolder folder_;
};

TEST_F(MovedProgram, FindsItsParts) {
  shell(folder_, "bin/foucault run -q trip.rawlog --out run > output");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run/report/index.html"));
}

TEST_F(MovedProgram, SaysWhichPartIsMissing) {
  const auto expect_missing = [&](const std::string& part) {
    const std::string file = folder_ / ("lib/foucault/" + part + ".so");
    std::filesystem::rename(file, file + ".off");
    shell(folder_, "! bin/foucault run -q trip.rawlog --out run > output 2> errors");
    std::filesystem::rename(file + ".off", file);
    ASSERT_EQ(folder_.lines("errors").size(), 1U) << folder_.text("errors");
    EXPECT_THAT(folder_.text("errors"), HasSubstr(part + ".so"));
    EXPECT_THAT(folder_.text("errors"), HasSubstr("install foucault again"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
  };
  expect_missing("foucault_mrpt");
  expect_missing("foucault_renderer");
}

}  // namespace
}  // namespace foucault::test
