#pragma once

#include <algorithm>
#include <vector>

namespace foucault {

/// The upper one of the middle two where their number is even. Precondition: there are values.
template <class Value>
Value median(std::vector<Value> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace foucault
