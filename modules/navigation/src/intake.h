#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/examination.h"
#include "foucault/navigation/run_options.h"
#include "foucault/state/result.h"

namespace foucault::navigation {

/// What the intake makes of a measurement.
struct Admitted {
  std::optional<Measurement> measurement;     ///< to be processed, less what is not to be used
  std::optional<state::FixVerdict> left_out;  ///< of a fix that users are to see as left out
  std::string notice;                         ///< one line; empty if there is nothing to say
  bool weakens_state = false;                 ///< the state gets worse than its covariance says
};

/// Length of increments, weighed by their share of the time, so that slips of stamps do not count.
struct UsualInterval {
  double length = 0;  ///< [s]
  double memory = 0;  ///< seconds that it rests on
  void add(double dt);
};

/// What every measurement passes before any state is concerned: it is looked at
/// (diagnosis::Examination), counted, and left out if it cannot be one of this recording.
/// - Increments: those that ImuGuard leaves out; those of a stuck accelerometer get more noise.
/// - Fixes: repeated, held, no position, out of reach (FixGuard), or stamped more than an hour from
///   the IMU. Fixes with a sigma that is none, or of low quality, pass: a run shows them and does
///   not use them.
/// admit() throws DataError for what makes a recording useless, see diagnosis::Plausibility.
class Intake {
 public:
  explicit Intake(const NavigationRunOptions& options)
      : options_(options), examination_(options.imu, options.mounting, options.gnss) {}

  Admitted admit(const Measurement& measurement);

  double usual_interval() const { return usual_interval_.length; }  ///< of increments [s]

  /// What was left out, one line a kind. `late`: fixes that came after later ones.
  std::vector<std::string> summary(int64_t late) const;
  /// What seems wrong with the recording.
  std::vector<state::Notice> warnings() const { return examination_.warnings(); }
  /// Throws DataError if there was no IMU or no usable fix, or if more than half of the increments
  /// had to be left out: why, and what to do about it.
  void throw_if_nothing_usable() const;

 private:
  /// What a fix is before anything is known of the state: the first of these that holds.
  enum class FixClass { elsewhen, repeated, held, bad_position, bad_sigma, low_quality, usable };
  struct Tally {
    int64_t count = 0;
    int64_t first_ns = 0;
  };

  Admitted admit_increment(const ImuIncrement& increment);
  Admitted admit_fix(GnssFix fix);
  FixClass classify(GnssFix& fix);
  void count(FixClass fix_class, const GnssFix& fix);
  int64_t count_of(FixClass fix_class) const;
  bool is_elsewhen(const GnssFix& fix) const;
  bool is_repeated(const GnssFix& fix) const;
  std::string unusable_fixes() const;

  NavigationRunOptions options_;
  diagnosis::Examination examination_;
  UsualInterval usual_interval_;
  std::map<FixClass, Tally> fixes_;
  int64_t increments_ = 0;
  std::optional<double> first_elsewhen_s_;  ///< by how much the first of these is off
  std::optional<GnssFix> last_fix_;
  std::optional<int64_t> first_fix_ns_;
};

}  // namespace foucault::navigation
