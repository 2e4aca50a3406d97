#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/fix_judge.h"
#include "foucault/diagnosis/return_trial.h"
#include "foucault/measurement/navigator.h"
#include "foucault/state/result.h"

namespace foucault::diagnosis {

/// Innovations in a row that do not pass the gate, as a straight line over time.
struct InnovationLine {
  int64_t t_ns = 0;                                    ///< of the last of them
  Eigen::Vector3d offset_n = Eigen::Vector3d::Zero();  ///< there [m]
  Eigen::Vector3d rate_n = Eigen::Vector3d::Zero();    ///< [m/s]
  Eigen::Vector3d offset_variance_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_variance_n = Eigen::Vector3d::Zero();  ///< of the state's velocity included

  Eigen::Vector3d at(int64_t t_ns) const;
  Eigen::Vector3d variance_at(int64_t t_ns) const;
};

struct FixDecision {
  enum class Action { use, leave_out, use_corrected };
  Action action = Action::use;
  GnssFix fix;        ///< as it was
  GnssFix corrected;  ///< for use_corrected: less the line, with its variance
};

/// What became of a doubt.
struct DoubtOutcome {
  std::vector<FixDecision> fixes;  ///< from the one that raised it on, in order
  std::optional<state::NodeMatrix>
      loosened;  ///< what the state is to be loosened by before the first
  bool state_was_wrong = false;
  std::vector<double> level;         ///< normalized squares that fixes were found to have
  std::vector<std::string> notices;  ///< one line each
};

/// A fix that does not agree with the prediction, or the first one after an outage, raises a doubt:
/// what follows is held back while a copy of the navigator drives ahead on it, until it shows
/// whether the fixes were wrong or the state. So what is true is used from its beginning on, in
/// every method, whenever it was understood.
///
/// After an outage ReturnTrial decides. Fixes that are in error by it are left out until they jump;
/// then those before or those after the jump are true, whichever agree with the prediction better.
/// Otherwise the state was held by fixes a moment ago, and
/// - one that agrees again ends the doubt; those in between were wrong;
/// - fixes that scatter about the prediction have sigmas that are too small, and are believed;
/// - fixes on a line, an offset that is constant or grows steadily from nothing, are in error: the
///   IMU holds velocity to cm/s. They are used without it. One that grows for kLongestDoubt, or is
///   constant for so long, or still constant when no more fixes come after kJumpStays, is the
///   truth;
/// - fixes that leave the prediction smoothly on any other way, or by a jump and then steadily, as
///   when they return from an error that the state has followed, are true: the state was wrong;
/// - those that scatter wildly are waited through, for kLongestDoubt at most.
/// Where the state is doubted itself (after the alignment and holes) a few fixes in a row suffice
/// to be believed.
class FixDoubt {
 public:
  /// At the current time of `navigator`, which stands before the use of `fix`. `returns`: no fix
  /// has held the state for a while.
  FixDoubt(const GnssOptions& options, const FixJudge& judge,
           const measurement::Navigator& navigator, const GnssFix& fix, bool returns);

  /// In the order in which the navigator will get them; fixes that can be judged only. True once it
  /// is decided, also by what ends the sight ahead: a hole, or no fixes any more.
  bool add(const Measurement& measurement);

  /// As far as it is known.
  DoubtOutcome outcome();

 private:
  struct Rejected {
    int64_t t_ns;
    Eigen::Vector3d innovation_n;
    Eigen::Matrix3d innovation_covariance;
    Eigen::Vector3d variance_n;  ///< of the fix
    double square;
  };

  void add_increment(const ImuIncrement& increment);
  void propagate(const ImuIncrement& increment);
  void meet(const GnssFix& fix);
  void judge_return();
  void meet_returning(const Rejected& rejected);
  void begin_offset();
  void follow_offset(const Rejected& fix);
  void end_offset(bool later_are_true, int64_t now_ns);
  std::size_t look_needs() const;
  void look_at();
  void begin_line(const InnovationLine& line);
  void follow_line(const GnssFix& fix, const state::Innovation& innovation, double since_last);
  void end_line(const GnssFix& fix);
  void use_corrected(const Eigen::Vector3d& error_n, const Eigen::Matrix3d& variance_n,
                     double since_last);
  void miss_line();
  void leave_out(const GnssFix& fix);
  void believe_all();
  void blame_state();
  /// The doubt once more, by another navigator: which fixes are true to it.
  struct Pass {
    double log_probability = 0;
    std::vector<bool> is_true;
    bool believes_most() const;
  };
  Pass drive_again(std::unique_ptr<measurement::Navigator> navigator) const;
  void move_state();
  void settle_at_end();

  state::NodeMatrix looseness() const;
  InnovationLine fit() const;
  bool scatters_about_zero() const;
  bool lies_on(const InnovationLine& line) const;
  bool drifts(const InnovationLine& line) const;
  bool goes_on(const InnovationLine& line) const;
  bool is_smooth() const;

  GnssOptions options_;
  FixJudge judge_;                                 ///< as it was
  std::unique_ptr<measurement::Navigator> start_;  ///< stays where the doubt begins
  std::unique_ptr<measurement::Navigator> ahead_;
  std::vector<ImuIncrement> driven_;  ///< by ahead_, divided at fixes
  std::optional<ReturnTrial> trial_;
  bool offset_is_certain_ = false;
  std::vector<std::size_t> tried_;  ///< which of the fixes the trial has got
  int64_t first_missed_ns_ = 0;     ///< the first fix since an offset was met last
  state::Epoch begin_;              ///< the state at the first fix
  state::Epoch held_;  ///< the same, or without a covariance once a line has shown the velocity
  Eigen::Vector3d begin_innovation_n_;
  Eigen::Vector3d begin_variance_n_;  ///< of the innovation there
  int64_t time_ns_;
  int64_t last_fix_ns_;
  std::multimap<int64_t, GnssFix> waiting_;  ///< stamped ahead of the increments

  int64_t from_ns_;                                   ///< of the first of recent
  Eigen::Vector3d from_n_ = Eigen::Vector3d::Zero();  ///< what the last line came to there
  std::deque<Rejected> recent_;
  std::optional<InnovationLine> line_;
  bool line_drifts_ = false;
  int line_missed_ = 0;  ///< fixes in a row that do not lie on it
  bool decided_ = false;
  DoubtOutcome outcome_;
};

}  // namespace foucault::diagnosis
