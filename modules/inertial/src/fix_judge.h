#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "foucault/core/measurement.h"
#include "foucault/core/result.h"
#include "foucault/inertial/navigation_run.h"
#include "foucault/inertial/navigator.h"

namespace foucault {

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

/// Decides whether a fix is believed, and if fixes and IMU contradict each other, which of them.
///
/// A fix is believed if its innovation passes a chi-square test, relative to the median of recent
/// ones and to the mean of recent believed ones where these are above their expectation: where
/// sigmas are too small, throughout or in turns, an outlier is what stands out of the others. A fix
/// that does not pass is left out, and the IMU's covariance grows until it passes or until enough
/// fixes show what it is:
/// - they scatter about the prediction: their sigmas are too small, and they are believed;
/// - they lie on a line, an offset that is constant or grows steadily from nothing: while the IMU
///   holds velocity to cm/s, that is an error of the fixes, and they are used without it. A
///   constant one that stays for kJumpStays is the truth, and the state moves there; a growing one
///   for kLongestDoubt at most;
/// - they leave the prediction smoothly on any other way, or by a jump and then steadily, as when
///   they return from an error that the state has followed: the state is wrong, and starts again at
///   the fixes with velocity and attitude loosened by what they show;
/// - they scatter wildly: waited for better ones, for kLongestDoubt at most.
/// Where the state itself is in doubt (after the alignment, holes and faults of the IMU) a few
/// fixes in a row suffice to be believed, and right after holes the gate is open.
class FixJudge {
 public:
  enum class Action {
    use,
    leave_out,
    use_corrected,  ///< Decision::fix, from which the line is taken, in the place of the fix
    move_state,     ///< to the fixes; its motion is right
    restart_state   ///< at the fixes; its motion is wrong, too
  };
  struct Decision {
    Action action = Action::use;
    GnssFix fix;
    InnovationLine line;
    std::string notice;  ///< one line, if something is to be said
  };

  explicit FixJudge(const GnssOptions& options) : options_(options) {}

  /// The state has started anew.
  void start(int64_t t_ns);
  /// The state has become worse than its covariance may say.
  void doubt_state(int64_t t_ns);
  void open_gate(int64_t until_ns);

  /// `fix` has a valid covariance; `innovation` is its own, of the navigator's present state.
  Decision judge(const GnssFix& fix, const Innovation& innovation, const Navigator& navigator);

 private:
  struct Rejected {
    int64_t t_ns;
    Eigen::Vector3d innovation_n;
    Eigen::Vector3d variance_n;  ///< of the fix
    double square;
  };
  /// A time in which fixes do not pass the gate.
  struct Doubt {
    int64_t begin_ns = 0;
    Epoch begin;                                                 ///< the state there
    Eigen::Vector3d begin_variance_n = Eigen::Vector3d::Zero();  ///< of the innovation there
    int64_t from_ns = 0;                                         ///< of the first of recent
    Eigen::Vector3d from_n = Eigen::Vector3d::Zero();  ///< what the last line came to there
    int64_t left_out = 0;
    std::deque<Rejected> recent;
    std::optional<InnovationLine> line;
    bool drifts = false;  ///< the line has a slope
    int line_missed = 0;  ///< fixes in a row that do not lie on it
    bool noticed = false;
  };

  bool passes(double square) const;
  double level() const;
  void remember(double square);
  void remember(const Doubt& doubt);
  Decision believe(const GnssFix& fix);
  Decision reject(const GnssFix& fix, const Innovation& innovation, const Navigator& navigator);
  Decision follow_line(const GnssFix& fix, const Innovation& innovation);
  Decision look_at(const GnssFix& fix, const Navigator& navigator);
  Decision doubt_fixes(const GnssFix& fix, const InnovationLine& line);
  Decision leave_out(const GnssFix& fix);
  Decision restart(const GnssFix& fix);
  InnovationLine fit() const;
  bool scatters_about_zero() const;
  bool lies_on(const InnovationLine& line) const;
  bool drifts(const InnovationLine& line, const Navigator& navigator) const;
  bool goes_on(const InnovationLine& line) const;
  bool is_smooth() const;

  GnssOptions options_;
  int64_t gate_open_until_ns_ = INT64_MIN;
  int64_t state_doubted_until_ns_ = INT64_MIN;
  int64_t rejected_in_a_row_ = 0;
  std::deque<double> squares_;  ///< normalized innovations squared, the last ones
  double believed_level_ = 1;   ///< mean normalized innovation squared of believed fixes, over 3
  FixQuality last_quality_ = FixQuality::fixed_rtk;
  std::optional<Doubt> doubt_;
  int64_t last_rejected_ns_ = 0;
};

/// The state moved to where a fix says, its motion as it was.
Epoch moved_to_fix(const Epoch& epoch, const GnssFix& fix, const Innovation& innovation);

/// The state at a fix, with the velocity that the line shows and as much doubt about velocity and
/// attitude; biases keep their values with grown sigmas.
Epoch restarted_at_fix(const Epoch& epoch, const GnssFix& fix, const Innovation& innovation,
                       const InnovationLine& line);

}  // namespace foucault
