#pragma once

#include <optional>
#include <vector>

#include "foucault/calibration/prediction.h"

/// Noise from the recording itself.
namespace foucault::calibration {

struct LearnOptions {
  std::vector<NoiseAxis> axes;
  double told_within = 10;  ///< factor within which the told noise is right, 1 sigma
  /// Errors of fixes last and errors of an IMU are richer than its model: a noise that fits from
  /// fix to fix can be wrong over a minute. All horizons, and that of the next fix, count alike.
  std::vector<double> horizons_s = {5, 15, 30, 60};
  /// Of predictions, at least 5 s and at most 60 s apart; a quarter of them until the top is near.
  int starts = 60;
  bool profile = false;  ///< of each axis
  /// Also with a part of the errors of positions that lasts (Gauss-Markov).
  bool lasting = false;
};

/// One number that was to be learned.
struct LearnedAxis {
  NoiseAxis axis;
  double told = 0, value = 0;
  double log_sigma = 0;    ///< of the logarithm, by the curvature of the likelihood
  bool observable = true;  ///< the recording tells at least half of what is known of it
  /// Logarithm of the likelihood over that of the value, by factors of the value, all else as it
  /// is.
  std::vector<double> profile_factors, profile;
};

/// The Gauss-Markov part of the errors of positions.
struct LastingErrors {
  double sigmas = 0;  ///< in sigmas that were told
  double tau_s = 0;
};

struct Learned {
  /// For estimators that know white errors of fixes alone. Where errors of fixes last, `fix_white`
  /// is the most likely one with all else as it is, which was learned beside the part that lasts.
  NoiseModel noise;
  std::optional<LastingErrors> lasting;
  std::vector<LearnedAxis> axes;
  double gain = 0;  ///< over the told noise, as gain_of()
  int passes = 0;
  std::vector<NormalizedError> before, after;  ///< with the told and with the learned noise
};

/// What there is to learn from the ways.
struct NoiseAxes {
  std::vector<NoiseAxis> told;     ///< IMU, and fixes
  std::vector<NoiseAxis> of_aids;  ///< what nobody tells: slip, wheels

  std::vector<NoiseAxis> all() const;
};
NoiseAxes axes_of(const std::vector<RecordedWay>& ways);

/// Maximum of the densities of all predictions, times a log-normal prior about what was told, by
/// Fisher's scoring: gradient and information from the derivatives of errors and covariances
/// (differences), as of independent predictions, a quarter of a minute apart. Variations of biases
/// that are far too small leave no slope, so that it is also started from large ones.
/// Receivers filter: next to one another their errors hardly differ, over a minute they do. With
/// white errors alone, such fixes look a hundred times better than they are, and what they do over
/// a minute like noise of the accelerometers. So with options.lasting a Gauss-Markov part is
/// learned beside, and kept where chance would explain as much once in ten thousand times. Ways are
/// of one vehicle. Deterministic.
Learned learn(const std::vector<RecordedWay>& ways, const NoiseModel& told,
              const LearnOptions& options);

/// How much more likely one noise makes the fixes than another: of the next fixes, and of those at
/// each horizon, the largest gain of the logarithm of densities, where predictions that overlap
/// count as one. Twice that is about a chi-square of as many degrees of freedom as numbers were
/// learned, if `noise` was right.
double gain_of(const std::vector<RecordedWay>& ways, const NoiseModel& noise,
               const NoiseModel& other, const LearnOptions& options);

}  // namespace foucault::calibration
