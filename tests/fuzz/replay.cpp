#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iterator>

#include "fuzzing.h"

namespace {

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

/// Gives every file of a folder to the fuzz target, without libFuzzer. Ends with an error if one
/// takes more than ten seconds; what the target finds ends the process.
int main(int argc, char** argv) {
  constexpr std::chrono::seconds kLongest{10};
  if (argc != 2) return 2;
  int files = 0;
  for (const std::filesystem::path& path : files_in(argv[1])) {
    const std::string bytes = contents(path);
    std::printf("%s, %zu bytes\n", path.filename().c_str(), bytes.size());
    std::fflush(stdout);
    const auto begin = std::chrono::steady_clock::now();
    LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
    if (std::chrono::steady_clock::now() - begin > kLongest) return 1;
    ++files;
  }
  std::printf("%d files\n", files);
  return files > 0 ? 0 : 1;
}
