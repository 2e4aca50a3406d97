#pragma once

#include <mrpt/serialization/CArchive.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "files.h"

namespace foucault::rawlog {

/// MRPT's archive over a gzip or plain file that knows where and how it ended. MRPT's own stream
/// takes a truncated gzip for a finished one, and fields read short for zeros.
class GzReadArchive final : public mrpt::serialization::CArchive {
 public:
  enum class End { none, clean, truncated, damaged };

  /// Throws DataError as open_for_reading.
  explicit GzReadArchive(const std::string& path);

  /// The next byte begins an object: only here the file may end.
  void begin_object();
  /// Class name in the header of the object at hand; empty if it is none.
  std::string object_class() const;

  End end() const { return end_; }
  /// Bytes of the contents (uncompressed) taken so far.
  uint64_t offset() const { return offset_; }
  bool compressed() const { return compressed_; }
  uint64_t file_size() const { return file_size_; }
  /// Part of the file that is read, 0 to 1.
  double progress() const;

  std::string getArchiveDescription() const override { return path_; }

 protected:
  size_t read(void* target, size_t length) override;
  size_t write(const void* source, size_t length) override;

 private:
  bool fill();

  std::string path_;
  GzHandle file_;
  uint64_t file_size_ = 0;
  bool compressed_ = false;
  std::vector<char> buffer_;
  size_t position_ = 0;
  size_t available_ = 0;
  uint64_t offset_ = 0;
  uint64_t object_offset_ = 0;
  std::array<char, 128> head_{};
  size_t head_size_ = 0;
  End end_ = End::none;
};

/// MRPT's archive into a gzip file that is still pending.
class GzWriteArchive final : public mrpt::serialization::CArchive {
 public:
  /// Throws DataError if the file cannot be created.
  explicit GzWriteArchive(const PendingFile& file);

  /// Throws DataError if not everything reached the disk.
  void close();

 protected:
  size_t read(void* target, size_t length) override;
  size_t write(const void* source, size_t length) override;

 private:
  void flush();

  std::string path_;
  GzHandle file_;
  std::vector<char> buffer_;
};

}  // namespace foucault::rawlog
