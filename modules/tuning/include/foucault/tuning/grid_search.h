#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// Search over a grid of parameters, the paper's way of tuning.
namespace foucault::tuning {

/// Values of one parameter, as they are written in a configuration.
struct GridAxis {
  std::string key;
  std::vector<std::string> values;
  /// Neighbouring values do alike, as numbers in order do; names do not.
  bool ordered = true;
};

/// An index into the values of each axis.
using GridPoint = std::vector<std::size_t>;

struct ParameterGrid {
  std::vector<GridAxis> axes;

  std::size_t size() const;
  /// All points, the last axis running fastest.
  std::vector<GridPoint> points() const;
};

/// What is to be minimized, for many points at once, so that they can be computed in parallel.
/// Returns a value for each, infinite where there is none.
using BatchObjective = std::function<std::vector<double>(const std::vector<GridPoint>&)>;

struct GridSearchResult {
  GridPoint best;  ///< of equal ones the first in the order of ParameterGrid::points()
  double value = 0;
  std::map<GridPoint, double> evaluated;
};

/// Every point of the grid.
GridSearchResult full_search(const ParameterGrid& grid, const BatchObjective& objective);

/// Coarse to fine: first a grid with strides (every 2^k-th value of an axis and its last, three to
/// five of them), then from its best point steps along the axes until none is better, with strides
/// halved down to 1, at last the diagonal neighbours, too. Finds the optimum of an objective with
/// one valley; with several it may end in another one than full_search. Axes that are not ordered
/// are taken in full throughout.
GridSearchResult coarse_to_fine_search(const ParameterGrid& grid, const BatchObjective& objective);

/// The least value over all other parameters for each pair of values of two axes:
/// [row of axis `y`][column of axis `x`]; NaN where nothing was evaluated.
std::vector<std::vector<double>> profile(const ParameterGrid& grid, const GridSearchResult& result,
                                         std::size_t x, std::size_t y);

}  // namespace foucault::tuning
