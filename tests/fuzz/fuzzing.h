#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "foucault/core/error.h"

/// What every fuzz target does: any bytes give a result or one of our two errors, of one line.
/// Anything else (another exception, a broken promise) ends the process.
namespace foucault::fuzz {

/// Files in memory where there is such a file system, removed at the end of the process.
class Folder {
 public:
  Folder() {
    const std::filesystem::path memory = "/dev/shm";
    const std::filesystem::path place =
        std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
    std::string pattern = (place / "foucault-fuzz-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) std::abort();
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  std::string write(const std::string& name, std::string_view contents) const {
    std::ofstream file(path_ / name, std::ios::binary | std::ios::trunc);
    file.write(contents.data(), static_cast<std::streamsize>(contents.size()));
    return *this / name;
  }

 private:
  std::filesystem::path path_;
};

inline const Folder& folder() {
  static const Folder folder;
  return folder;
}

[[noreturn]] inline void broken_promise(const std::string& what) {
  std::fprintf(stderr, "broken promise: %s\n", what.c_str());
  std::abort();
}

inline void require(bool kept, const std::string& what) {
  if (!kept) broken_promise(what);
}

/// True if `action` came to its end, false if it threw one of our errors.
template <class Action>
bool contained(Action action) {
  try {
    action();
    return true;
  } catch (const DataError& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos, "a line an error");
  } catch (const UsageError& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos, "a line an error");
  }
  return false;
}

inline std::string_view text_of(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// The files of an input that stands for several, separated by lines "=====".
inline std::vector<std::string_view> files_of(std::string_view input, size_t count) {
  constexpr std::string_view kSeparator = "=====\n";
  std::vector<std::string_view> files;
  while (files.size() + 1 < count) {
    const size_t end = input.find(kSeparator);
    files.push_back(input.substr(0, end));
    input =
        end == std::string_view::npos ? std::string_view() : input.substr(end + kSeparator.size());
  }
  files.push_back(input);
  return files;
}

}  // namespace foucault::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
