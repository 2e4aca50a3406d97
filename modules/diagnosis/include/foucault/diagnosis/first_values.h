#pragma once

#include <cstddef>
#include <vector>

#include "foucault/core/median.h"

namespace foucault::diagnosis {

/// The first values of a stream, for their median: enough for it to 4 % (1.25 sigma / sqrt(n)).
class FirstValues {
 public:
  void add(double value) {
    if (!full()) values_.push_back(value);
  }
  /// 0 if there are none.
  double median() const { return values_.empty() ? 0 : foucault::median(values_); }
  bool full() const { return values_.size() == kMost; }
  std::size_t size() const { return values_.size(); }

 private:
  static constexpr std::size_t kMost = 1000;
  std::vector<double> values_;
};

}  // namespace foucault::diagnosis
