#include "foucault/calibration/prediction.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <map>

#include "foucault/core/time.h"

namespace foucault::calibration {
namespace {

constexpr int kNode = state::NodeVector::RowsAtCompileTime;
constexpr int kMotion = state::MotionVector::RowsAtCompileTime;
constexpr int kSize = kNode + 3;  // and what of the errors of fixes lasts, in sigmas
constexpr int kSensor = kSize - kMotion;
constexpr double kSettling = 30;  // [s]

/// A factor of the sigma that was told.
double factor_of(NoiseOf kind, int row, const NoiseModel& noise) {
  switch (kind) {
    case NoiseOf::position:
      return noise.fix_white;
    case NoiseOf::velocity:
      return noise.velocity;
    case NoiseOf::slip:
      return row == 0 ? noise.slip : noise.bounce;
    case NoiseOf::wheel:
      return noise.wheel;
    case NoiseOf::heading:
    case NoiseOf::rest:
      return 1;
  }
  return 1;
}

/// The filter: mean and covariance of true minus nominal.
class WayFilter {
 public:
  explicit WayFilter(const NoiseModel& noise)
      : noise_(noise),
        gyro_power_(std::pow(noise.imu.gyro_noise_density, 2)),
        accel_power_(std::pow(noise.imu.accel_noise_density, 2)) {}

  void come(const WayNode& node) {
    if (node.begins)
      begin(node);
    else
      predict(node);
  }

  void leap(const WayLeg& leg) {
    carry(leg.motion, leg.decay, leg.input, leg.dt);
    P_.topLeftCorner<kMotion, kMotion>() += gyro_power_ * leg.by_gyro + accel_power_ * leg.by_accel;
    P_.topLeftCorner<kNode, kNode>() += noise_.imu.gyro_bias_power() * leg.by_gyro_bias +
                                        noise_.imu.accel_bias_power() * leg.by_accel_bias;
  }

  /// Of what is to be measured now.
  Prediction meet(const WayMeasurement& z, double horizon_s, int64_t t_ns) const {
    const Eigen::Matrix<double, kSize, 3> H = columns(z);
    const Eigen::Matrix<double, kSize, 3> Ph = P_.lazyProduct(H);
    Prediction p{
        z.kind,    z.rows, z.r - H.transpose().lazyProduct(mean_), H.transpose().lazyProduct(Ph),
        horizon_s, t_ns};
    for (int row = 0; row < 3; ++row) p.covariance(row, row) += row < z.rows ? variance(z, row) : 1;
    return p;
  }

  /// Row by row: their noise is independent.
  void use(const WayMeasurement& z) {
    const Eigen::Matrix<double, kSize, 3> H = columns(z);
    for (int row = 0; row < z.rows; ++row) {
      const Eigen::Matrix<double, kSize, 1> Ph = P_ * H.col(row);
      const double s = Ph.dot(H.col(row)) + variance(z, row);
      mean_ += Ph * ((z.r[row] - H.col(row).dot(mean_)) / s);
      P_ -= Ph * (Ph / s).transpose();
    }
  }

  /// The nominal state was moved.
  void correct(const WayMeasurement& z) { mean_.head<kNode>() -= z.correction; }

 private:
  /// In units of what was told.
  double variance(const WayMeasurement& z, int row) const {
    const bool of_wheels = z.kind == NoiseOf::slip || z.kind == NoiseOf::wheel;
    const double least = of_wheels ? kLeastWheelNoise / z.told_sigma[row] : 0;
    return std::pow(factor_of(z.kind, row, noise_), 2) + least * least;
  }

  static Eigen::Matrix<double, kSize, 3> columns(const WayMeasurement& z) {
    Eigen::Matrix<double, kSize, 3> H;
    H << z.H.transpose(), z.by_sigmas.transpose();
    return H;
  }

  void begin(const WayNode& node) {
    mean_.setZero();
    P_.setZero();
    P_.topLeftCorner<kNode, kNode>() = *node.covariance;
    P_.diagonal().tail<3>().setConstant(std::pow(noise_.fix_coloured, 2));
  }

  void predict(const WayNode& node) {
    state::NodeVector input = state::NodeVector::Zero();
    input.head<kMotion>() = node.input;
    carry(node.motion, node.decay, input, node.dt);
    P_.topLeftCorner<kMotion, kMotion>() +=
        gyro_power_ * node.by_gyro + accel_power_ * node.by_accel;
    state::part(P_.diagonal(), state::block::gyro_bias).array() +=
        noise_.imu.gyro_bias_power() * node.dt;
    state::part(P_.diagonal(), state::block::accel_bias).array() +=
        noise_.imu.accel_bias_power() * node.dt;
    if (node.covariance) P_.topLeftCorner<kNode, kNode>() += *node.covariance;
  }

  /// By the transition, and what of the errors of fixes lasts; without the noise of the IMU.
  void carry(const state::RowsByNode<kMotion>& motion, const state::BiasVector& bias_decay,
             const state::NodeVector& input, double dt) {
    const double fix_decay = std::exp(-dt / noise_.fix_tau_s);
    Eigen::Matrix<double, kSensor, 1> decay;
    decay << bias_decay, Eigen::Vector3d::Constant(fix_decay);
    const Eigen::Matrix<double, kMotion, kSize> carried = motion.lazyProduct(P_.topRows<kNode>());
    P_.topLeftCorner<kMotion, kMotion>() =
        carried.leftCols<kNode>().lazyProduct(motion.transpose());
    P_.topRightCorner<kMotion, kSensor>() = carried.rightCols<kSensor>() * decay.asDiagonal();
    P_.bottomLeftCorner<kSensor, kMotion>() = P_.topRightCorner<kMotion, kSensor>().transpose();
    P_.bottomRightCorner<kSensor, kSensor>().array() *= (decay * decay.transpose()).array();
    P_.diagonal().tail<3>().array() +=
        std::pow(noise_.fix_coloured, 2) * (1 - fix_decay * fix_decay);
    const state::MotionVector moved = motion.lazyProduct(mean_.head<kNode>());
    mean_ << moved, decay.cwiseProduct(mean_.tail<kSensor>());
    mean_.head<kNode>() += input;
  }

  const NoiseModel& noise_;
  double gyro_power_, accel_power_;
  Eigen::Matrix<double, kSize, 1> mean_ = Eigen::Matrix<double, kSize, 1>::Zero();
  Eigen::Matrix<double, kSize, kSize> P_ = Eigen::Matrix<double, kSize, kSize>::Zero();
};

/// From the end of a leg on without fixes. The next fix may come late by a third.
void look_ahead(const RecordedWay& way, std::size_t leg, WayFilter filter,
                const std::vector<double>& horizons, std::vector<Prediction>& out) {
  constexpr double kLate = 1.3;
  const int64_t start_ns = way.nodes[way.legs[leg].to].t_ns;
  auto next = horizons.begin();
  while (++leg < way.legs.size() && next != horizons.end()) {
    const WayNode& node = way.nodes[way.legs[leg].to];
    if (node.begins || node.covariance) return;
    filter.leap(way.legs[leg]);
    const double since = seconds_between(start_ns, node.t_ns);
    for (const WayMeasurement& z : node.measured) {
      if (z.kind == NoiseOf::position && next != horizons.end() && since >= *next) {
        if (since < kLate * *next) out.push_back(filter.meet(z, *next, node.t_ns));
        while (next != horizons.end() && since >= *next) ++next;
      }
      if (!is_of_receiver(z.kind)) filter.use(z);
      filter.correct(z);
    }
  }
}

}  // namespace

std::vector<Prediction> predictions(const RecordedWay& way, const NoiseModel& noise,
                                    const Horizons& horizons) {
  std::vector<Prediction> out;
  WayFilter filter(noise);
  int64_t begin_ns = 0, start_ns = 0;
  std::size_t leg = 0;  // that ends here or later
  for (std::size_t i = 0; i < way.nodes.size(); ++i) {
    const WayNode& node = way.nodes[i];
    if (node.begins) begin_ns = start_ns = node.t_ns;
    filter.come(node);
    const bool counts = seconds_between(begin_ns, node.t_ns) > kSettling;
    bool fixed = false;
    for (const WayMeasurement& z : node.measured) {
      if (counts) out.push_back(filter.meet(z, 0, node.t_ns));
      filter.use(z);
      filter.correct(z);
      fixed |= z.kind == NoiseOf::position;
    }
    while (leg < way.legs.size() && way.legs[leg].to < i) ++leg;
    const bool ends = leg < way.legs.size() && way.legs[leg].to == i;
    const bool due = seconds_between(start_ns, node.t_ns) >= horizons.every_s;
    if (!counts || !fixed || !ends || !due) continue;
    start_ns = node.t_ns;
    look_ahead(way, leg, filter, horizons.lengths_s, out);
  }
  return out;
}

double log_density(const Prediction& p) {
  const Eigen::LLT<Eigen::Matrix3d> llt(p.covariance);
  return -0.5 * llt.matrixL().solve(p.error).squaredNorm() -
         llt.matrixLLT().diagonal().array().log().sum();
}

std::vector<NormalizedError> normalized_errors(const std::vector<Prediction>& predictions) {
  std::map<double, NormalizedError> by_horizon;
  for (const Prediction& p : predictions) {
    if (p.kind != NoiseOf::position) continue;
    NormalizedError& all = by_horizon[p.horizon_s];
    all.horizon_s = p.horizon_s;
    ++all.count;
    all.mean += p.error.dot(p.covariance.llt().solve(p.error)) / p.rows;
  }
  std::vector<NormalizedError> out;
  for (auto& [horizon, all] : by_horizon) {
    all.mean /= all.count;
    out.push_back(all);
  }
  return out;
}

}  // namespace foucault::calibration
