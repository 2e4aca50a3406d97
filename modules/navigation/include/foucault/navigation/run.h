#pragma once

#include <cstdint>

#include "foucault/measurement/observation.h"
#include "foucault/state/interfaces.h"

namespace foucault::navigation {

/// An estimator that also uses what no Measurement says: measurements of one's own, as functions of
/// the state.
class Run : public state::Estimator {
 public:
  /// At its stamp, if it passes the chi-square test of its own dimension; the sink is told. Comes
  /// before the increment that reaches or passes the stamp; what comes later, or is of before the
  /// start, is left out. It does not count as a fix: where fixes are in doubt it waits with them,
  /// and has no say. Throws std::invalid_argument for none.
  virtual void observe(int64_t t_ns, const measurement::ObservationPtr& observation) = 0;
};

}  // namespace foucault::navigation
