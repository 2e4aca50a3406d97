#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

/// How far the order and the sizes of a state are spread over the program. A new block should be a
/// line of its own and its effect; so few files may know where a block stands, by a size, an offset
/// or a number in a template argument. All others use part(), rows_of(), node_part(),
/// Layout::find() and the types of state/blocks.h.
namespace {

constexpr std::size_t kMostFiles = 8;  ///< those of modules/state that define them among them

namespace fs = std::filesystem;

/// Names of sizes and offsets; numbers that are those of a node, of a node as Ceres has it (16) or
/// of one with scale factors as the arguments of a matrix or of a part of one; and halves of a
/// node.
const std::vector<std::string> kPatterns = {
    R"(\b(kNodeSize|kMotionSize|kMostSlow|kMostSize|slow_index|Matrix15d|Vector15d|error_state)\b)",
    R"(\b(\w*[Bb]lock|row|column|position|velocity|attitude|gyro_bias|accel_bias)\.offset\b)",
    R"(\b(Matrix|Vector|Array|SizedCostFunction)<[^<>;(){}]*\b(15|16|18|21)\b)",
    R"(\b(block|segment|head|tail|\w*Rows|\w*Cols|\w*Corner)<[^<>;(){}]*\b(15|16|18|21)\b)",
    R"(\b(segment|head|tail|\w*Rows|\w*Cols|\w*Corner)<\s*(6|9|12)\b)",
};

std::string without_comments(const std::string& code) {
  std::string out;
  std::istringstream lines(code);
  for (std::string line; std::getline(lines, line);) out += line.substr(0, line.find("//")) + '\n';
  return out;
}

/// The first text that names the layout; empty if there is none.
std::string naming(const std::string& code) {
  static const std::vector<std::regex> patterns(kPatterns.begin(), kPatterns.end());
  const std::string bare = without_comments(code);
  for (const std::regex& pattern : patterns) {
    std::smatch match;
    if (std::regex_search(bare, match, pattern)) return match.str();
  }
  return "";
}

std::string contents(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

bool is_program_source(const fs::path& path) {
  const bool test = std::find(path.begin(), path.end(), fs::path("tests")) != path.end();
  return !test && (path.extension() == ".h" || path.extension() == ".cpp");
}

/// Relative to the root, in order.
std::vector<fs::path> program_sources(const fs::path& root) {
  std::vector<fs::path> sources;
  for (const char* part : {"modules", "apps", "rawlog", "gui-free-reports"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / part)) {
      const fs::path path = entry.path().lexically_relative(root);
      if (is_program_source(path)) sources.push_back(path);
    }
  }
  std::sort(sources.begin(), sources.end());
  return sources;
}

TEST(LayoutNames, FewFilesKnowWhereABlockStands) {
  const fs::path root = FOUCAULT_SOURCES;
  const std::vector<fs::path> sources = program_sources(root);
  ASSERT_GT(sources.size(), 100u) << root;
  std::vector<std::string> files;
  for (const fs::path& path : sources) {
    const std::string found = naming(contents(root / path));
    if (!found.empty()) files.push_back(path.string() + ": " + found);
  }
  for (const std::string& file : files) std::cout << file << '\n';
  EXPECT_GE(files.size(), 1u);  // blocks.h defines them
  EXPECT_LE(files.size(), kMostFiles);
}

TEST(LayoutNames, AreFoundInCode) {
  for (const char* code :
       {"StateMatrix::Zero(kNodeSize, kNodeSize)", "Matrix15d P;", "layout.slow_index(b)",
        "error_state::kAttitude", "m.row(block.offset)", "gyro_bias.offset + 1",
        "Eigen::Matrix<double, 15, 15> P;", "Eigen::Matrix<double, 3,\n    15> H;",
        "Eigen::Matrix<double, kRows, 16, Eigen::RowMajor> J", "P.block<15, 3>(0, 0)",
        "v.template segment<15>(0)", "x.head<9>()", "x.tail<6>()", "J.template leftCols<6>()",
        "P.topLeftCorner<9, 9>()", "ceres::SizedCostFunction<15, kStateBlockSize>"})
    EXPECT_NE(naming(code), "") << code;
}

TEST(LayoutNames, AreNotSeenWhereTheyAreNot) {
  for (const char* code :
       {"// of kNodeSize rows", "file.offset()", "course.offset = 1", "verdict.offset",
        "part(P, position, attitude)", "Eigen::Matrix<double, 3, 3> R;", "P.block<3, 3>(0, 15)",
        "std::array<double, 15> a", "x.head<3>()", "heading(15)", "Eigen::Matrix<double, 6, 6> S;",
        "if (i < 15 && n > 16)", "Matrix<double, kRows, 3>::Zero(15)"})
    EXPECT_EQ(naming(code), "") << code;
}

}  // namespace
