#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/core/time.h"
#include "foucault/diagnosis/fix_judge.h"
#include "foucault/diagnosis/innovation_line.h"
#include "foucault/measurement/navigator.h"
#include "foucault/state/epoch.h"
#include "foucault/state/kalman.h"

namespace foucault::diagnosis {

struct FixDecision {
  enum class Action { use, leave_out, use_corrected };
  Action action = Action::use;
  GnssFix fix;        ///< as it was
  GnssFix corrected;  ///< for use_corrected: less the line, with its variance
};

/// What became of a doubt.
struct DoubtOutcome {
  std::vector<FixDecision> fixes;             ///< from the one that raised it on, in order
  std::optional<state::NodeMatrix> loosened;  ///< what the state is to be loosened by before it
  bool state_was_wrong = false;
  std::vector<double> level;         ///< normalized squares that fixes were found to have
  std::vector<std::string> notices;  ///< one line each
};

/// A copy of the navigator that drives ahead from where a doubt begins, and can begin once more.
class Lookahead {
 public:
  explicit Lookahead(const measurement::Navigator& navigator);

  void propagate(const ImuIncrement& increment);

  measurement::Navigator& navigator() { return *ahead_; }
  const measurement::Navigator& navigator() const { return *ahead_; }
  state::Epoch epoch() const { return ahead_->epoch(); }

  /// One more from the beginning, with sigmas `scale` times what they were.
  std::unique_ptr<measurement::Navigator> again(double scale) const { return start_->ahead(scale); }
  /// All increments, each ends at the next fix at the latest.
  const std::vector<ImuIncrement>& driven() const { return driven_; }

 private:
  std::unique_ptr<measurement::Navigator> start_;  ///< stays where the doubt begins
  std::unique_ptr<measurement::Navigator> ahead_;
  std::vector<ImuIncrement> driven_;
};

/// A fix as the Lookahead predicts it.
struct MetFix {
  GnssFix fix;
  Eigen::Vector3d innovation_n = Eigen::Vector3d::Zero();
  Eigen::Matrix3d innovation_covariance = Eigen::Matrix3d::Identity();
  double square = 0;      ///< of the innovation, normalized
  double since_last = 0;  ///< [s]
};

/// The state and what it makes of the first doubtful fix.
struct DoubtBegin {
  state::Epoch state;
  Eigen::Vector3d innovation_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d variance_n = Eigen::Vector3d::Zero();  ///< of the innovation
};

/// Finds out which of the fixes from a doubtful one on are in error, or whether it is the state:
/// the exclusion of fault detection and exclusion (FDE), whose detection is FixJudge. It gets the
/// fixes as they are met by a Lookahead, until it has decided.
class FaultExclusion {
 public:
  virtual ~FaultExclusion() = default;

  /// The Lookahead has been driven on by this.
  virtual void propagate(const ImuIncrement& /*increment*/) {}
  virtual void meet(const MetFix& met) = 0;
  /// The doubt has lasted too long; `last` is the last fix of it.
  virtual void give_up(const GnssFix& last) = 0;
  /// There is nothing more to see.
  virtual void settle() = 0;

  bool is_decided() const { return decided_; }
  const DoubtOutcome& outcome() const { return outcome_; }

 protected:
  FaultExclusion(const FixJudge& judge, DoubtBegin begin)
      : judge_(judge), begin_(std::move(begin)), last_fix_ns_(begin_.state.t_ns) {}

  InnovationSample sample(const MetFix& met) const;
  /// How long the doubt has lasted up to the last fix [s].
  double lasted() const;
  /// A step fault that stays so long is the truth.
  bool stays() const;

  void leave_out(const GnssFix& fix);
  void use(const GnssFix& fix);
  void believe_all();
  void believe_offset(double metres);
  void notice(std::string line) { outcome_.notices.push_back(std::move(line)); }
  void notice_contradiction(const char* verdict);
  std::string since() const { return utc_text(begin_.state.t_ns); }

  FixJudge judge_;  ///< as it was
  DoubtBegin begin_;
  int64_t last_fix_ns_ = 0;
  bool decided_ = false;
  DoubtOutcome outcome_;
};

/// Of the velocity, in the local NED.
Eigen::Vector3d velocity_variance(const state::Epoch& epoch);

constexpr int kMissesThatEndLine = 3;  ///< fixes in a row; chosen: two may be outliers
constexpr double kThinning = 0.25;     ///< [s] between fixes that are looked at

}  // namespace foucault::diagnosis
