#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "foucault/evaluation/drift_table.h"
#include "foucault/evaluation/outage_run.h"
#include "foucault/imu/imu_noise.h"

/// Whether true fixes are believed when they return after an outage, however wrong the noise model
/// is: each run beside the same with the gate off, which believes everything.
namespace foucault::laboratory {

struct ReturnCase {
  std::string log;       ///< a rawlog; empty: a simulated trip
  double noise = 1;      ///< what all sigmas of the IMU are configured by, times what they are
  double length_s = 60;  ///< of the outages
  std::string method;
};

struct ReturnOutcome {
  ReturnCase what;
  int64_t outages = 0;
  double drift_m = 0;    ///< RMS of the largest horizontal drift of each outage
  double control_m = 0;  ///< the same with the gate off
  int64_t left_out = 0;  ///< fixes
  double longest_s = 0;  ///< the longest time from one that was left out to the next used one
  std::string error;     ///< why nothing came out

  double ratio() const { return drift_m / control_m; }
};

struct ReturnMethod {
  evaluation::EstimatorFactory make;
  double keep_references_s = 600;
};

/// What the study does not know: recordings and estimators.
struct ReturnProgram {
  evaluation::OutageOptions outages;  ///< of recordings
  imu::ImuNoise noise;                ///< of the simulated trip
  std::function<std::unique_ptr<state::Source>(const std::string& log)> open;
  /// The method of a case, configured by its noise, with the gate or without.
  std::function<ReturnMethod(const ReturnCase& what, bool gate)> method;
};

/// The simulated trip: city, ADIS16465 at 200 Hz, RTK at 1 Hz, 900 s. Outages begin after 200 s and
/// leave 60 s between them.
ReturnOutcome study_return(const ReturnCase& what, const ReturnProgram& program);

/// A row a case.
evaluation::TextTable return_table(const std::vector<ReturnOutcome>& outcomes);

/// For each length and noise the worst of the methods.
evaluation::TextTable return_summary(const std::vector<ReturnOutcome>& outcomes);

}  // namespace foucault::laboratory
