#pragma once

#include <cstdint>

namespace foucault::diagnosis {

/// How many of a kind, and the first.
struct Tally {
  int64_t count = 0;
  int64_t first_ns = 0;

  void add(int64_t t_ns) {
    if (count++ == 0) first_ns = t_ns;
  }
};

}  // namespace foucault::diagnosis
