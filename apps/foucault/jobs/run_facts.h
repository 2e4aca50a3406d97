#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "foucault/state/interfaces.h"

namespace foucault::app {

/// Mean and largest of a number.
class Level {
 public:
  void add(double value);
  bool empty() const { return count_ == 0; }
  double mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0; }
  double largest() const { return largest_; }

 private:
  int64_t count_ = 0;
  double sum_ = 0;
  double largest_ = 0;
};

/// What a reader wants to know of a run before all errors: when, how far, how fast, how sure. In
/// bounded memory.
class RunFacts {
 public:
  RunFacts() = default;
  explicit RunFacts(const state::Mounting& mounting) : mounting_(mounting) {}

  void measurement(const Measurement& measurement);
  void epoch(const state::Epoch& epoch);
  void notice(const state::Notice& notice);

  std::optional<int64_t> recording_begin_ns, recording_end_ns;  ///< stamps of measurements
  std::optional<int64_t> begin_ns, end_ns;                      ///< of the solution
  double distance_m = 0;  ///< speed over time; slower than 0.1 m/s is standing
  double moving_s = 0;    ///< not standing
  Level speed_m_s;
  Level horizontal_sigma_m;  ///< root of the sum of the variances along north and east
  Level vertical_sigma_m;
  Level tilt_sigma_rad;  ///< the larger one of roll and pitch
  Level heading_sigma_rad;
  std::map<FixQuality, int64_t> fixes;
  std::optional<Eigen::Vector3d> lever_arm_b;  ///< as the recording has it, of the first fix
  bool lever_arm_known = true;
  std::vector<state::Notice> notices;  ///< the first ones
  int64_t notices_seen = 0;

 private:
  void travel(const state::Epoch& epoch);

  state::Mounting mounting_;
  std::optional<state::Epoch> last_;
};

}  // namespace foucault::app
