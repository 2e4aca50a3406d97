#pragma once

#include <deque>
#include <functional>

#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"

namespace foucault::evaluation {

/// The reference at t, a.t_ns <= t <= b.t_ns, a.t_ns < b.t_ns.
/// Position: cubic Hermite if both have a velocity, else linear (both in Cartesian coordinates);
/// velocity linear; attitude along the shorter arc. What one of them lacks, the result lacks.
ReferencePose interpolate(const ReferencePose& a, const ReferencePose& b, int64_t t_ns);

/// Estimate minus reference of the same stamp. Velocity and attitude where the reference has them;
/// attitude errors are differences of the vehicle's Euler angles.
state::ReferenceError reference_error(const state::Epoch& epoch, const state::Mounting& mounting,
                                      const ReferencePose& reference);

struct ReferenceComparisonOptions {
  double max_gap_s = 1;  ///< longest interval between two references to interpolate over [s]
  /// The same where one has no velocity [s]: a straight line misses a dt^2 / 8, 1 cm at 2 m/s^2.
  double max_linear_gap_s = 0.2;
  /// How far epochs may lag behind the references [s]; bounds the memory.
  double keep_s = 600;
};

/// Compares a stream of epochs with a stream of references, both in order of stamps.
/// Epochs may lag (held back by the alignment) up to keep_s; they may lead by max_gap_s. An epoch
/// with neither a reference at its stamp nor two close ones around it has no error.
class ReferenceComparison {
 public:
  /// Called in order of stamps, with the epoch that the error belongs to.
  using Callback = std::function<void(const state::Epoch&, const state::ReferenceError&)>;

  ReferenceComparison(const state::Mounting& mounting, Callback callback,
                      const ReferenceComparisonOptions& options = {});

  void add(const ReferencePose& reference);
  void add(const state::Epoch& epoch);

 private:
  void compare_pending();
  bool compare(const state::Epoch& epoch);
  bool close_enough(const ReferencePose& a, const ReferencePose& b) const;
  void emit(const state::Epoch& epoch, const ReferencePose& reference) const;

  state::Mounting mounting_;
  Callback callback_;
  int64_t max_gap_ns_;
  int64_t max_linear_gap_ns_;
  int64_t keep_ns_;
  std::deque<ReferencePose> references_;  ///< from the last one not after the first pending epoch
  std::deque<state::Epoch> pending_;
};

}  // namespace foucault::evaluation
