#include "foucault/simulation/imu_simulator.h"

#include <array>
#include <cmath>

#include "foucault/core/time.h"

namespace foucault::simulation {
namespace {

constexpr double kLongestPiece = 0.01;  ///< [s]

struct Node {
  double x;       ///< in [-1, 1]
  double weight;  ///< sum 2
};
constexpr std::array<Node, 4> kGaussLegendre{{{-0.86113631159405257522, 0.34785484513745385737},
                                              {-0.33998104358485626480, 0.65214515486254614263},
                                              {0.33998104358485626480, 0.65214515486254614263},
                                              {0.86113631159405257522, 0.34785484513745385737}}};

struct Integral {
  Eigen::Vector3d angle = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

Eigen::Matrix3d off_diagonal(double sigma, Draws& draws) {
  const Eigen::Vector3d above = sigma * draws.normal3(), below = sigma * draws.normal3();
  Eigen::Matrix3d m;
  m << 0, above.x(), above.y(), below.x(), 0, above.z(), below.y(), below.z(), 0;
  return m;
}

Eigen::Vector3d signs(Draws& draws) {
  const double x = draws.sign(), y = draws.sign(), z = draws.sign();
  return {x, y, z};
}

void add_piece(Integral& sum, const Trajectory& trajectory, double middle, double half) {
  for (const Node& node : kGaussLegendre) {
    const Motion motion = trajectory.at(middle + half * node.x);
    sum.angle += half * node.weight * motion.omega_iv_v;
    sum.velocity += half * node.weight * motion.f_v;
  }
}

}  // namespace

ImuIncrement exact_increment(const Trajectory& trajectory, const Eigen::Quaterniond& q_v_b,
                             int64_t start_ns, int64_t t_begin_ns, int64_t t_end_ns) {
  const double begin = seconds_between(start_ns, t_begin_ns);
  const double length = seconds_between(t_begin_ns, t_end_ns);
  const int pieces = static_cast<int>(std::ceil(length / kLongestPiece));
  const double half = length / (2 * pieces);
  Integral sum;
  for (int i = 0; i < pieces; ++i) add_piece(sum, trajectory, begin + (2 * i + 1) * half, half);

  ImuIncrement increment;
  increment.t_begin_ns = t_begin_ns;
  increment.t_end_ns = t_end_ns;
  increment.dtheta_b = q_v_b.conjugate() * sum.angle;
  increment.dvel_b = q_v_b.conjugate() * sum.velocity;
  return increment;
}

imu::ImuSample interval_mean_sample(const ImuIncrement& increment) {
  const double dt = increment.dt();
  return {increment.t_end_ns, increment.dtheta_b / dt, increment.dvel_b / dt};
}

ImuErrors::Triad::Triad(double noise_density_in, double bias_sigma_in, double turn_on_sigma,
                        double scale_sigma, Draws white, Draws bias_noise, Draws turn_on_draws,
                        Draws& scale_draws)
    : noise_density(noise_density_in),
      bias_sigma(bias_sigma_in),
      white_draws(std::move(white)),
      bias_draws(std::move(bias_noise)),
      turn_on(turn_on_sigma * turn_on_draws.normal3()),
      scale(scale_sigma * scale_draws.normal3()),
      wander(bias_sigma * bias_draws.normal3()) {}

Eigen::Vector3d ImuErrors::Triad::apply(const Eigen::Vector3d& exact, double dt, double tau,
                                        const Eigen::Vector3d& rectified_at_end) {
  const Eigen::Vector3d before = bias();
  rectified = rectified_at_end;
  const double driving = bias_sigma * std::sqrt(-std::expm1(-2 * dt / tau));
  wander = std::exp(-dt / tau) * wander + driving * bias_draws.normal3();
  const Eigen::Vector3d white = noise_density * std::sqrt(dt) * white_draws.normal3();
  return exact + scale.cwiseProduct(exact) + cross * exact + (before + bias()) * (dt / 2) + white;
}

ImuErrors::ImuErrors(const imu::ImuNoise& noise, const ImuFlaws& flaws, int64_t seed)
    : tau_(noise.bias_tau),
      scale_draws_(seed, RandomStream::scale_factor),
      gyro_(noise.gyro_noise_density, noise.gyro_bias_sigma, noise.gyro_turn_on_sigma,
            flaws.scale_sigma, Draws(seed, RandomStream::gyro_white),
            Draws(seed, RandomStream::gyro_bias), Draws(seed, RandomStream::gyro_turn_on),
            scale_draws_),
      accel_(noise.accel_noise_density, noise.accel_bias_sigma, noise.accel_turn_on_sigma,
             flaws.scale_sigma, Draws(seed, RandomStream::accel_white),
             Draws(seed, RandomStream::accel_bias), Draws(seed, RandomStream::accel_turn_on),
             scale_draws_) {
  Draws cross_draws(seed, RandomStream::cross_axis);
  gyro_.cross = off_diagonal(flaws.cross_axis_sigma, cross_draws);
  accel_.cross =
      off_diagonal(flaws.cross_axis_sigma, cross_draws).triangularView<Eigen::StrictlyUpper>();
  Draws sign_draws(seed, RandomStream::rectification);
  rectification_ = flaws.rectification * signs(sign_draws);
}

ImuIncrement ImuErrors::apply(const ImuIncrement& exact, double speed) {
  const double relative = speed / kVibrationSpeed;
  const Eigen::Vector3d rectified = relative * relative * rectification_;
  ImuIncrement measured = exact;
  measured.dtheta_b = gyro_.apply(exact.dtheta_b, exact.dt(), tau_, Eigen::Vector3d::Zero());
  measured.dvel_b = accel_.apply(exact.dvel_b, exact.dt(), tau_, rectified);
  return measured;
}

state::ImuBias ImuErrors::bias() const { return {gyro_.bias(), accel_.bias()}; }

}  // namespace foucault::simulation
