#pragma once

#include <functional>
#include <string>
#include <vector>

#include "console.h"
#include "foucault/evaluation/experiment.h"
#include "foucault/evaluation/point_store.h"
#include "tune_job.h"

namespace foucault::app {

/// Computes the scores of points in parallel, unless they are already in the store.
class PointScorer {
 public:
  /// All must outlive this.
  PointScorer(const TuneJob& job, PointStore& store, Console& console);

  /// In the order of `points`. A point of which a run fails has a note and infinite drifts.
  /// Throws DataError if no outage fits into a log.
  std::vector<PointScore> scores(const std::string& method, const std::vector<GridPoint>& points);

  /// Columns of points.csv, and how many of them name a point.
  static std::vector<std::string> header(const ParameterGrid& grid);
  static std::size_t key_columns(const ParameterGrid& grid) { return 1 + grid.axes.size(); }

 private:
  std::vector<std::string> key(const std::string& method, const GridPoint& point) const;
  void compute(const std::string& method, const std::vector<GridPoint>& points);

  const TuneJob& job_;
  PointStore& store_;
  Console& console_;
};

}  // namespace foucault::app
