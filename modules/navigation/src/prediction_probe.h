#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/measurement/navigator.h"
#include "foucault/state/result.h"

namespace foucault::navigation {

/// Predicts fixes further ahead than the next one: now and then a copy of the navigator drives on
/// without fixes, and those after 5, 15 and 30 s tell its errors by its own covariance. Probes
/// follow one another and do not overlap: their errors come from different noise of the IMU.
class PredictionProbe {
 public:
  /// After the navigator has propagated over it.
  void propagate(const ImuIncrement& increment);

  /// A fix at the current time that the navigator has used: its prediction where a horizon ends, at
  /// most a fifth late. A probe starts here if it is time.
  std::optional<state::PredictionResult> meet(const GnssFix& fix,
                                              const measurement::Navigator& navigator);

  /// The navigator starts anew.
  void restart() { ahead_.reset(); }

 private:
  std::optional<state::PredictionResult> compare(const GnssFix& fix);

  std::unique_ptr<measurement::Navigator> ahead_;
  int64_t begin_ns_ = 0;           ///< of the probe, or of the last one
  std::size_t horizon_ = 0;        ///< index of the one that ends next
  std::optional<int64_t> due_ns_;  ///< when the next probe starts
};

}  // namespace foucault::navigation
