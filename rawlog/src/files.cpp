#include "files.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace fs = std::filesystem;

void check_readable(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    throw DataError(fmt::format("'{}' does not exist; check the path", path));
  }
  if (fs::is_directory(status)) {
    throw DataError(fmt::format("'{}' is a directory; name a file in it", path));
  }
  if (fs::is_regular_file(status) && fs::file_size(path, error) == 0 && !error) {
    throw DataError(fmt::format("'{}' is empty", path));
  }
}

GzHandle open_for_reading(const std::string& path) {
  check_readable(path);
  GzHandle handle(gzopen(path.c_str(), "rb"));
  if (!handle) {
    throw DataError(fmt::format("'{}' cannot be read: {}", path, std::strerror(errno)));
  }
  return handle;
}

PendingFile::PendingFile(std::string path) : path_(std::move(path)), temporary_(path_ + ".part") {
  std::error_code error;
  if (path_.empty()) throw DataError("the output file has no name; give one");
  if (fs::is_directory(path_, error)) {
    throw DataError(fmt::format("'{}' is a directory; name a file in it", path_));
  }
}

PendingFile::~PendingFile() {
  std::error_code ignored;
  if (!committed_) fs::remove(temporary_, ignored);
}

void PendingFile::commit() {
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) throw DataError(fmt::format("'{}' cannot be written: {}", path_, error.message()));
  committed_ = true;
}

}  // namespace foucault::rawlog
