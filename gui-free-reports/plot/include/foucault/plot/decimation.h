#pragma once

#include <cstddef>
#include <set>
#include <vector>

namespace foucault::plot {

/// Collects rows of a stream of any length in bounded memory for drawing.
/// Rows are kept exactly until there are `max_rows`; from then on neighbouring rows share a bucket,
/// of which the rows survive that hold the smallest or largest value of some column. So no peak is
/// ever lost: min and max of every column over any bucket are those of the whole stream.
/// Values that are not finite are carried, but are nobody's extreme.
class DecimatedTable {
 public:
  /// `columns` besides x. Throws std::invalid_argument if there is none, or if
  /// max_rows is less than eight times their number.
  explicit DecimatedTable(size_t columns, size_t max_rows = 6000);

  /// x must not decrease. Throws std::invalid_argument if the number of values is wrong.
  void add(double x, const std::vector<double>& values);

  /// The next row is not joined to the last one.
  void add_gap();

  size_t rows_seen() const { return rows_seen_; }
  bool empty() const { return rows_seen_ == 0; }

  /// The rows kept, in order of x; `column[i]` belongs to `x[i]`. Gaps are rows of NaN.
  struct Rows {
    std::vector<double> x;
    std::vector<std::vector<double>> columns;
  };
  Rows rows() const;

 private:
  struct Row {
    size_t index = 0;  ///< position in the stream
    double x = 0;
    bool gap_before = false;
    std::vector<double> values;
  };
  struct Bucket {
    size_t rows_seen = 0;
    std::vector<Row> kept;  ///< in order of index
  };

  void start_bucket();
  std::set<size_t> extremes_of(const std::vector<Row>& rows) const;
  void thin(Bucket& bucket) const;
  void merge_neighbours();

  size_t columns_;
  size_t max_rows_;
  size_t rows_per_bucket_ = 1;
  size_t rows_seen_ = 0;
  size_t rows_in_full_buckets_ = 0;
  bool gap_pending_ = false;
  std::vector<Bucket> buckets_;
};

}  // namespace foucault::plot
