#pragma once

#include <deque>
#include <memory>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/fix_doubt.h"
#include "foucault/diagnosis/gnss_options.h"

namespace foucault::navigation {

/// The phase in which a fix is in doubt: what follows is held back until it shows whether the fixes
/// or the state are wrong.
class Doubting {
 public:
  /// `doubted`: as it came. `doubt` knows it already.
  Doubting(const GnssFix& doubted, std::unique_ptr<diagnosis::FixDoubt> doubt,
           const diagnosis::GnssOptions& options)
      : doubted_(doubted), doubt_(std::move(doubt)), options_(options) {}

  /// For the doubt alone: a fix that waits elsewhere.
  void show(const GnssFix& fix) { show_doubt(fix); }
  /// Holds it back. True once the doubt is decided.
  bool take(const Measurement& measurement);

  const GnssFix& doubted() const { return doubted_; }
  diagnosis::DoubtOutcome outcome() { return doubt_->outcome(); }
  /// What was held back, in order.
  const std::deque<Measurement>& held() const { return held_; }

 private:
  bool show_doubt(const Measurement& measurement);

  GnssFix doubted_;
  std::unique_ptr<diagnosis::FixDoubt> doubt_;
  diagnosis::GnssOptions options_;
  std::deque<Measurement> held_;
};

}  // namespace foucault::navigation
