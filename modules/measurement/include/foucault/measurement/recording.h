#pragma once

#include <cstddef>
#include <deque>

#include "foucault/state/epoch.h"

namespace foucault::measurement {

/// The solution at a node from everything measured.
struct SmoothedEpoch {
  state::NavState state;
  state::PackedSymmetric covariance;
  /// The errors it found: in the forward run's state before the node's measurements, and after
  /// them; the same where there are none.
  state::NodeVector before = state::NodeVector::Zero();
  state::NodeVector after = state::NodeVector::Zero();

  state::Epoch epoch() const { return {state, covariance.full()}; }
};

/// A Navigator that leaves nodes on its way, for smoothing once the way is over.
class Recording {
 public:
  virtual ~Recording() = default;

  /// Makes sure that there is a node at the current time; gives its index.
  virtual std::size_t mark() = 0;
  virtual bool at_node() const = 0;
  virtual std::size_t size() const = 0;

  /// The next nodes, in order, that need not wait for the end; a recording that is smoothed as a
  /// whole has none. May be called after everything above.
  virtual std::deque<SmoothedEpoch> settled() { return {}; }

  /// One a node, in order, those that were settled left out. Called once, at the end.
  virtual std::deque<SmoothedEpoch> smoothed() = 0;
};

}  // namespace foucault::measurement
