#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <variant>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/measurement/observation.h"

namespace foucault::navigation {

/// A measurement of one's own, see Run.
struct Observed {
  int64_t t_ns = 0;
  measurement::ObservationPtr observation;
};

/// What a run stops for between increments.
using StopEvent = std::variant<GnssFix, EpochRequest, Observed>;

/// When to stop: at fixes, requests and what else was measured, as far as they are known, and for a
/// hold wherever node_interval has passed since the last node (what was used, hold, or start).
class StopQueue {
 public:
  /// node_interval [s]
  explicit StopQueue(double node_interval);

  /// A run starts at this stamp; what is pending from there on stays.
  void start(int64_t t_ns);
  void add(const StopEvent& event);

  /// The next stop up to end_ns, later than now.
  std::optional<int64_t> next(int64_t now_ns, int64_t end_ns) const;
  /// The first event that is due now, taken out.
  std::optional<StopEvent> take_due(int64_t now_ns);
  bool hold_is_due(int64_t now_ns) const { return now_ns >= hold_due_ns(); }

  void fix_used(int64_t now_ns);
  void held(int64_t now_ns) { last_node_ns_ = now_ns; }

  std::optional<int64_t> last_fix_ns() const { return last_fix_ns_; }  ///< that was used
  double fix_interval() const;  ///< between the last two that were used [s]; 0: not known
  std::vector<GnssFix> pending_fixes() const;

  /// Measurements that are pending, in order of stamps, taken out; what is known of fixes is
  /// forgotten.
  std::vector<Measurement> clear();

 private:
  int64_t hold_due_ns() const;

  int64_t node_interval_ns_;
  std::multimap<int64_t, StopEvent> pending_;  ///< by stamp
  int64_t last_node_ns_ = 0;
  std::optional<int64_t> last_fix_ns_;
  int64_t fix_interval_ns_ = 0;
};

int64_t stamp(const StopEvent& event);

}  // namespace foucault::navigation
