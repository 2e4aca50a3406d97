#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/turn_match.h"

/// Are accelerometers in m/s^2, and of a scale that real ones have?
namespace foucault::diagnosis {

struct ForceFacts {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< [m/s^2]
  double length = 0;                               ///< mean of its length [m/s^2]
  double seconds = 0;                              ///< that these rest on
  double interval_s = 0;                           ///< mean of a sample's [s]
  /// Length of the specific force over that of the acceleration by fixes minus gravity, see
  /// ForceMatch.
  std::optional<MeasuredFactor> factor;
};

/// Collects the means.
class MeanForce {
 public:
  void add(const ImuIncrement& increment);
  double seconds() const { return time_; }
  /// In b, without a factor.
  ForceFacts facts() const;

 private:
  Eigen::Vector3d sum_b_ = Eigen::Vector3d::Zero();
  double length_sum_ = 0;
  double time_ = 0;
  int64_t samples_ = 0;
};

struct WrongForce {
  std::string text;    ///< what is wrong, one line with numbers
  std::string remedy;  ///< what to do
};

/// What is wrong with unit or scale; none if it may be right. Where there is a factor it decides,
/// whatever the motion. Where there is none, the mean length: vehicles turn and fall for a while,
/// so only what none does is refused.
std::optional<WrongForce> wrong_force(const ForceFacts& force);

}  // namespace foucault::diagnosis
