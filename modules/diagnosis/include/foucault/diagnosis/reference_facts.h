#pragma once

#include <cstdint>
#include <optional>

#include "foucault/core/measurement.h"

namespace foucault::diagnosis {

/// Where a reference trajectory lies.
struct ReferenceFacts {
  int64_t compared = 0;  ///< poses within half a second of a fix
  int64_t far = 0;       ///< of these, further from it than kElsewhere
  double rms_m = 0;      ///< of the horizontal distances, lever arm included
  bool moved = false;    ///< to the stamps of the fixes, by the velocities of the poses
};

/// Collects them.
class ReferenceWatch {
 public:
  void add(const GnssFix& fix) { fix_ = fix; }
  void add(const ReferencePose& pose);
  ReferenceFacts facts() const;

 private:
  std::optional<GnssFix> fix_;
  int64_t compared_ = 0, far_ = 0, moved_ = 0;
  double squares_ = 0;
};

}  // namespace foucault::diagnosis
