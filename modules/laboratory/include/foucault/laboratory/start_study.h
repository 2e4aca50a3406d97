#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/consistency.h"
#include "foucault/evaluation/drift_table.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/measurement/navigator.h"
#include "foucault/simulation/random_start.h"
#include "foucault/state/interfaces.h"

/// Whether a run finds into recordings that begin anywhere: random_start() drawn by seed, each
/// beside a bound, which is what a filter knows of the heading that is told the truth and learns
/// from the data alone how well that is known.
namespace foucault::laboratory {

struct StartOutcome {
  int64_t seed = 0;
  std::string what;  ///< "boat, RTK at 5 Hz, in motion, ADIS16465"
  /// Heading sigma of the bound [rad] after 60 and 120 s.
  double bound_60_s = 0, bound_120_s = 0;
  std::string refusal;  ///< why there is no start; empty if there is
  /// Heading of the run 60, 90 ... s after its first fix: error [rad] and sigma [rad].
  struct Heading {
    double after_s, error, sigma;
  };
  std::vector<Heading> headings;
  std::vector<std::string> warnings;  ///< of the recording, of which nothing is wrong

  bool determined() const;  ///< the bound is within 10 deg after 120 s
  bool started() const { return refusal.empty(); }
  double worst_normalized() const;
  /// A start where the data determine the heading, no start beyond 4 sigmas, and within 3 deg where
  /// the bound is within 1 deg after 60 s.
  bool is_right() const;
};

/// What the study does not know: estimators.
struct StartProgram {
  /// A filter for the bound.
  std::function<std::unique_ptr<measurement::Navigator>(const imu::ImuNoise& noise)> filter;
  /// A run with its alignment, for an IMU by preset. Throws DataError if there is no start.
  std::function<std::unique_ptr<state::Estimator>(
      const std::string& imu, const state::Mounting& mounting, state::Sink& sink)>
      run;
};

StartOutcome study_start(int64_t seed, const StartProgram& program);

/// A row a start.
evaluation::TextTable start_table(const std::vector<StartOutcome>& outcomes);

/// By kind of vehicle: starts, refusals, those that are right, normalized errors.
evaluation::TextTable start_summary(const std::vector<StartOutcome>& outcomes);

}  // namespace foucault::laboratory
