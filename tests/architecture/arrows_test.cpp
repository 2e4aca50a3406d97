#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

/// Which module may see which: arrows point one way. A module that is not in the table fails, and
/// so does an arrow that nothing needs any more.
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const std::map<std::string, Names> kArrows = {
    {"core", {}},
    {"geodesy", {"core"}},
    {"state", {"core", "geodesy"}},
    {"imu", {"core", "geodesy", "state"}},
    {"measurement", {"core", "geodesy", "state"}},
    {"preintegration", {"core", "geodesy", "state", "imu"}},
    {"ekf", {"core", "geodesy", "state", "imu", "measurement"}},
    {"fgo", {"core", "geodesy", "state", "imu", "measurement", "preintegration"}},
    {"alignment", {"core", "geodesy", "state", "imu", "measurement", "ekf"}},
    {"diagnosis", {"core", "geodesy", "state", "imu", "measurement"}},
    {"navigation", {"core", "geodesy", "state", "imu", "measurement", "alignment", "diagnosis"}},
    {"methods", {"core", "state", "measurement", "preintegration", "ekf", "fgo", "navigation"}},
    {"simulation", {"core", "geodesy", "state", "imu"}},
    {"store", {"core"}},
    {"evaluation", {"core", "geodesy", "state", "measurement", "store"}},
    {"export", {"core", "geodesy", "state", "evaluation"}},
    {"calibration", {"core", "state", "imu", "measurement", "ekf"}},
    {"tuning", {"core", "evaluation", "export"}},
    {"laboratory",
     {"core", "geodesy", "state", "imu", "measurement", "preintegration", "simulation",
      "evaluation", "export"}},
    {"rawlog", {"core", "geodesy", "state", "imu"}},
    {"plot", {"core"}},
    {"page", {"core", "plot"}},
    {"content", {"core", "geodesy", "state", "plot", "page"}},
};

bool is_source(const fs::path& path) {
  const bool test = std::find(path.begin(), path.end(), fs::path("tests")) != path.end();
  return !test && (path.extension() == ".h" || path.extension() == ".cpp");
}

/// Modules whose headers are included in a folder.
Names seen_from(const fs::path& folder) {
  static const std::regex include("#include \"foucault/([a-z_]+)/");
  Names seen;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!is_source(entry.path())) continue;
    std::ifstream file(entry.path());
    std::smatch match;
    for (std::string line; std::getline(file, line);) {
      if (std::regex_search(line, match, include)) seen.insert(match[1]);
    }
  }
  return seen;
}

/// Folders of modules, by name: those that have foucault/<name>/ under include/.
std::map<std::string, fs::path> modules(const fs::path& root) {
  std::map<std::string, fs::path> found;
  for (const char* part : {"modules", "rawlog", "gui-free-reports"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / part)) {
      const fs::path path = entry.path();
      if (path.filename() != "foucault" || path.parent_path().filename() != "include") continue;
      for (const auto& name : fs::directory_iterator(path)) {
        found[name.path().filename()] = path.parent_path().parent_path();
      }
    }
  }
  return found;
}

TEST(Arrows, PointOneWay) {
  const std::map<std::string, fs::path> found = modules(FOUCAULT_SOURCES);
  EXPECT_EQ(found.size(), kArrows.size());
  for (const auto& [name, folder] : found) {
    ASSERT_TRUE(kArrows.count(name)) << "new module: " << name << "; add it to the table";
    Names seen = seen_from(folder);
    seen.erase(name);
    EXPECT_EQ(seen, kArrows.at(name)) << name;
  }
}

/// The table itself: nothing that a module sees may see it in turn.
TEST(Arrows, TheTableHasNoCircle) {
  for (const auto& [name, sees] : kArrows) {
    for (const std::string& other : sees) {
      EXPECT_EQ(kArrows.at(other).count(name), 0u) << name << " <-> " << other;
    }
  }
}

}  // namespace
