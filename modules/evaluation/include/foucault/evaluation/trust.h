#pragma once

#include <cstdint>

#include "foucault/core/consistency.h"
#include "foucault/state/result.h"

/// Whether a run can be believed, judged from what was kept: the innovations of used fixes and the
/// states that were given out. How many fixes were rejected does not matter.
namespace foucault {

/// States that were given out.
struct StateCount {
  int64_t given_out = 0;
  int64_t begin_ns = 0;  ///< stamp of the first
  int64_t not_finite = 0;
  int64_t first_not_finite_ns = 0;
};

/// Every number of it, covariance included.
bool is_finite(const Epoch& epoch);

/// Of what a run amounts to. The size of innovations is the root of mean NIS / 3, 1 if their
/// covariances are right.
/// - Condemned: a size above 3, also of the horizontal components alone, or below 0.3; a state that
/// is not finite; fewer than ten used fixes.
/// - Named: a size above 1.5 or below 0.5; a stretch above 3.
/// A size counts only if the mean is outside the band in which that of as many independent
/// innovations as these are worth lies with 99.9 %.
Trust trust_in(const Consistency& consistency, const StateCount& states);

}  // namespace foucault
