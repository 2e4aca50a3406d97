#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "foucault/evaluation/drift.h"

/// Outages of one method, as tables and figures need them.
namespace foucault::evaluation {

/// Times after the beginning of an outage at which errors are normalized [s].
const std::vector<double>& normalized_marks_s();

/// Numbers that are summed up and not kept.
struct Sum {
  int64_t count = 0;
  double total = 0;

  void add(double value) { ++count, total += value; }
  double mean() const { return total / static_cast<double>(count); }
};

/// An outage with its samples, for figures.
struct DrawnOutage {
  std::string recording;
  double shift_s = 0;
  OutageDrift drift;
};

/// A place of a table: all outages of one method in one group. Of each its largest drifts and where
/// it was are kept (24 bytes, 32 with a return), of all else sums. Copies share what is kept.
class MethodOutages {
 public:
  /// Normalized errors near a time of the outages.
  struct AtTime {
    Sum after_s;  ///< of outages with a sample there
    Sum horizontal, vertical;
  };
  struct SquaredDrift {
    Sum horizontal, vertical;  ///< [m^2]
  };

  MethodOutages(std::string group_name, std::string method_name,
                std::vector<double> horizontal_max_m = {}, std::vector<double> vertical_max_m = {});

  void add(const OutageDrift& drift);

  std::size_t size() const { return kept_->horizontal_max.size(); }
  bool empty() const { return size() == 0; }
  /// [m]; the same outages in the same order for each method.
  const std::vector<double>& horizontal_max() const { return kept_->horizontal_max; }
  const std::vector<double>& vertical_max() const { return kept_->vertical_max; }
  /// See OutageDrift.
  const std::vector<double>& distance_m() const { return kept_->distance_m; }
  /// Of returns that settled, see ReturnError.
  const std::vector<double>& settled_s() const { return kept_->settled_s; }

  std::string group;
  std::string method;
  std::vector<SquaredDrift> at_marks;    ///< as OutageDrift::at_marks
  std::array<AtTime, 5> normalized;      ///< at normalized_marks_s(), and in the middle
  Sum returned_m2;                       ///< mean square of each return [m^2]
  double largest_return_m = 0;           ///< horizontal
  double shortest_s = 0, longest_s = 0;  ///< lengths of outages
  /// Some of them, evenly; all if they are few. The same ones for each method of a group.
  std::vector<std::shared_ptr<const DrawnOutage>> drawn;
  int64_t measured = 0;  ///< outages, those too that another method lacks
  int64_t missing = 0;   ///< scheduled outages in which this method gave nothing to measure
  double cpu_s = 0;      ///< of all its runs

 private:
  struct Kept {
    std::vector<double> horizontal_max, vertical_max, distance_m, settled_s;
  };

  std::shared_ptr<Kept> kept_;
};

}  // namespace foucault::evaluation
