#include "foucault/evaluation/run_metrics.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "foucault/core/elsewhere.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/state/blocks.h"
#include "foucault/state/vehicle_attitude.h"

namespace foucault::evaluation {
namespace {

/// Right perturbation, in v, that leads from the estimate to the truth.
Eigen::Vector3d rotation_error(const state::VehicleAttitude& attitude,
                               const Eigen::Vector3d& euler_error) {
  const so3::Euler truth{attitude.euler.roll - euler_error[0],
                         attitude.euler.pitch - euler_error[1],
                         attitude.euler.heading - euler_error[2]};
  return so3::log(attitude.q_n_v.conjugate() * so3::from_euler(truth));
}

Eigen::Vector3d sigmas(const Eigen::Matrix3d& covariance) {
  return covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

/// A state that was carried on without fixes is off by as much, and knows.
bool lies_elsewhere(const Eigen::Vector3d& error, const Eigen::Vector3d& sigma) {
  constexpr double kSigmas = 10;
  const double distance = error.head<2>().norm();
  return distance > kElsewhere && distance > kSigmas * sigma.head<2>().norm();
}

std::optional<double> mean_of(const std::optional<SquareConsistency>& squares) {
  if (!squares) return std::nullopt;
  return squares->mean;
}

}  // namespace

std::optional<double> normalized_square(const Eigen::Vector3d& error,
                                        const Eigen::Matrix3d& covariance) {
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::Vector3d whitened = llt.matrixL().solve(error);
  const double square = whitened.squaredNorm();
  return std::isfinite(square) ? std::optional(square) : std::nullopt;
}

std::vector<CalibratedBlock> calibrated_blocks(const state::Epoch& epoch,
                                               const state::Layout& layout) {
  std::vector<CalibratedBlock> blocks;
  const state::SlowVector variance = epoch.covariance.diagonal().tail(layout.slow_size());
  for (const state::SlowBlock& slow : layout.slow()) {
    CalibratedBlock& out = blocks.emplace_back(CalibratedBlock{slow.block, {}, {}});
    for (int i = slow.index; i < slow.index + slow.block.size; ++i) {
      out.value.push_back(epoch.slow[i]);
      out.sigma.push_back(std::sqrt(variance[i]));
    }
  }
  return blocks;
}

void RunMetricsCollector::Squares::add(const Eigen::Vector3d& value) {
  ++samples;
  sum += value.cwiseAbs2();
}

Eigen::Vector3d RunMetricsCollector::Squares::mean() const {
  if (samples == 0) return Eigen::Vector3d::Zero();
  return sum / static_cast<double>(samples);
}

void RunMetricsCollector::Errors::add(const Eigen::Vector3d& error, const Eigen::Vector3d& sigma) {
  squares.add(error);
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 3; ++k) {
      if (std::abs(error[axis]) <= (k + 1) * sigma[axis]) inside(axis, k) += 1;
    }
  }
}

InsideSigma RunMetricsCollector::Errors::inside_sigma() const {
  if (squares.samples == 0) return {};
  return {squares.samples, inside / static_cast<double>(squares.samples)};
}

RunMetricsCollector::RunMetricsCollector(const state::Mounting& mounting, int64_t from_ns,
                                         ConsistencyCollector::Callback on_square)
    : mounting_(mounting), from_ns_(from_ns), consistency_(from_ns, std::move(on_square)) {}

void RunMetricsCollector::epoch(const state::Epoch& epoch) {
  if (states_.given_out == 0) states_.begin_ns = epoch.t_ns;
  last_ns_ = epoch.t_ns;
  ++states_.given_out;
  if (is_finite(epoch)) {
    const state::VehicleAttitude attitude = state::vehicle_attitude(epoch, mounting_);
    course_.add(epoch.velocity_n, attitude.euler.heading, attitude.sigma.z());
    return;
  }
  if (states_.not_finite == 0) states_.first_not_finite_ns = epoch.t_ns;
  ++states_.not_finite;
}

void RunMetricsCollector::fix(const state::FixResult& fix) {
  consistency_.fix(fix);
  if (fix.verdict == state::FixVerdict::corrected) {
    ++corrected_;
    return;
  }
  if (fix.verdict != state::FixVerdict::used) {
    ++rejected_;
    add_rejected(fix);
    return;
  }
  ++used_;
  if (fix.t_ns < from_ns_) return;
  innovation_.add(fix.innovation_n);
  postfit_.add(fix.postfit_n);
}

void RunMetricsCollector::add_rejected(const state::FixResult& fix) {
  const std::optional<double> nis = normalized_square(fix.innovation_n, fix.innovation_covariance);
  if (!nis || fix.t_ns < from_ns_) return;
  rejected_innovation_.add(fix.innovation_n);
  rejected_nis_sum_ += *nis;
}

void RunMetricsCollector::observation(const state::ObservationResult& result) {
  AidMetrics& aid = aids_[std::string(result.name)];
  aid.dimension = result.dimension;
  ++(result.used ? aid.used : aid.rejected);
  if (result.used) aid.nis_sum += result.normalized_square;
}

void RunMetricsCollector::prediction(const state::PredictionResult& prediction) {
  consistency_.prediction(prediction);
}

void RunMetricsCollector::reference_error(const state::Epoch& epoch,
                                          const state::ReferenceError& error) {
  const Eigen::Matrix3d position = epoch.covariance_of(state::block::position);
  const Eigen::Matrix3d velocity = epoch.covariance_of(state::block::velocity);
  const int64_t t_ns = error.t_ns;
  consistency_.error(NormalizedKind::position, t_ns, error.position_n, position);
  if (error.velocity_n) {
    consistency_.error(NormalizedKind::velocity, t_ns, *error.velocity_n, velocity);
  }
  if (error.euler) add_attitude(epoch, t_ns, *error.euler);
  if (t_ns < from_ns_) return;
  position_.add(error.position_n, sigmas(position));
  if (lies_elsewhere(error.position_n, sigmas(position))) ++elsewhere_;
  if (error.velocity_n) velocity_.add(*error.velocity_n, sigmas(velocity));
}

void RunMetricsCollector::add_attitude(const state::Epoch& epoch, int64_t t_ns,
                                       const Eigen::Vector3d& euler_error) {
  const state::VehicleAttitude attitude = state::vehicle_attitude(epoch, mounting_);
  const Eigen::Vector3d rotation = rotation_error(attitude, euler_error);
  consistency_.error(NormalizedKind::attitude, t_ns, rotation, attitude.covariance_v);
  if (t_ns < from_ns_) return;
  attitude_.add(euler_error, attitude.sigma);
}

ReferenceMetrics RunMetricsCollector::reference_metrics(const Consistency& consistency) const {
  ReferenceMetrics m;
  m.samples = position_.squares.samples;
  const Eigen::Vector3d position = position_.squares.mean();
  m.horizontal_rmse = std::sqrt(position.x() + position.y());
  m.vertical_rmse = std::sqrt(position.z());
  if (velocity_.squares.samples > 0) m.velocity_rmse = std::sqrt(velocity_.squares.mean().sum());
  if (attitude_.squares.samples > 0) {
    const Eigen::Vector3d rmse = attitude_.squares.mean().cwiseSqrt();
    m.roll_rmse = rmse[0];
    m.pitch_rmse = rmse[1];
    m.heading_rmse = rmse[2];
  }
  m.position_inside = position_.inside_sigma();
  m.velocity_inside = velocity_.inside_sigma();
  m.attitude_inside = attitude_.inside_sigma();
  m.position_nees = mean_of(consistency.position_nees);
  m.velocity_nees = mean_of(consistency.velocity_nees);
  m.attitude_nees = mean_of(consistency.attitude_nees);
  return m;
}

RunMetrics RunMetricsCollector::metrics() const {
  RunMetrics m;
  m.aids = aids_;
  m.epochs = states_.given_out;
  m.duration_s = seconds_between(states_.begin_ns, last_ns_);
  m.gnss.used = used_;
  m.gnss.rejected = rejected_;
  m.gnss.corrected = corrected_;
  m.gnss.samples = innovation_.samples;
  m.gnss.innovation_rms_n = innovation_.mean().cwiseSqrt();
  m.gnss.postfit_rms_n = postfit_.mean().cwiseSqrt();
  m.consistency = consistency_.result();
  m.gnss.mean_nis = m.consistency.nis.mean;
  m.gnss.rejected_samples = rejected_innovation_.samples;
  m.gnss.rejected_innovation_rms_n = rejected_innovation_.mean().cwiseSqrt();
  if (m.gnss.rejected_samples > 0) {
    m.gnss.rejected_mean_nis = rejected_nis_sum_ / static_cast<double>(m.gnss.rejected_samples);
  }
  m.trust = trust_in(m.consistency, states_, aids_,
                     {innovation_.samples + corrected_, rejected_innovation_.samples}, course_);
  compare_with_reference(m);
  return m;
}

void RunMetricsCollector::compare_with_reference(RunMetrics& m) const {
  if (position_.squares.samples == 0) return;
  const ReferenceMetrics compared = reference_metrics(m.consistency);
  if (2 * elsewhere_ <= compared.samples) {
    m.reference = compared;
    return;
  }
  m.reference_elsewhere_m = compared.horizontal_rmse;
  m.consistency.position_nees.reset();
  m.consistency.velocity_nees.reset();
  m.consistency.attitude_nees.reset();
}

}  // namespace foucault::evaluation
