#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "input_file.h"
#include "text_lines.h"

namespace foucault::rawlog {

/// Decimals of seconds that are read as nanoseconds, see Row::scaled().
inline constexpr int kNanosecondDecimals = 9;

/// Whether a cell says that there is no value: nothing, NaN or infinity as programs spell them, a
/// word for it, or strokes, points and stars alone.
bool is_blank_text(std::string_view field);

/// A row of a text file, cut into fields. Views last until the next row is read.
class Row : public Place {
 public:
  const std::vector<std::string_view>& fields() const { return fields_; }
  size_t size() const { return fields_.size(); }
  std::string_view text(size_t column) const;
  bool is_blank(size_t column) const { return is_blank_text(text(column)); }
  /// A finite number, as C, Fortran or a typesetter write it. Throws RowError.
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
  /// Sign of decimals; the other sign, if it is told, stands between thousands. Automatic: the
  /// comma where it separates no columns and the row has no number with a point.
  enum class Decimal { automatic, point, comma };

  /// Throws DataError if the file cannot be opened.
  TextTable(const std::string& path, Separator separator, std::string comment_signs)
      : TextTable(path, separator, std::move(comment_signs), path) {}
  /// Messages name it `named`.
  TextTable(const std::string& path, Separator separator, std::string comment_signs,
            std::string named);
  /// From the next row on.
  void read_as(Separator separator, Decimal decimal);
  /// Rows that have something else in this column are left out.
  void choose(size_t column, std::string value);

  /// The next row; none at the end. Throws DataError if the file is damaged, RowError once if it
  /// ends before its end.
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
  double progress() const override { return lines_.progress(); }
  /// What was left out of the lines.
  std::vector<std::string> notices() const;

 private:
  std::optional<std::string_view> read_line();
  std::string_view keep(std::string_view line);
  void check_end();
  bool is_chosen() const;
  void turn_decimal_commas();
  void drop_thousands();

  std::string path_;
  Separator separator_;
  Decimal decimal_ = Decimal::automatic;
  std::string comment_signs_;
  std::optional<std::pair<size_t, std::string>> chosen_;
  TextLines lines_;
  std::string buffer_;  ///< the line that came last
  std::deque<std::string> ahead_;
  bool end_is_told_ = false;
  int64_t zeros_ = 0;
  Row row_;
};

/// Where `sign` stands as the decimal sign of a number.
std::optional<size_t> decimal_sign(std::string_view field, char sign);

/// Whether a number has `sign`, comma or point, between its thousands. Points need a decimal comma
/// behind them.
bool has_thousands(std::string_view field, char sign);

/// Cuts a line into `fields`, which are views of it.
void cut(std::string_view line, TextTable::Separator separator,
         std::vector<std::string_view>& fields);

}  // namespace foucault::rawlog
