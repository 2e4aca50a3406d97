#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/blocks.h"

namespace foucault::preintegration {

/// How the deltas change by one block, to first order, (44): at block + d they are dp + J.dp d,
/// dv + J.dv d and dq * exp(J.dq d).
struct DeltaJacobian {
  Eigen::Matrix3d dp = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d dv = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d dq = Eigen::Matrix3d::Zero();
};

/// What an IMU measured between two stamps, free of the state: paper III.C-III.E.
///
/// Frame: everything is resolved in b_i(k-1), the body frame at t_begin held fixed in inertial
/// space. The paper's (25) and (28) resolve in b_e(k-1), held fixed to the Earth, and so need the
/// attitude at t_{k-1} while integrating. Both are the same motion, seen from frames that turn
/// against each other by the Earth's rotation; it is applied in the residual (motion.h), exactly
/// and at whatever attitude the estimate has then, so that it never goes stale and nothing is to be
/// integrated again when the attitude moves.
///
/// Errors are true minus measured: p = dp + e_p, v = dv + e_v, q = dq * exp(e_theta).
struct MotionDeltas {
  int64_t t_begin_ns = 0;
  int64_t t_end_ns = 0;
  double dt = 0;                                           ///< T [s]
  Eigen::Quaterniond dq = Eigen::Quaterniond::Identity();  ///< b(t_end) to b_i; (21) with (15)
  Eigen::Vector3d dv = Eigen::Vector3d::Zero();            ///< integral of a [m/s]; (18)
  Eigen::Vector3d dp = Eigen::Vector3d::Zero();            ///< integral of dv [m]; (20)
  Eigen::Vector3d idp = Eigen::Vector3d::Zero();           ///< integral of dp [m s]
  Eigen::Vector3d iidp = Eigen::Vector3d::Zero();          ///< integral of idp [m s^2]
  state::ImuBias bias;                                     ///< at which it was integrated; (37)
  std::optional<state::ImuScale> scale;  ///< at which it was integrated; none: taken as right
  /// Share that is left at t_end of what the true bias at t_begin has beyond `bias`. 1 in (49); the
  /// processes of MarkovBias make it exp(-T / tau). It is the deviation from the estimate that
  /// decays, as in a Kalman filter, and not the estimate: that holds the turn-on value, which
  /// stays.
  double gyro_bias_decay = 1;
  double accel_bias_decay = 1;

  DeltaJacobian by_gyro_bias;
  DeltaJacobian by_accel_bias;  ///< dq does not change
  /// Zero without `scale`.
  DeltaJacobian by_gyro_scale;
  DeltaJacobian by_accel_scale;                ///< dq does not change
  std::array<DeltaJacobian, 2> by_gyro_cross;  ///< three of the block each
  DeltaJacobian by_accel_cross;                ///< dq does not change
};

struct Preintegration : MotionDeltas {
  /// Covariance of the errors, (43); blocks of a node, bias rows: change over the interval.
  state::NodeMatrix covariance = state::NodeMatrix::Zero();
};

/// Accumulates increments into a Preintegration, one at a time.
///
/// The attitude error is kept in b_i, eps = C e_theta, in which (35) becomes
///     eps' = -C (bg + n_g),   v' = -[a x] eps - C (ba + n_a),   p' = v:
/// only the skew of the velocity increment and C itself remain of the products of whole matrices.
/// Noise by the trapezoid rule, as (42); biases are the processes of MarkovBias, and a constant one
/// wanders by 1e-5 of its sigma in an hour.
///
/// Scale factors and cross-axis terms: the true increment is G (measured - bias dt), G = (I +
/// M)^-1, which an element ij of M changes by -G e_i times the true component j, as a bias does by
/// -G dt. So their Jacobians take the steps of those by the biases with C G in the place of C. The
/// covariance leaves G out: noise is not known to 1000 ppm.
class Preintegrator {
 public:
  /// `previous`: the increment before the first, for coning and sculling. `scale`: at which to
  /// integrate, and whether there are to be Jacobians by it.
  Preintegrator(const imu::ImuNoise& noise, const state::ImuBias& bias, int64_t t_begin_ns,
                const std::optional<ImuIncrement>& previous = std::nullopt,
                const std::optional<state::ImuScale>& scale = std::nullopt);

  /// Precondition: begins where the last one ended.
  /// Throws std::invalid_argument if it does not, or if it is empty.
  void add(const ImuIncrement& increment);

  /// The measurement up to the last increment; biases do not decay in it.
  Preintegration result() const;
  /// The same with the decay of the Gauss-Markov processes.
  Preintegration result_with_bias_decay() const;

  double dt() const { return m_.dt; }
  int64_t t_end_ns() const { return m_.t_end_ns; }
  const state::ImuBias& bias() const { return m_.bias; }
  const std::optional<ImuIncrement>& previous() const { return previous_; }

 private:
  /// Rotation [rad] and velocity [m/s] that were measured.
  struct Motion {
    Eigen::Vector3d dtheta, dvel;
  };
  /// Without bias and scale error.
  Motion corrected(const ImuIncrement& increment) const;

  void propagate_errors(const ImuIncrement& increment, const Motion& motion,
                        const Eigen::Matrix3d& C_next, const Eigen::Vector3d& y);
  void propagate_jacobians(const Motion& motion, const Eigen::Matrix3d& D, const Eigen::Vector3d& y,
                           double dt);
  void propagate_scale_jacobians(const Motion& motion, const Eigen::Matrix3d& D,
                                 const Eigen::Vector3d& y, double dt);
  void propagate_covariance(const ImuIncrement& increment, const Eigen::Matrix3d& D,
                            const Eigen::Vector3d& y, double dt);

  void add_noise(double h, double q_g, double q_a);
  void set_bias_decay(double dt);

  void put_jacobians(MotionDeltas& out) const;
  void put_covariance(state::NodeMatrix& S) const;

  /// Blocks of the covariance that are not zero; e = eps, g = gyro bias, a = accel bias.
  struct Blocks {
    Eigen::Matrix3d pp, pv, pe, pg, pa, vv, ve, vg, va, ee, eg;
    double gg = 0, aa = 0;  ///< times identity
    Blocks();
  };

  imu::ImuNoise noise_;
  double gyro_bias_power_, accel_bias_power_;
  std::optional<ImuIncrement> previous_;
  MotionDeltas m_;  ///< until result() its Jacobians have eps for dq
  /// G of both sensors.
  Eigen::Matrix3d gyro_gain_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d accel_gain_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d C_ = Eigen::Matrix3d::Identity();
  Blocks cov_;
  double bias_decay_dt_ = -1;  ///< sample length for which the decays were computed
  double gyro_bias_decay_ = 1;
  double accel_bias_decay_ = 1;
};

}  // namespace foucault::preintegration
