#include "map_unit.h"

#include <algorithm>
#include <cmath>

namespace foucault::content {

using namespace plot;

namespace {

constexpr double kFarFromStart = 20e3;  // [m]

bool reaches_far(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(),
                     [](double v) { return std::abs(v) > kFarFromStart; });
}

}  // namespace

void choose_map_unit(Panel& panel) {
  const bool far = std::any_of(panel.series.begin(), panel.series.end(), [](const Series& series) {
    return reaches_far(series.x) || reaches_far(series.y);
  });
  if (!far) return;
  for (Axis* axis : {&panel.x, &panel.y}) {
    axis->shown_unit = "km";
    axis->shown_factor = 1e-3;
  }
}

}  // namespace foucault::content
