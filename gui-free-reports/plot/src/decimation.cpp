#include "foucault/plot/decimation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace foucault::plot {

DecimatedTable::DecimatedTable(size_t columns, size_t max_rows)
    : columns_(columns), max_rows_(max_rows) {
  if (columns == 0) throw std::invalid_argument("DecimatedTable: no columns");
  if (max_rows < 8 * columns) throw std::invalid_argument("DecimatedTable: max_rows too small");
}

void DecimatedTable::add(double x, const std::vector<double>& values) {
  if (values.size() != columns_) throw std::invalid_argument("DecimatedTable: columns differ");
  if (buckets_.empty() || buckets_.back().rows_seen == rows_per_bucket_) start_bucket();
  Bucket& bucket = buckets_.back();
  bucket.kept.push_back({rows_seen_++, x, gap_pending_, values});
  ++bucket.rows_seen;
  gap_pending_ = false;
  if (bucket.kept.size() > 4 * columns_) thin(bucket);
}

void DecimatedTable::add_gap() { gap_pending_ = rows_seen_ > 0; }

void DecimatedTable::start_bucket() {
  if (!buckets_.empty()) {
    thin(buckets_.back());
    rows_in_full_buckets_ += buckets_.back().kept.size();
  }
  while (rows_in_full_buckets_ + 4 * columns_ > max_rows_) merge_neighbours();
  if (buckets_.empty() || buckets_.back().rows_seen == rows_per_bucket_) {
    buckets_.emplace_back();
  } else {
    rows_in_full_buckets_ -= buckets_.back().kept.size();
  }
}

/// The rows that hold the smallest or the largest finite value of a column.
std::set<size_t> DecimatedTable::extremes_of(const std::vector<Row>& rows) const {
  std::set<size_t> extremes;
  for (size_t c = 0; c < columns_; ++c) {
    size_t lowest = rows.size();
    size_t highest = rows.size();
    for (size_t i = 0; i < rows.size(); ++i) {
      const double value = rows[i].values[c];
      if (!std::isfinite(value)) continue;
      if (lowest == rows.size() || value < rows[lowest].values[c]) lowest = i;
      if (highest == rows.size() || value > rows[highest].values[c]) highest = i;
    }
    if (lowest < rows.size()) extremes.insert({lowest, highest});
  }
  return extremes;
}

void DecimatedTable::thin(Bucket& bucket) const {
  if (bucket.kept.size() <= 2 * columns_) return;
  std::set<size_t> extremes = extremes_of(bucket.kept);
  if (extremes.empty()) extremes.insert(0);

  std::vector<Row> survivors;
  bool gap = false;
  for (size_t i = 0; i < bucket.kept.size(); ++i) {
    gap = gap || bucket.kept[i].gap_before;
    if (extremes.count(i) == 0) continue;
    survivors.push_back(std::move(bucket.kept[i]));
    survivors.back().gap_before = gap;
    gap = false;
  }
  survivors.back().gap_before = survivors.back().gap_before || gap;
  bucket.kept = std::move(survivors);
}

void DecimatedTable::merge_neighbours() {
  rows_per_bucket_ *= 2;
  rows_in_full_buckets_ = 0;
  std::vector<Bucket> merged;
  for (size_t i = 0; i < buckets_.size(); i += 2) {
    Bucket bucket = std::move(buckets_[i]);
    if (i + 1 < buckets_.size()) {
      Bucket& next = buckets_[i + 1];
      bucket.rows_seen += next.rows_seen;
      std::move(next.kept.begin(), next.kept.end(), std::back_inserter(bucket.kept));
    }
    thin(bucket);
    rows_in_full_buckets_ += bucket.kept.size();
    merged.push_back(std::move(bucket));
  }
  buckets_ = std::move(merged);
}

DecimatedTable::Rows DecimatedTable::rows() const {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  Rows rows;
  rows.columns.resize(columns_);
  for (const Bucket& bucket : buckets_) {
    for (const Row& row : bucket.kept) {
      if (row.gap_before && !rows.x.empty()) {
        rows.x.push_back((rows.x.back() + row.x) / 2);
        for (std::vector<double>& column : rows.columns) column.push_back(kNaN);
      }
      rows.x.push_back(row.x);
      for (size_t c = 0; c < columns_; ++c) rows.columns[c].push_back(row.values[c]);
    }
  }
  return rows;
}

}  // namespace foucault::plot
