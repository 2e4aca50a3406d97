#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "foucault/core/measurement.h"
#include "foucault/state/epoch.h"

/// What estimators give out, as plain values.
namespace foucault::state {

/// corrected: used less an error that it shares with its neighbours.
enum class FixVerdict { used, bad_sigma, gated, low_quality, out_of_order, corrected };

/// What became of a fix. The innovation is the fix minus its prediction before it is used.
struct FixResult {
  int64_t t_ns = 0;
  FixVerdict verdict = FixVerdict::used;
  FixQuality quality = FixQuality::unknown;
  Geodetic antenna;
  Eigen::Vector3d p_b_a = Eigen::Vector3d::Zero();         ///< lever arm, IMU to antenna, in b [m]
  Eigen::Vector3d innovation_n = Eigen::Vector3d::Zero();  ///< north, east, down [m]
  Eigen::Matrix3d innovation_covariance = Eigen::Matrix3d::Zero();  ///< [m^2], of the innovation
  Eigen::Vector3d postfit_n = Eigen::Vector3d::Zero();  ///< fix minus estimate after use [m]
};

/// What became of another measurement.
struct ObservationResult {
  int64_t t_ns = 0;
  std::string_view name;  ///< of its kind, see Observation
  int dimension = 0;
  double normalized_square = 0;  ///< innovation squared by its covariance
  bool used = false;
};

/// A used fix against its prediction from a state some time before, without the fixes in between.
struct PredictionResult {
  int64_t t_ns = 0;
  double ahead_s = 0;  ///< horizon; the fix is up to a fifth later
  Eigen::Vector3d innovation_n = Eigen::Vector3d::Zero();           ///< north, east, down [m]
  Eigen::Matrix3d innovation_covariance = Eigen::Matrix3d::Zero();  ///< [m^2], of the innovation
};

enum class NoticeKind { aligned, imu_gap, realigned, fix_rejected, skipped };

/// Something that happened on the way and that a user should know.
struct Notice {
  int64_t t_ns = 0;
  NoticeKind kind = NoticeKind::skipped;
  std::string text;  ///< one line
};

/// Estimate minus reference at one stamp.
struct ReferenceError {
  int64_t t_ns = 0;
  Eigen::Vector3d position_n = Eigen::Vector3d::Zero();  ///< north, east, down [m]
  std::optional<Eigen::Vector3d> velocity_n;             ///< [m/s]
  std::optional<Eigen::Vector3d> euler;                  ///< roll, pitch, heading [rad], wrapped
};

}  // namespace foucault::state
