#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

/// Pages: links lead to files, and every README.md is reached from the main one.
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Files that a page links to, as it writes them: no addresses, no places within a page.
std::set<std::string> links_of(const fs::path& page) {
  static const std::regex link(R"(\]\(([^)#: ]+)(#[^)]*)?\))");
  const std::string text = text_of(page);
  std::set<std::string> links;
  for (std::sregex_iterator m(text.begin(), text.end(), link), end; m != end; ++m)
    links.insert((*m)[1]);
  return links;
}

bool is_of_ours(const fs::path& path) {
  const std::string top = path.begin()->string();
  return top.rfind("build", 0) != 0 && top[0] != '.';
}

std::set<fs::path> pages(const fs::path& root) {
  std::set<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const fs::path path = fs::relative(entry.path(), root);
    if (path.filename() == "README.md" && is_of_ours(path)) found.insert(path);
  }
  return found;
}

TEST(Pages, LinksLeadToFiles) {
  const fs::path root = FOUCAULT_SOURCES;
  int links = 0;
  for (const fs::path& page : pages(root)) {
    for (const std::string& link : links_of(root / page)) {
      ++links;
      EXPECT_TRUE(fs::exists(root / page.parent_path() / link)) << page << ": " << link;
    }
  }
  EXPECT_GT(links, 30);
}

TEST(Pages, EveryOneIsReachedFromTheMainOne) {
  const fs::path root = FOUCAULT_SOURCES;
  std::set<fs::path> reached;
  std::vector<fs::path> next{"README.md"};
  while (!next.empty()) {
    const fs::path page = next.back();
    next.pop_back();
    if (page.extension() != ".md" || !reached.insert(page).second) continue;
    for (const std::string& link : links_of(root / page))
      next.push_back((page.parent_path() / link).lexically_normal());
  }
  for (const fs::path& page : pages(root)) EXPECT_EQ(reached.count(page), 1U) << page;
}

}  // namespace
