#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "files.h"

namespace foucault::rawlog {

/// Lines of a text file, plain or gzip. Text in UTF-16 with its byte order mark is turned into
/// UTF-8; lines may end with CR alone, if none of the file's beginning ends otherwise.
class TextLines {
 public:
  /// Messages name it `named`. Throws DataError if the file cannot be opened.
  TextLines(const std::string& path, std::string named);

  /// The next line without its end, until the next call. A line that a gzip file ends in before its
  /// end is left out. Throws DataError if the file is damaged or a line is no text.
  std::optional<std::string_view> next();

  int64_t lines() const { return lines_; }
  /// Whether a gzip file has ended before its end.
  bool is_cut() const { return is_cut_; }
  /// Zeros at the end of lines too long for zeros to be in them, left out [bytes].
  int64_t zeros() const { return zeros_; }
  double progress() const;

 private:
  enum class Encoding { bytes, utf16_little, utf16_big };

  bool refill();
  std::string read();
  void begin(std::string& bytes);
  void check_length();
  std::string_view take(size_t end, size_t next);

  std::string named_;
  GzHandle file_;
  double file_size_ = 0;
  Encoding encoding_ = Encoding::bytes;
  std::string half_;  ///< of a character of two bytes
  char end_of_line_ = '\n';
  bool has_begun_ = false;
  bool is_cut_ = false;
  std::string block_;
  size_t line_ = 0;      ///< where it begins in `block_`
  size_t searched_ = 0;  ///< for its end
  int64_t lines_ = 0;
  int64_t zeros_ = 0;
};

}  // namespace foucault::rawlog
