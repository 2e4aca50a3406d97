#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <complex>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/turn_match.h"

namespace foucault::diagnosis {

/// How accelerations by fixes and by the accelerometers go together.
struct AccelerationFit {
  /// Stamps of the IMU minus those of GNSS [s]: positive, they are late.
  Measured offset_s;
  double correlation = 0;  ///< 0 to 1, after `angle`, and `mirrored`, are made good
  /// That the force is turned to the right of where v and the course have it [rad]: 0 is right, pi
  /// if forward is backward or the vehicle reverses.
  Measured angle;
  /// Seen from the mean specific force, which is up, the force is on the other side than the fixes
  /// turn to.
  bool mirrored = false;
  bool is_side_known = false;  ///< whether `mirrored` is more than chance
  int64_t samples = 0;
};

/// Compares the horizontal acceleration of the antenna by three fixes, seen from the course, with
/// the horizontal specific force that the gyroscopes turn and a triangle of the same length
/// weights, over offsets on a grid. Neither slip of tyres nor where the axles are matters, as it
/// does for TurnMatcher; the lever arm is known or neglected.
///
/// Memory: the forces of twice the longest offset and sums an offset.
class AccelerationMatch {
 public:
  explicit AccelerationMatch(const Eigen::Quaterniond& q_v_b);

  void add(const ImuIncrement& increment);
  void add(const GnssFix& fix);

  /// None before there are enough, or while they are no more alike than chance makes them.
  std::optional<AccelerationFit> best() const;

 private:
  using Complex = std::complex<double>;  ///< forward and right, or north and east
  /// By the force alone, in level axes that do not turn.
  struct Motion {
    double turn = 0;
    Complex velocity, position;
  };
  struct Triple {
    GnssFix a, m, b;
  };
  /// Weighted sums over acceleration a and force f.
  struct Sums {
    Complex f, af, afc;  ///< f, a f, a conj(f)
    double ff = 0;
  };
  struct Fit {
    double residual = 0;
    Complex per_force;  ///< a = per_force f + constant
  };

  void restart(int64_t t_ns);
  void move(const ImuIncrement& increment);
  std::optional<Motion> motion_at(double t_s) const;
  Complex without_slow(const Complex& acceleration, const Triple& triple);
  void compare(const Triple& triple);
  std::optional<Complex> force_at(const Triple& triple, double offset, const Complex& arm,
                                  double way) const;
  Fit fit(const Sums& sums, bool mirrored) const;
  double seconds(int64_t t_ns) const;

  Eigen::Quaterniond q_v_b_;
  /// Carried on by the gyroscopes, and drawn to the specific force.
  Eigen::Vector3d up_b_ = Eigen::Vector3d::Zero();
  double up_memory_ = 0;
  std::optional<int64_t> start_ns_, last_ns_, first_ns_;
  Motion now_;
  std::deque<Motion> motions_;
  int64_t first_motion_ = 0;  ///< index of motions_.front() on the grid of time

  std::optional<GnssFix> before_, last_;
  std::deque<Triple> waiting_;
  std::vector<Sums> sums_;
  double weight_ = 0, aa_ = 0;
  Complex a_;
  Complex slow_;  ///< acceleration by fixes that up has followed
  int64_t samples_ = 0;
};

}  // namespace foucault::diagnosis
