#include "output_directory.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "foucault/core/error.h"

namespace fs = std::filesystem;

namespace foucault::app {
namespace {

[[noreturn]] void fail(const fs::path& target, const std::string& reason) {
  throw DataError(
      fmt::format("cannot write to '{}': {}; give another --out", target.string(), reason));
}

/// Makes a folder of a name not used yet, with the permissions a plain mkdir would give.
fs::path make_staging(const fs::path& target, const fs::path& pattern) {
  std::string name = pattern.string();
  if (mkdtemp(name.data()) == nullptr) fail(target, std::strerror(errno));
  const mode_t mask = umask(0);
  umask(mask);
  chmod(name.c_str(), 0777 & ~mask);
  return name;
}

}  // namespace

OutputDirectory::OutputDirectory(const std::string& target) {
  if (target.empty()) throw UsageError("--out is empty; name a folder for the results");
  std::error_code error;
  target_ = fs::absolute(target, error).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (fs::exists(target_, error)) {
    if (!fs::is_directory(target_, error)) fail(target_, "it is a file");
    staging_ = make_staging(target_, target_ / ".foucault-XXXXXX");
    return;
  }
  fs::create_directories(target_.parent_path(), error);
  if (error) fail(target_, error.message());
  staging_ = make_staging(target_, target_.string() + ".XXXXXX");
}

OutputDirectory::~OutputDirectory() {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
}

void OutputDirectory::commit() {
  std::error_code error;
  if (fs::exists(target_, error)) {
    replace_entries();
    return;
  }
  fs::rename(staging_, target_, error);
  if (error) fail(target_, error.message());
  staging_.clear();
}

void OutputDirectory::replace_entries() {
  const fs::path previous = staging_ / ".previous";
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(staging_)) {
    names.push_back(entry.path().filename());
  }
  std::error_code error;
  fs::create_directory(previous, error);
  for (const fs::path& name : names) {
    // A folder cannot be renamed over another one that is not empty.
    if (fs::is_directory(target_ / name, error)) fs::rename(target_ / name, previous / name, error);
    fs::rename(staging_ / name, target_ / name, error);
    if (error) fail(target_, error.message());
  }
}

}  // namespace foucault::app
