#pragma once

#include <cstdint>

#include "foucault/diagnosis/first_values.h"

namespace foucault::diagnosis {

/// Stamps of a stream.
struct StreamFacts {
  int64_t count = 0;
  int64_t first_ns = 0, last_ns = 0;
  double interval_s = 0;  ///< median of the first thousand
  int64_t holes = 0;      ///< see core/hole.h
  double longest_hole_s = 0;
};

/// Collects them. Holes are counted by the median known so far; it settles within seconds.
class StreamWatch {
 public:
  void add(int64_t t_ns);
  const StreamFacts& facts() const { return facts_; }

 private:
  void learn(double interval);

  StreamFacts facts_;
  FirstValues intervals_;
};

}  // namespace foucault::diagnosis
