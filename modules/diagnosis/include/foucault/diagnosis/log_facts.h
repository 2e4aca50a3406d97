#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/diagnosis/acceleration_match.h"
#include "foucault/diagnosis/commutation_facts.h"
#include "foucault/diagnosis/force_facts.h"
#include "foucault/diagnosis/reference_facts.h"
#include "foucault/diagnosis/rest_facts.h"
#include "foucault/diagnosis/sigma_facts.h"
#include "foucault/diagnosis/stream_facts.h"
#include "foucault/diagnosis/turn_match.h"
#include "foucault/diagnosis/velocity_facts.h"

namespace foucault::diagnosis {

/// What a recording shows without any state. Collected by Examination, judged by judge().
struct LogFacts {
  StreamFacts imu, gnss;
  std::vector<std::string> bad_samples;  ///< of the IMU, a line a kind: how many, the first
  std::vector<std::string> bad_fixes;    ///< the same of GNSS
  double overlap_s = 0;
  SigmaFacts sigmas;
  std::optional<double> lever_arm_m;  ///< of the first fix
  bool lever_arm_known = false;
  ForceFacts force;  ///< its mean forward, right, down
  RestFacts rest;
  CommutationFacts commutation;
  ReferenceFacts reference;
  VelocityFacts velocities;
  std::optional<TurnMatch> turns;
  std::optional<AccelerationFit> accelerations;
};

}  // namespace foucault::diagnosis
