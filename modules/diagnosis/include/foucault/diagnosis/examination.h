#pragma once

#include <optional>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/fix_guard.h"
#include "foucault/diagnosis/gnss_options.h"
#include "foucault/diagnosis/imu_guard.h"
#include "foucault/diagnosis/judgement.h"
#include "foucault/diagnosis/plausibility.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"

/// What is wrong with a recording.
namespace foucault::diagnosis {

/// The one look that every sample and fix gets before any state is concerned: whether it can be
/// used, what it tells of the recording, and whether the recording is of any use. `foucault check`
/// feeds it alone; a run feeds it as its intake, and asks for its warnings at the end. Memory does
/// not grow with the recording.
class Examination {
 public:
  Examination(const imu::ImuNoise& configured, const state::Mounting& mounting,
              const GnssOptions& gnss = {});

  /// What may be used of it.
  ImuGuard::Verdict admit(const ImuIncrement& increment);
  FixGuard::Verdict admit(const GnssFix& fix);
  void admit(const ReferencePose& pose) { reference_.add(pose); }
  /// A fix that the caller has left out for a reason of its own is one of the stream, no more.
  void count(const GnssFix& fix) { gnss_.add(fix.t_ns); }
  /// The same where nothing is used.
  void add(const Measurement& measurement);

  /// After an increment. Throws DataError, see Plausibility.
  void throw_if_useless() { plausibility_.throw_if_useless(); }

  const ImuGuard& imu_guard() const { return imu_guard_; }
  const FixGuard& fix_guard() const { return fix_guard_; }

  LogFacts facts() const;
  std::vector<Finding> findings() const { return judge(facts(), configured_); }
  /// Those that are not well, stamped where the IMU begins, but for samples and fixes that were
  /// left out, which a run names itself.
  std::vector<state::Notice> warnings() const;

 private:
  imu::ImuNoise configured_;
  GnssOptions options_;
  ImuGuard imu_guard_;
  FixGuard fix_guard_;
  StreamWatch imu_, gnss_;
  SigmaFacts sigmas_;
  std::optional<double> lever_arm_;
  bool lever_arm_known_ = false;
  RestWatch rest_;
  CommutationWatch commutation_;
  ReferenceWatch reference_;
  VelocityWatch velocities_;
  Plausibility plausibility_;
};

}  // namespace foucault::diagnosis
