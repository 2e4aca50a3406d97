#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "inflated_file.h"
#include "input_file.h"

namespace foucault::rawlog {

/// The bytes of a file of binary records, plain or gzip, from its beginning to its end.
class BinaryFile : public InputFile, public Place {
 public:
  /// Throws DataError if the file cannot be opened.
  explicit BinaryFile(const std::string& path) : path_(path), file_(path) {}

  const std::string& path() const override { return path_; }
  int64_t position() const override { return position_; }
  std::string place(int64_t byte) const override;
  double progress() const override { return file_.progress(); }

  bool at_end();
  /// From here on position() is that of the next byte.
  void begin_record() { position_ = offset(); }
  int64_t offset() const { return static_cast<int64_t>(file_.offset()); }
  /// What comes next, without going on: at least InflatedFile::kWindow bytes unless the file ends.
  Bytes window() { return file_.window(); }
  /// The next bytes, as many as there are. False if the file ends before.
  bool read(uint64_t count, std::vector<unsigned char>& bytes);
  bool skip(uint64_t count);

 private:
  std::string where() const override { return place(position_); }

  std::string path_;
  InflatedFile file_;
  int64_t position_ = 0;
};

inline Bytes bytes_of(const std::vector<unsigned char>& bytes) {
  return {bytes.data(), bytes.data() + bytes.size()};
}

}  // namespace foucault::rawlog
