#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "foucault/alignment/alignment.h"
#include "foucault/diagnosis/gnss_options.h"
#include "foucault/imu/recent_rates.h"
#include "foucault/measurement/aid_options.h"
#include "foucault/measurement/navigator.h"
#include "foucault/navigation/gap_options.h"
#include "foucault/state/interfaces.h"

namespace foucault::diagnosis {
class FixDoubt;
class FixGuard;
class FixJudge;
class FixScreen;
class ImuGuard;
class Plausibility;
struct FixDecision;
}  // namespace foucault::diagnosis

namespace foucault::navigation {

class PredictionProbe;
struct ImuHole;

enum class EpochRate { epochs, imu };

struct NavigationRunOptions {
  GnssOptions gnss;
  GapOptions gaps;
  AidOptions aids;
  double node_interval_s = 1;  ///< longest time between nodes, see Navigator::hold()
  EpochRate rate = EpochRate::epochs;
};

/// The driver that all methods share: alignment, then a Navigator fed in order of time.
/// - Increments are split at the stamps of fixes, requests and holds.
/// - A hold comes when node_interval_s has passed since the last fix that was used (or hold).
/// - Epochs go to the sink at the start, after every fix, hold and request, one a stamp; with
///   EpochRate::imu also at the end of every increment.
/// - Holes between increments are bridged (GapOptions), those of half a second and more not before
///   fixes after the hole tell how the vehicle turned in it, at most 3 s later; beyond max_gap_s
///   the run aligns again.
/// - Fixes are gated by the chi-square test of their innovation (3 degrees of freedom), relative to
///   the median of recent ones where that is above its expectation. Where one does not pass, or is
///   the first after an outage, what follows is held back until it shows whether the fixes or the
///   state are wrong (src/fix_doubt.h), 90 s at most; epochs and fixes are given out that much
///   later, as if it had been known at once. After a hole the gate is open for ten seconds.
/// - Velocities of fixes that were used are gated in the same way, by themselves, if the aids have
///   them.
/// - Before the alignment, fixes that no vehicle can reach from their neighbours are left out.
/// - Positions given again and again under new stamps count once (out_of_order).
/// - Fixes that are no position, or that no vehicle reaches from the others, are left out, counted
///   and named.
/// - Fixes that repeat the one before them, come late, or are stamped more than an hour from the
///   IMU are left out (out_of_order).
/// - Increments that are not finite, or do not come after the one before, are left out, counted and
///   named; samples of a clipped or stuck gyroscope are a hole, those of such an
///   accelerometer get more noise.
/// - If the sink wants predictions, fixes are now and then predicted 5, 15 and 30 s ahead.
/// - Fixes up to the alignment's start stamp are not used again and have no FixResult.
/// - After a new alignment the biases known before it still count, with doubled sigmas.
/// process() throws DataError for what makes a recording useless: units of the IMU, turned axes,
/// clocks that are seconds apart; and at the first epoch that is not finite, so that none comes
/// out. Memory is bounded: before alignment, at most what the Aligner may still start from is held.
/// finish() throws DataError if there was no IMU, no usable fix, or no alignment, or if more than
/// half of the increments had to be left out: why, and what to do about it.
class NavigationRun : public Estimator {
 public:
  NavigationRun(std::unique_ptr<Navigator> navigator, Aligner aligner,
                const NavigationRunOptions& options, Sink& sink);
  ~NavigationRun() override;

  void process(const Measurement& measurement) override;
  void finish() override;

 private:
  using Event = std::variant<GnssFix, EpochRequest>;

  /// Length of increments, weighed by their share of the time, so that slips of stamps do not
  /// count.
  struct UsualInterval {
    double length = 0;  ///< [s]
    double memory = 0;  ///< seconds that it rests on
    void add(double dt);
  };

  /// What a fix is before anything is known of the state: the first of these that holds.
  enum class FixClass { elsewhen, repeated, held, bad_position, bad_sigma, low_quality, usable };

  struct Counts {
    struct Class {
      int64_t count = 0;
      int64_t first_ns = 0;
    };
    std::map<FixClass, Class> fixes;
    int64_t increments = 0;
    int64_t late = 0;
    std::optional<double> first_elsewhen_s;  ///< by how much the first of these is off
    void add(FixClass fix_class, int64_t t_ns);
    int64_t of(FixClass fix_class) const;
    int64_t all_fixes() const;
  };

  FixClass classify(GnssFix& fix);
  void process_increment(const ImuIncrement& increment);
  void process_fix(const GnssFix& fix);
  void pass_on(const Measurement& measurement);
  bool is_repeated(const GnssFix& fix) const;
  void leave_out(const GnssFix& fix, FixVerdict verdict);
  bool is_usable(const GnssFix& fix) const;
  void align(const Measurement& measurement);
  void align_screened(const Measurement& measurement, bool plausible);
  void show_aligner(const Measurement& measurement, bool plausible);
  void start(const Epoch& aligned);
  void drop_what_no_start_needs();

  void take(const Measurement& measurement);
  void take_event(const Event& event);
  void take_increment(const ImuIncrement& increment);
  void meet_hole(const ImuIncrement& next);
  void look_beyond_hole(const Measurement& measurement);
  int64_t beyond_hole_end_ns() const;
  void leave_hole();
  void realign(const ImuIncrement& next);
  bool advance(const ImuIncrement& increment);
  std::optional<int64_t> next_stop(int64_t end_ns) const;
  int64_t hold_due_ns() const;
  void propagate(const ImuIncrement& increment);

  void handle_stop();
  void handle_fix(const GnssFix& fix);
  std::optional<FixDecision> decide(const GnssFix& fix, const Innovation& innovation);
  std::optional<FixDecision> decided_before(const GnssFix& fix);
  bool is_unheld(const GnssFix& fix) const;
  bool returns_after_outage(const GnssFix& fix) const;
  void doubt(const GnssFix& fix, const GnssFix& trusted);
  bool show_doubt(const Measurement& measurement);
  void doubt_state(int64_t t_ns);
  void look_beyond_doubt(const Measurement& measurement);
  void resolve_doubt();
  FixVerdict carry_out(const FixDecision& decision, const GnssFix& fix, FixResult& result);
  void use(const GnssFix& fix, FixResult& result);
  void use_velocity(const GnssFix& fix);
  void predict_ahead(const GnssFix& fix);
  void remember_fix_time();
  void hold();
  void emit_epoch();
  [[noreturn]] void throw_unsound(const std::string& part) const;
  void notice_first_rejection(const GnssFix& fix, FixVerdict verdict);

  void notice_left_out();
  void throw_if_nothing_usable() const;
  std::string unusable_fixes() const;

  std::unique_ptr<Navigator> navigator_;
  Aligner aligner_;
  NavigationRunOptions options_;
  Sink& sink_;

  bool aligned_ = false;
  bool started_before_ = false;
  int64_t time_ns_ = 0;
  int64_t last_node_ns_ = 0;
  std::optional<int64_t> last_epoch_ns_;
  std::optional<int64_t> last_fix_ns_;
  int64_t fix_interval_ns_ = 0;
  std::unique_ptr<ImuGuard> guard_;
  std::unique_ptr<FixGuard> fix_guard_;
  std::unique_ptr<Plausibility> plausibility_;
  std::unique_ptr<FixScreen> screen_;
  std::unique_ptr<FixJudge> judge_;
  std::unique_ptr<FixJudge> velocity_judge_;
  std::unique_ptr<FixDoubt> doubt_;
  std::optional<GnssFix> doubted_fix_;
  std::deque<Measurement> beyond_doubt_;         ///< what came after it
  std::multimap<int64_t, FixDecision> decided_;  ///< of fixes to come, by stamp
  int64_t last_used_ns_ = 0;                     ///< fix, or start
  std::unique_ptr<PredictionProbe> probe_;       ///< if predictions are wanted
  std::optional<GnssFix> last_fix_seen_;
  std::optional<Epoch> before_hole_;  ///< the last state, while aligning anew
  UsualInterval usual_interval_;
  RecentRates recent_;  ///< before now, for bridging a hole
  std::deque<Measurement> held_;
  std::multimap<int64_t, Event> pending_;  ///< by stamp
  std::unique_ptr<ImuHole> hole_;          ///< met but not yet bridged
  std::deque<Measurement> beyond_hole_;    ///< what came after it, from the increment that ends it
  bool noticed_bad_ = false;
  Counts counts_;
};

}  // namespace foucault::navigation
