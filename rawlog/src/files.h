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
using GzHandle = std::unique_ptr<gzFile_s, GzClose>;

/// Throws DataError if there is no such file, or it is a directory or empty.
void check_readable(const std::string& path);

/// Opens a file for reading, gzip or plain.
/// Throws DataError as check_readable, or if it cannot be opened.
GzHandle open_for_reading(const std::string& path);

/// A file that appears under its name whole or not at all: written beside, renamed by commit(),
/// removed by the destructor otherwise. Throws DataError.
class PendingFile {
 public:
  explicit PendingFile(std::string path);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& temporary() const { return temporary_; }
  void commit();

 private:
  std::string path_;
  std::string temporary_;
  bool committed_ = false;
};

}  // namespace foucault::rawlog
