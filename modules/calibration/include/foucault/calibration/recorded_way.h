#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/state/epoch.h"

namespace foucault::calibration {

/// A start, and what was measured on the way from it: to be gone again, often and quickly.
struct RecordedWay {
  state::Epoch start;
  std::vector<ImuIncrement> increments;  ///< each begins where the last ended
  std::vector<GnssFix> fixes;            ///< in order of stamps, later than the start
};

/// Keeps the way of a run. Increments are summed up to 20 ms, within which only vibration turns;
/// a missing second and less is bridged by the rates before it, with noise of as much; at more, or
/// after half an hour, or where increments do not follow each other, the way ends. 100 bytes each:
/// 9 MB in all at most.
class WayRecorder {
 public:
  /// Every epoch of the run. The start is the first one a minute after the run's, when attitude and
  /// biases are settled and a filter is as linear as it takes itself to be; of a shorter run the
  /// first.
  void epoch(const state::Epoch& epoch);
  /// What came before the start, too, since a run finds its start late.
  void add(const Measurement& measurement);
  /// A fix that the run used.
  void used(int64_t t_ns) { used_.push_back(t_ns); }

  /// None without a start.
  std::optional<RecordedWay> way() const;

 private:
  void add(const ImuIncrement& increment);
  void bridge(const ImuIncrement& next);

  std::optional<state::Epoch> start_;
  bool settled_ = false;
  std::vector<ImuIncrement> increments_;
  std::vector<GnssFix> fixes_;
  std::vector<int64_t> used_;
  bool ended_ = false;
};

}  // namespace foucault::calibration
