#pragma once

#include <memory>
#include <optional>
#include <string>

#include "foucault/core/config.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"

namespace foucault::alignment {

/// Section `alignment` of the configuration. Angles are the vehicle's (forward-right-down).
class AlignmentOptions : public Configurable {
 public:
  std::string mode = "auto";                               ///< auto | given
  std::optional<double> roll_deg, pitch_deg, heading_deg;  ///< in auto: overrides what is found
  double roll_sigma_deg = 0.5, pitch_sigma_deg = 0.5, heading_sigma_deg = 1.0;  ///< of given angles
  double min_rest_s = 3;    ///< shorter, a rest is not used
  double max_rest_s = 300;  ///< how far back a start may lie; bounds the memory

  void fields(ConfigFields& f) override;
};

/// Finds an initial state from increments and fixes, with no attitude given by hand, of anything
/// that moves: it need not go along its nose, nor fast, nor straight.
///
/// A coarse level comes from rest, or from the first fixes and the forces between them. Filters
/// that differ in the heading then drive side by side; the fixes tell by their likelihood which of
/// them is right, and each what it does not know yet. Once one heading is known to 1 deg (after 60
/// s of motion to 3, after 120 s to 10) it is carried back by the gyroscopes: the start lies at the
/// first fix, of the rest if there was one, up to max_rest_s before. Where nothing but straight and
/// steady motion is in the data, the course is taken, as good as 10 deg. With heading_deg given, a
/// rest or a stretch of 4 s is enough. Mode `given`: starts at the first fix, with the given
/// angles.
///
/// What was found is given out with three times its sigma, as the run uses the same data again. The
/// covariance carries what the errors share: a level errs by bias over gravity, the gyroscope bias
/// of a rest by the Earth rate that a wrong attitude projects. Biases beyond their priors widen
/// these.
///
/// Cost: twelve filters of 50 steps and up to 5 fixes a second until the heading is known, and a
/// few passes of one over what is held.
class Aligner {
 public:
  /// Throws UsageError if mode `given` lacks an angle.
  /// `layout`: what is estimated, as far as the alignment has to do with it.
  Aligner(const AlignmentOptions& options, const imu::ImuNoise& noise,
          const state::Mounting& mounting, const state::Layout& layout = {});
  ~Aligner();
  Aligner(Aligner&&) noexcept;
  Aligner& operator=(Aligner&&) noexcept;

  /// Throw DataError if the axes must be wrong: up is none of the vehicle's up, at rest or, where a
  /// manoeuvre may be the reason, on the mean over half a minute.
  /// In the order of Measurement. Fixes must have a finite position and a positive definite
  /// covariance; increments must not overlap.
  void add(const GnssFix& fix);
  void add(const ImuIncrement& increment);

  /// Nothing follows: the last chance for a start.
  void finish();

  /// The state to start from once it is known; its stamp may lie in the past.
  const std::optional<state::Epoch>& initial() const;
  /// How it was found, one line.
  std::string summary() const;

  /// No start will lie before this stamp.
  int64_t earliest_start_ns() const;

  /// Why there is no initial state yet, and what to do about it; one line.
  std::string why_not() const;

  /// Forgets everything.
  void restart();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace foucault::alignment
