#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foucault/diagnosis/turn_match.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"

/// Judges a recording before it is processed.
namespace foucault::diagnosis {

enum class Severity { ok, warning, error };

struct Finding {
  Severity severity = Severity::ok;
  std::string subject;  ///< "time offset"
  std::string text;     ///< what was found, one line with numbers
  std::string remedy;   ///< what to do; empty if all is well
};

/// Stamps of a stream.
struct StreamFacts {
  int64_t count = 0;
  int64_t first_ns = 0, last_ns = 0;
  double interval_s = 0;  ///< median of the first thousand
  int64_t holes = 0;      ///< longer than 1.5 of it
  double longest_hole_s = 0;
};

/// White noise by the Allan deviation over 1, 2 and 4 s at rest (medians), the least of them: what
/// vibration adds falls off faster with time, what biases add grows. The largest axis.
struct RestFacts {
  int64_t seconds = 0;
  double gyro_noise_density = 0;   ///< [rad/s/sqrt(Hz)]
  double accel_noise_density = 0;  ///< [m/s^2/sqrt(Hz)]
  double gyro_mean = 0;            ///< largest axis of the mean rate [rad/s]
  /// Differences of neighbouring fixes, over what their sigmas make them; 1 if they are white.
  double fix_scatter = 0;
  int64_t fix_pairs = 0;
};

struct LogFacts {
  StreamFacts imu, gnss;
  std::vector<std::string> bad_samples;  ///< of the IMU, a line a kind: how many, the first
  std::vector<std::string> bad_fixes;    ///< the same of GNSS
  double overlap_s = 0;
  int64_t bad_sigmas = 0;
  double smallest_sigma_m = 0, largest_sigma_m = 0;        ///< horizontal, of fixes
  std::optional<double> lever_arm_m;                       ///< of the first fix
  Eigen::Vector3d mean_force_v = Eigen::Vector3d::Zero();  ///< forward, right, down [m/s^2]
  /// Length of the specific force over that of the acceleration by fixes minus gravity.
  std::optional<MeasuredFactor> force_factor;
  RestFacts rest;
  std::optional<TurnMatch> turns;
  /// Correlation of the change of speed with the specific force forward and to the right.
  std::optional<Eigen::Vector2d> acceleration_match;
};

/// Collects the facts of a recording, in constant memory, and judges them.
class LogChecker {
 public:
  LogChecker(const imu::ImuNoise& configured, const state::Mounting& mounting);
  ~LogChecker();

  void add(const Measurement& measurement);

  LogFacts facts() const;
  /// Everything that was looked at, also what is well.
  std::vector<Finding> findings() const;
  /// Those that are not well, stamped where the IMU begins, but for samples and fixes that
  /// a NavigationRun names itself.
  std::vector<state::Notice> warnings() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// The judgement of facts alone.
std::vector<Finding> judge(const LogFacts& facts, const imu::ImuNoise& configured);

}  // namespace foucault::diagnosis
