#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/tally.h"

namespace foucault::diagnosis {

/// Looks at increments before they are used.
///
/// Those that are not finite or beyond what any sensor measures, and those that do not come after
/// the one before, are left out and counted; of one that begins too early the part that does not
/// overlap remains.
///
/// An axis that repeats one value, to the last digit, is stuck or clipped: a rate too large for a
/// vehicle at rest that comes five times in a row, or any that comes for half a second, while
/// another axis of that sensor goes on changing. A gyroscope's samples are left out then: a turn
/// that was not measured is better told by the courses beside a hole.
///
/// Samples on a straight line, all six rates without the noise they had before, were interpolated
/// over lost data, and are left out.
class ImuGuard {
 public:
  struct Verdict {
    std::optional<ImuIncrement> increment;  ///< what may be used
    bool accel_repeats = false;
    std::string notice;  ///< one line, the first time an axis repeats
  };

  Verdict look_at(const ImuIncrement& increment);

  /// Finite, and not beyond what any sensor measures.
  static bool is_measurable(const ImuIncrement& increment);

  /// One line a kind: how many were left out, and the first.
  std::vector<std::string> summary() const;
  int64_t seen() const { return seen_; }
  int64_t left_out() const { return not_finite_.count + disordered_.count; }
  std::optional<int64_t> last_end_ns() const { return last_end_ns_; }

 private:
  /// One axis of one sensor.
  struct Axis {
    double value = 0;
    int repeats = 0;        ///< of the value, up to now
    double repeated_s = 0;  ///< the same as a time
    double changed_s = 0;   ///< since it last repeated
    void add(double rate, double dt);
  };
  using Triad = std::array<Axis, 3>;
  /// All rates of the IMU, as a line through the last samples.
  class Line {
   public:
    using Rates = Eigen::Matrix<double, 6, 1>;
    void add(const Rates& rates, double dt);
    bool is_interpolated() const;

   private:
    bool goes_on(const Rates& bend, const Rates& step) const;
    Rates last_ = Rates::Zero(), step_ = Rates::Zero();
    Rates usual_ = Rates::Zero();         ///< mean bend between samples
    Rates usual_square_ = Rates::Zero();  ///< mean of its square
    int64_t known_ = 0;                   ///< samples it rests on
    int straight_ = 0;                    ///< samples
    double straight_s_ = 0;
  };

  static void add(const Eigen::Vector3d& rate, double dt, Triad& triad);
  static std::optional<int> repeating(const Triad& triad, double large);

  int64_t seen_ = 0;
  Tally not_finite_, disordered_, repeated_, interpolated_;
  std::optional<int64_t> last_end_ns_;
  Triad gyro_, accel_;
  Line line_;
  bool noticed_ = false;
};

}  // namespace foucault::diagnosis
