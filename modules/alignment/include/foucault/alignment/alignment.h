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
  double min_rest_s = 3;            ///< shorter, a rest is not used
  double max_rest_s = 300;          ///< how far back a start may lie; bounds the memory

  void fields(ConfigFields& f) override;
};

/// Finds an initial state from increments and fixes, with no attitude given by hand.
///
/// With rest (steady 1 s means of both sensors while GNSS does not move): roll and pitch from the
/// mean specific force, gyroscope bias from the mean rate. The attitude is carried on by the
/// gyroscopes until several courses in a row, of straight and fast driving, agree about the
/// heading. The start lies at the first fix of the rest, velocity zero. Without rest: over a
/// straight stretch, the mean specific force turned into the last body frame is the GNSS
/// acceleration minus gravity there, and the forward axis points along the velocity (TRIAD). The
/// start lies at the end of the stretch. Mode `given`: starts at the first fix, with the given
/// angles.
///
/// The covariance carries what the errors share: a level found at rest errs by bias over gravity,
/// the gyroscope bias by the Earth rate that a wrong attitude projects.
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
  /// manoeuvre may be the reason, for half a minute of driving.
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
