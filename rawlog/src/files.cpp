#include "files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

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

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw DataError(fmt::format("'{}' cannot be written: {}", path, reason));
}

/// Devices and pipes would be replaced by a file, not written to.
void check_writable(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    throw DataError(fmt::format("'{}' is a directory; name a file in it", path));
  }
  if (!fs::exists(status)) return;
  if (!fs::is_regular_file(status)) fail(path, "it is a device or a pipe; name a file");
  if (access(path.c_str(), W_OK) != 0) fail(path, std::strerror(errno));
}

/// Where a link leads, so that it stays one.
fs::path behind_links(const std::string& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  fs::path target = fs::weakly_canonical(path, error);
  if (error) fail(path, error.message());
  return target;
}

bool is_same_file(int file, const std::string& path) {
  struct stat held {
  }, there{};
  return fstat(file, &held) == 0 && lstat(path.c_str(), &there) == 0 &&
         held.st_ino == there.st_ino && held.st_dev == there.st_dev;
}

}  // namespace

TemporaryFile::TemporaryFile() {
  const fs::path folder = fs::temp_directory_path();
  path_ = (folder / "foucault-XXXXXX").string();
  const int descriptor = mkstemp(path_.data());
  if (descriptor < 0) {
    throw DataError(fmt::format("'{}' cannot be written to: {}; set TMPDIR to another folder",
                                folder.string(), std::strerror(errno)));
  }
  close(descriptor);
}

TemporaryFile::~TemporaryFile() { unlink(path_.c_str()); }

PendingFile::PendingFile(std::string path) : path_(std::move(path)) {
  if (path_.empty()) throw DataError("the output file has no name; give one");
  check_writable(path_);
  const fs::path target = behind_links(path_);
  target_ = target.string();
  temporary_ =
      (target.parent_path() / ("." + target.filename().string() + ".foucault-part")).string();
  while (!open_and_lock()) close(file_);
  if (ftruncate(file_, 0) != 0) fail(path_, std::strerror(errno));
}

/// False if another process has finished with the file just now.
bool PendingFile::open_and_lock() {
  file_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (file_ < 0) fail(path_, std::strerror(errno));
  if (flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(file_);
    fail(path_, "another process is writing it; wait for its end or give another name");
  }
  return is_same_file(file_, temporary_);
}

PendingFile::~PendingFile() {
  if (file_ < 0) return;
  std::error_code ignored;
  if (is_same_file(file_, temporary_)) fs::remove(temporary_, ignored);
  close(file_);
}

void PendingFile::commit() {
  if (!is_same_file(file_, temporary_)) fail(path_, "it was removed while it was written");
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) fail(path_, error.message());
  close(file_);
  file_ = -1;
}

}  // namespace foucault::rawlog
