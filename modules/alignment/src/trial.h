#pragma once

#include <cstddef>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/ekf/ekf.h"
#include "foucault/state/epoch.h"
#include "foucault/state/layout.h"

namespace foucault::alignment {

/// How well fixes agree with a filter: sums of squared innovations by their covariances S, and of
/// log det S.
struct Agreement {
  double squares = 0, log_determinants = 0;
  /// -2 log likelihood of the fixes, if all covariances are `level` times as large.
  double misfit(double level) const { return squares / level + log_determinants; }
};

/// A filter that drives ahead from a state that may be true, and how well the fixes agree with it.
/// A fix that stands out of the others is left out once; if the next one does as well, it was the
/// state.
class Trial {
 public:
  Trial(const imu::ImuNoise& noise, const state::Layout& layout, const state::Epoch& start);

  void propagate(const ImuIncrement& increment);
  void update(const GnssFix& fix);

  state::Epoch epoch() const { return navigator_.epoch(); }

  /// How much larger than their covariance the squares of innovations are: by their median over
  /// that of chi-square, at least 1.
  double level() const;
  const Agreement& agreement() const { return agreement_; }
  /// Level of the first half of the squares that are kept, per that of the second.
  double settling() const;

 private:
  void use(const measurement::ObservationPtr& observation);

  ekf::EkfNavigator navigator_;
  imu::RecentRates rates_{0.2};
  std::vector<double> recent_;  ///< squares, of three degrees of freedom
  std::size_t next_ = 0;
  Agreement agreement_;
  bool left_out_ = false;  ///< the last one
};

}  // namespace foucault::alignment
