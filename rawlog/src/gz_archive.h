#pragma once

#include <mrpt/serialization/CArchive.h>

#include <string>
#include <vector>

#include "files.h"

namespace foucault::rawlog {

/// MRPT's archive into a gzip file that is still pending.
class GzWriteArchive final : public mrpt::serialization::CArchive {
 public:
  /// Throws DataError if the file cannot be created.
  explicit GzWriteArchive(const PendingFile& file);

  /// Throws DataError if it cannot be written; from within WriteObject MRPT would make it an
  /// exception of its own.
  void put(const mrpt::serialization::CSerializable& object);

  /// Throws DataError if not everything reached the disk.
  void close();

 protected:
  size_t read(void* target, size_t length) override;
  size_t write(const void* source, size_t length) override;

 private:
  void flush();
  [[noreturn]] void fail() const;

  std::string path_;
  GzHandle file_;
  std::vector<char> buffer_;
};

}  // namespace foucault::rawlog
