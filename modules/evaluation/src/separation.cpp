#include "foucault/evaluation/separation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstddef>
#include <utility>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/evaluation/reference_error.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/state/blocks.h"
#include "foucault/state/vehicle_attitude.h"

namespace foucault::evaluation {
namespace {

constexpr int64_t kLeastStep = kNanosecondsPerSecond / 20;

/// Of what the smoothed sigma leaves of the forward one; none if rounding makes it negative.
Eigen::Vector3d sigma_left(const Eigen::Vector3d& forward, const Eigen::Vector3d& smoothed) {
  return (forward.cwiseAbs2() - smoothed.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
}

using Triangle = Eigen::Matrix<float, 6, 1>;

constexpr std::array<state::NodeBlock, 3> kSeparated{state::block::position, state::block::velocity,
                                                     state::block::attitude};

Triangle triangle(const Eigen::Matrix3d& m) {
  Triangle t;
  t << m.diagonal().cast<float>(), m.cast<float>()(1, 0), m.cast<float>()(2, 0),
      m.cast<float>()(2, 1);
  return t;
}

Eigen::Matrix3d symmetric(const Triangle& t) {
  Eigen::Matrix3d m;
  m << t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2];
  return m;
}

Eigen::Vector3d sigmas_of(const Triangle& t) {
  return t.head<3>().cwiseMax(0).cast<double>().cwiseSqrt();
}

double median_size(const std::vector<float>& squares) {
  if (squares.empty()) return 0;
  const std::vector<double> values(squares.begin(), squares.end());
  return std::sqrt(quantile(values, 0.5) / chi_square_quantile(0.5, 3));
}

}  // namespace

std::optional<double> separation_square(const Eigen::Vector3d& difference,
                                        const Eigen::Matrix3d& forward,
                                        const Eigen::Matrix3d& smoothed) {
  constexpr double kLeastLeft = 0.01;  // of the forward variance
  const Eigen::LLT<Eigen::Matrix3d> llt(forward);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::Matrix3d half = llt.matrixL().solve(smoothed);
  const Eigen::Matrix3d share = llt.matrixL().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(share);
  const Eigen::Vector3d left = (1 - solver.eigenvalues().array()).cwiseMax(kLeastLeft);
  const Eigen::Vector3d z = solver.eigenvectors().transpose() * llt.matrixL().solve(difference);
  const double square = z.cwiseAbs2().cwiseQuotient(left).sum();
  return std::isfinite(square) ? std::optional(square) : std::nullopt;
}

SeparationCollector::SeparationCollector(const state::Mounting& mounting, Callback callback)
    : mounting_(mounting), callback_(std::move(callback)) {}

void SeparationCollector::forward(const state::Epoch& epoch) {
  if (!kept_.empty() && epoch.t_ns - kept_.back().pose.t_ns < kLeastStep) return;
  const state::VehicleAttitude vehicle = state::vehicle_attitude(epoch, mounting_);
  Kept& kept = kept_.emplace_back();
  kept.pose = {epoch.t_ns, epoch.position, epoch.velocity_n, vehicle.q_n_v};
  kept.euler_sigma = vehicle.sigma.cast<float>();
  kept.q_n_b = epoch.q_n_b.cast<float>();
  for (std::size_t i = 0; i < kSeparated.size(); ++i) {
    kept.covariances[i] = triangle(epoch.covariance_of(kSeparated[i]));
  }
}

void SeparationCollector::smoothed(const state::Epoch& epoch) {
  while (!kept_.empty() && kept_.front().pose.t_ns < epoch.t_ns) kept_.pop_front();
  if (kept_.empty() || kept_.front().pose.t_ns != epoch.t_ns) return;
  const Kept& forward = kept_.front();
  const state::ReferenceError difference = reference_error(epoch, mounting_, forward.pose);
  const Eigen::Vector3d euler_sigma = state::vehicle_attitude(epoch, mounting_).sigma;
  const state::Separation separation{
      epoch.t_ns,
      difference.position_n,
      *difference.velocity_n,
      *difference.euler,
      sigma_left(sigmas_of(forward.covariances[0]), epoch.sigma_of(state::block::position)),
      sigma_left(sigmas_of(forward.covariances[1]), epoch.sigma_of(state::block::velocity)),
      sigma_left(forward.euler_sigma.cast<double>(), euler_sigma)};
  add(separation);
  if (epoch.t_ns >= from_ns_) add_squares(forward, epoch, separation);
}

void SeparationCollector::add_squares(const Kept& forward, const state::Epoch& smoothed,
                                      const state::Separation& separation) {
  const Eigen::Quaterniond q_n_b = forward.q_n_b.cast<double>().normalized();
  const std::array<Eigen::Vector3d, 3> differences{separation.position_n, separation.velocity_n,
                                                   so3::log(q_n_b.conjugate() * smoothed.q_n_b)};
  for (std::size_t i = 0; i < kSeparated.size(); ++i) {
    const std::optional<double> square = separation_square(
        differences[i], symmetric(forward.covariances[i]), smoothed.covariance_of(kSeparated[i]));
    if (square) squares_[i].push_back(static_cast<float>(*square));
  }
}

void SeparationCollector::add(const state::Separation& separation) {
  if (callback_) callback_(separation);
  if (separation.t_ns < from_ns_) return;
  ++sums_.samples;
  sums_.position_rms_n += separation.position_n.cwiseAbs2();
  sums_.velocity_rms_n += separation.velocity_n.cwiseAbs2();
  sums_.euler_rms += separation.euler.cwiseAbs2();
}

SeparationMetrics SeparationCollector::metrics() const {
  SeparationMetrics metrics = sums_;
  if (metrics.samples == 0) return metrics;
  metrics.position_size = median_size(squares_[0]);
  metrics.velocity_size = median_size(squares_[1]);
  metrics.attitude_size = median_size(squares_[2]);
  const auto samples = static_cast<double>(metrics.samples);
  for (Eigen::Vector3d* rms :
       {&metrics.position_rms_n, &metrics.velocity_rms_n, &metrics.euler_rms}) {
    *rms = (*rms / samples).cwiseSqrt();
  }
  return metrics;
}

}  // namespace foucault::evaluation
