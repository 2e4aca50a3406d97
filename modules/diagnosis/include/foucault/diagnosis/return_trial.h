#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/measurement/navigator.h"

namespace foucault::diagnosis {

/// A fix is true, or an outlier, of which there is one in a hundred: which is likelier, and how
/// likely that is.
struct FixLikelihood {
  bool is_true = false;
  double log_density = 0;
};
FixLikelihood likelihood_of(const state::Innovation& innovation);

/// A noise model is off by a factor of ten now and then, the errors of a consumer IMU in curves by
/// more. The prior of a scale falls as 1 / scale.
constexpr double kLargestScale = 512;

/// What the first fixes after an outage say: is the prediction as good as its covariance, worse by
/// some factor, or are the fixes in error?
///
/// A state that has drifted has an error of velocity that goes with that of position: both grow
/// from the same tilt and rates. Fixes in error (a wrong ambiguity, a reflection) are off in
/// position alone. So copies of the navigator are driven on under each hypothesis, and their
/// likelihoods are compared:
/// - the covariance is scale^2 times what it was, the noise model being in doubt: correlations of
///   position and velocity stay;
/// - the fixes share an offset: position, and nothing else, is loosened by it.
/// In each, single fixes may be outliers, but not most of them. The recording is right until the
/// contrary is shown: an offset is believed if it is a hundred times as likely as the best of the
/// others, and a thousand times where nothing that follows confirms it.
class ReturnTrial {
 public:
  struct Verdict {
    bool offset = false;     ///< the fixes are in error
    bool certainly = false;  ///< even if they do not jump back in sight
    double scale = 1;        ///< of the state's sigmas, if they are not
    std::vector<bool> used;  ///< which fixes are no outliers then, in order
  };

  /// `level`: what the variances of fixes are to be multiplied by. The first fix is the next one.
  ReturnTrial(const measurement::Navigator& navigator, const GnssFix& first, double level);

  void propagate(const ImuIncrement& increment);
  void add(const GnssFix& fix);

  /// There are enough fixes.
  bool is_over() const;
  Verdict verdict() const;

 private:
  struct Hypothesis {
    std::unique_ptr<measurement::Navigator> navigator;
    double scale = 1;
    bool offset = false;
    double log_probability = 0;
    std::vector<bool> used;
  };

  void add_scale(const measurement::Navigator& navigator, double scale);
  void add_offset(const measurement::Navigator& navigator, double variance);
  const Hypothesis& best_scale() const;
  static void try_fix(Hypothesis& hypothesis, const GnssFix& fix);

  double level_;
  int64_t begin_ns_;
  int64_t last_ns_;
  std::vector<Hypothesis> hypotheses_;
};

}  // namespace foucault::diagnosis
