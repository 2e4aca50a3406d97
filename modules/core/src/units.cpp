#include "foucault/core/units.h"

#include <fmt/format.h>

#include "foucault/core/time.h"

namespace foucault::units {

std::string format_stamp(int64_t t_ns) {
  const int64_t magnitude = t_ns < 0 ? -t_ns : t_ns;
  return fmt::format("{}{}.{:09}", t_ns < 0 ? "-" : "", magnitude / kNanosecondsPerSecond,
                     magnitude % kNanosecondsPerSecond);
}

}  // namespace foucault::units
