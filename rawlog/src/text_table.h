#pragma once

#include <cstdint>
#include <deque>
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
  /// Whether the cell says that there is no value: nothing, NaN, or a word for it.
  bool is_blank(size_t column) const;
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
/// left out; quotes around a field, too.
class TextTable : public InputFile {
 public:
  enum class Separator { comma, semicolon, tab, space, space_or_comma };
  /// Sign of decimals; automatic: the comma where it separates no columns and the row has no number
  /// with a point.
  enum class Decimal { automatic, point, comma };

  /// Throws DataError if the file cannot be opened.
  TextTable(const std::string& path, Separator separator, std::string comment_signs)
      : TextTable(path, separator, std::move(comment_signs), path) {}
  /// Messages name it `named`.
  TextTable(const std::string& path, Separator separator, std::string comment_signs,
            std::string named);
  /// From the next row on.
  void read_as(Separator separator, Decimal decimal);

  /// The next row; none at the end. Throws DataError if the file is damaged.
  const Row* next();
  /// The next line as it is, comments too.
  std::optional<std::string_view> next_line();
  /// The lines that come next, this many if there are; they are still to be read.
  const std::deque<std::string>& preview(size_t lines);
  /// The same of a file that is not text throughout: next_line() ends a line at a zero byte.
  std::optional<std::string_view> next_bytes();
  /// A part of the line that came last, as a row.
  const Row& split(std::string_view line);

  const std::string& path() const override { return path_; }
  int64_t position() const override { return row_.line_; }
  std::string place(int64_t line) const override;
  double progress() const override;

 private:
  std::optional<std::string_view> read_line();
  std::optional<std::string_view> read_bytes();
  void turn_decimal_commas();

  std::string path_;
  Separator separator_;
  Decimal decimal_ = Decimal::automatic;
  std::string comment_signs_;
  GzHandle file_;
  double file_size_ = 0;
  std::string buffer_;
  std::deque<std::string> ahead_;
  int64_t lines_read_ = 0;
  Row row_;
};

/// Cuts a line into `fields`, which are views of it.
void cut(std::string_view line, TextTable::Separator separator,
         std::vector<std::string_view>& fields);

}  // namespace foucault::rawlog
