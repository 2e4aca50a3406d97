#pragma once

#include <zlib.h>

#include <cstdint>
#include <memory>
#include <string>

namespace foucault::rawlog {

/// Closes a gzFile.
struct GzClose {
  void operator()(gzFile file) const { gzclose(file); }
};
/// Of the buffers of zlib [bytes].
inline constexpr unsigned kGzipBuffer = 1U << 17;
using GzHandle = std::unique_ptr<gzFile_s, GzClose>;

/// Throws DataError if there is no such file, or it is a directory or empty.
void check_readable(const std::string& path);

/// Opens a file for reading, gzip or plain.
/// Throws DataError as check_readable, or if it cannot be opened.
GzHandle open_for_reading(const std::string& path);

/// An empty file without a name of its own, among those that are temporary; removed at the end.
class TemporaryFile {
 public:
  /// Throws DataError.
  TemporaryFile();
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// A file that appears under its name whole or not at all: written into a hidden one beside,
/// renamed by commit(), removed by the destructor otherwise. What a process that was killed left
/// behind is written over by the next one with the same name. Throws DataError, also if another
/// process is writing the same file.
class PendingFile {
 public:
  explicit PendingFile(std::string path);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::string& path() const { return path_; }
  /// Open for writing, empty; stays this object's.
  int descriptor() const { return file_; }
  void commit();

 private:
  bool open_and_lock();

  std::string path_;
  std::string target_;  ///< where a link at `path_` leads
  std::string temporary_;
  int file_ = -1;
};

}  // namespace foucault::rawlog
