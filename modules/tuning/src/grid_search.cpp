#include "foucault/tuning/grid_search.h"

#include <algorithm>
#include <limits>
#include <set>

namespace foucault::tuning {
namespace {

/// Points that have been evaluated, and the best of them.
class Search {
 public:
  Search(const ParameterGrid& grid, const BatchObjective& objective)
      : grid_(grid), objective_(objective) {}

  /// Evaluates those that are new, in one batch, in the order of the grid.
  void evaluate(const std::set<GridPoint>& points) {
    std::vector<GridPoint> batch;
    for (const GridPoint& point : points) {
      if (result_.evaluated.count(point) == 0) batch.push_back(point);
    }
    if (batch.empty()) return;
    const std::vector<double> values = objective_(batch);
    for (std::size_t i = 0; i < batch.size(); ++i) result_.evaluated[batch[i]] = values[i];
    choose_best();
  }

  const ParameterGrid& grid() const { return grid_; }
  const GridSearchResult& result() const { return result_; }

 private:
  void choose_best() {
    const auto best =
        std::min_element(result_.evaluated.begin(), result_.evaluated.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    result_.best = best->first;
    result_.value = best->second;
  }

  const ParameterGrid& grid_;
  const BatchObjective& objective_;
  GridSearchResult result_;
};

/// Largest power of two that leaves at least three values of the axis; 1 if it has fewer.
std::size_t coarse_stride(const GridAxis& axis) {
  std::size_t stride = 1;
  while (axis.ordered && 4 * stride + 1 <= axis.values.size()) stride *= 2;
  return stride;
}

std::vector<std::size_t> strided(const GridAxis& axis, std::size_t stride) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < axis.values.size(); i += stride) indices.push_back(i);
  if (indices.back() + 1 != axis.values.size()) indices.push_back(axis.values.size() - 1);
  return indices;
}

/// Indices of an axis next to `at`, itself included; all of them if the axis is not ordered.
std::vector<std::size_t> next_to(const GridAxis& axis, std::size_t at, std::size_t stride) {
  if (!axis.ordered) return strided(axis, 1);
  const std::size_t last = axis.values.size() - 1;
  return {at - std::min(at, stride), at, std::min(at + stride, last)};
}

/// Every combination of the indices offered on each axis.
std::set<GridPoint> combinations(const std::vector<std::vector<std::size_t>>& indices) {
  std::set<GridPoint> points{{}};
  for (const std::vector<std::size_t>& of_axis : indices) {
    std::set<GridPoint> longer;
    for (const GridPoint& point : points) {
      for (const std::size_t index : of_axis) {
        GridPoint next = point;
        next.push_back(index);
        longer.insert(next);
      }
    }
    points = longer;
  }
  return points;
}

std::set<GridPoint> coarse_grid(const ParameterGrid& grid,
                                const std::vector<std::size_t>& strides) {
  std::vector<std::vector<std::size_t>> indices;
  for (std::size_t a = 0; a < grid.axes.size(); ++a) {
    indices.push_back(strided(grid.axes[a], strides[a]));
  }
  return combinations(indices);
}

/// Steps from a point along one axis at a time.
std::set<GridPoint> cross(const ParameterGrid& grid, const GridPoint& centre,
                          const std::vector<std::size_t>& strides) {
  std::set<GridPoint> points{centre};
  for (std::size_t a = 0; a < grid.axes.size(); ++a) {
    for (const std::size_t index : next_to(grid.axes[a], centre[a], strides[a])) {
      GridPoint point = centre;
      point[a] = index;
      points.insert(point);
    }
  }
  return points;
}

/// The neighbours of a point on all axes at once, corners included.
std::set<GridPoint> neighbourhood(const ParameterGrid& grid, const GridPoint& centre) {
  std::vector<std::vector<std::size_t>> indices;
  for (std::size_t a = 0; a < grid.axes.size(); ++a) {
    indices.push_back(next_to(grid.axes[a], centre[a], 1));
  }
  return combinations(indices);
}

/// Walks to a point that no step improves.
void descend(Search& search, const std::vector<std::size_t>& strides) {
  GridPoint centre;
  while (centre != search.result().best) {
    centre = search.result().best;
    search.evaluate(cross(search.grid(), centre, strides));
  }
}

}  // namespace

std::size_t ParameterGrid::size() const {
  std::size_t count = 1;
  for (const GridAxis& axis : axes) count *= axis.values.size();
  return count;
}

std::vector<GridPoint> ParameterGrid::points() const {
  std::vector<std::vector<std::size_t>> indices;
  for (const GridAxis& axis : axes) indices.push_back(strided(axis, 1));
  const std::set<GridPoint> all = combinations(indices);
  return {all.begin(), all.end()};
}

GridSearchResult full_search(const ParameterGrid& grid, const BatchObjective& objective) {
  Search search(grid, objective);
  const std::vector<GridPoint> points = grid.points();
  search.evaluate({points.begin(), points.end()});
  return search.result();
}

GridSearchResult coarse_to_fine_search(const ParameterGrid& grid, const BatchObjective& objective) {
  std::vector<std::size_t> strides;
  for (const GridAxis& axis : grid.axes) strides.push_back(coarse_stride(axis));
  Search search(grid, objective);
  search.evaluate(coarse_grid(grid, strides));
  while (*std::max_element(strides.begin(), strides.end()) > 1) {
    for (std::size_t& stride : strides) stride = std::max<std::size_t>(1, stride / 2);
    descend(search, strides);
  }
  GridPoint centre;
  while (centre != search.result().best) {
    centre = search.result().best;
    search.evaluate(neighbourhood(grid, centre));
    descend(search, strides);
  }
  return search.result();
}

std::vector<std::vector<double>> profile(const ParameterGrid& grid, const GridSearchResult& result,
                                         std::size_t x, std::size_t y) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::vector<double>> least(grid.axes[y].values.size(),
                                         std::vector<double>(grid.axes[x].values.size(), nan));
  for (const auto& [point, value] : result.evaluated) {
    double& cell = least[point[y]][point[x]];
    if (!(cell <= value)) cell = value;
  }
  return least;
}

}  // namespace foucault::tuning
