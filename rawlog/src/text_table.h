#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files.h"
#include "input_file.h"

namespace foucault::rawlog {

/// Decimals of seconds that are read as nanoseconds, see Row::scaled().
inline constexpr int kNanosecondDecimals = 9;

/// A row of a text file, cut into fields. Views last until the next row is read.
class Row : public Place {
 public:
  const std::vector<std::string_view>& fields() const { return fields_; }
  size_t size() const { return fields_.size(); }
  std::string_view text(size_t column) const;
  /// A finite number. Throws RowError.
  double number(size_t column) const;
  int64_t integer(size_t column) const;
  /// A decimal number times 10^decimals, exact: seconds as nanoseconds with 9. Throws RowError.
  int64_t scaled(size_t column, int decimals) const;
  /// A finite number greater than zero. Throws RowError; of a zero it says that `constant` may be
  /// given instead of columns, if that is a key.
  double sigma(size_t column, const std::string& constant = {}) const;

 private:
  std::string where() const override;

  friend class TextTable;
  std::vector<std::string_view> fields_;
  const std::string* path_ = nullptr;
  int64_t line_ = 0;
};

/// Rows of a text file, plain or gzip. Empty lines and those that begin with a comment sign are
/// left out.
class TextTable : public InputFile {
 public:
  enum class Separator { comma, semicolon, tab, space, space_or_comma };

  /// Throws DataError if the file cannot be opened.
  TextTable(std::string path, Separator separator, std::string comment_signs);

  /// The next row; none at the end. Throws DataError if the file is damaged.
  const Row* next();
  /// The next line as it is, comments too.
  std::optional<std::string_view> next_line();

  const std::string& path() const override { return path_; }
  int64_t position() const override { return row_.line_; }
  std::string place(int64_t line) const override;
  double progress() const override;

 private:
  void cut(std::string_view line);
  void cut_at(const char* signs, std::string_view line);

  std::string path_;
  Separator separator_;
  std::string comment_signs_;
  GzHandle file_;
  double file_size_ = 0;
  std::string buffer_;
  Row row_;
};

}  // namespace foucault::rawlog
