#include "foucault/evaluation/consistency.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "foucault/core/time.h"
#include "foucault/evaluation/statistics.h"

namespace foucault::evaluation {
namespace {

constexpr int kComponents = 3;
constexpr std::size_t kMostBlocks = 4096;
constexpr std::size_t kLongestLag = 100;
constexpr std::size_t kMostIntervals = 1000;
constexpr double kTwoSided95 = 1.959963984540054;

std::size_t index_of(NormalizedKind kind) { return static_cast<std::size_t>(kind); }

double share_outside(const std::vector<Eigen::Vector3d>& lags, double bound) {
  if (lags.empty()) return 0;
  double outside = 0;
  for (const Eigen::Vector3d& lag : lags) {
    outside += static_cast<double>((lag.array().abs() > bound).count());
  }
  return outside / (kComponents * static_cast<double>(lags.size()));
}

}  // namespace

std::optional<Eigen::Vector3d> whitened(const Eigen::Vector3d& error,
                                        const Eigen::Matrix3d& covariance) {
  if (!error.allFinite() || !covariance.allFinite()) return std::nullopt;
  if (!(covariance.diagonal().minCoeff() > 0)) return std::nullopt;
  const Eigen::Vector3d scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(correlation);
  if (!(solver.eigenvalues().minCoeff() > 1e-14)) return std::nullopt;
  const Eigen::Vector3d z = solver.operatorInverseSqrt() * scale.cwiseProduct(error);
  return z.allFinite() ? std::optional(z) : std::nullopt;
}

// ---- mean of correlated numbers

void CorrelatedMean::add(double value) {
  ++samples_;
  sum_ += value;
  sum_of_squares_ += value * value;
  open_sum_ += value;
  if (++in_open_block_ < per_block_) return;
  blocks_.push_back(open_sum_ / static_cast<double>(per_block_));
  in_open_block_ = 0;
  open_sum_ = 0;
  if (blocks_.size() == kMostBlocks) join_neighbours();
}

void CorrelatedMean::join_neighbours() {
  for (std::size_t i = 0; i < blocks_.size() / 2; ++i) {
    blocks_[i] = (blocks_[2 * i] + blocks_[2 * i + 1]) / 2;
  }
  blocks_.resize(blocks_.size() / 2);
  per_block_ *= 2;
}

double CorrelatedMean::mean() const {
  return samples_ > 0 ? sum_ / static_cast<double>(samples_) : 0;
}

double CorrelatedMean::effective_samples() const {
  if (samples_ == 0) return 0;
  const double samples = static_cast<double>(samples_);
  const double blocks = static_cast<double>(blocks_.size());
  const double variance = sum_of_squares_ / samples - mean() * mean();
  const double centre = evaluation::mean(blocks_);
  double block_variance = 0;
  for (const double block : blocks_) block_variance += (block - centre) * (block - centre) / blocks;
  if (!(block_variance > 0)) return samples;
  const double variance_of_mean = block_variance / blocks * integrated_autocorrelation(blocks_);
  return std::clamp(variance / variance_of_mean, 1.0, samples);
}

// ---- autocorrelation

StreamingAutocorrelation::StreamingAutocorrelation(std::size_t max_lag)
    : products_(max_lag + 1, Eigen::Array3d::Zero()) {}

void StreamingAutocorrelation::add(const Eigen::Vector3d& value) {
  const Eigen::Array3d z = value.array();
  ++samples_;
  sum_ += z;
  last_.push_front(z);
  for (std::size_t k = 0; k < last_.size(); ++k) products_[k] += z * last_[k];
  const std::size_t max_lag = products_.size() - 1;
  if (first_.size() < max_lag) first_.push_back(z);
  if (last_.size() > max_lag) last_.pop_back();
}

/// Sum of (z_i - m) (z_(i-k) - m): the products, less m times those that take part, plus m^2.
Eigen::Array3d StreamingAutocorrelation::centred(std::size_t lag) const {
  const auto end = static_cast<std::ptrdiff_t>(lag);
  const Eigen::Array3d zero = Eigen::Array3d::Zero();
  const Eigen::Array3d later = sum_ - std::accumulate(first_.begin(), first_.begin() + end, zero);
  const Eigen::Array3d earlier = sum_ - std::accumulate(last_.begin(), last_.begin() + end, zero);
  const Eigen::Array3d m = sum_ / static_cast<double>(samples_);
  return products_[lag] - m * (later + earlier) +
         static_cast<double>(samples_ - static_cast<int64_t>(lag)) * m * m;
}

std::vector<Eigen::Vector3d> StreamingAutocorrelation::lags() const {
  std::vector<Eigen::Vector3d> lags;
  const std::size_t longest =
      std::min(products_.size() - 1, static_cast<std::size_t>(samples_ / 4));
  if (longest == 0) return lags;
  const Eigen::Array3d square = centred(0);
  for (std::size_t k = 1; k <= longest; ++k) {
    lags.emplace_back((square > 0).select(centred(k) / square, 0.0).matrix());
  }
  return lags;
}

// ---- stretches

void StretchCollector::add(int64_t t_ns, double square) {
  if (open_.empty()) open_begin_ns_ = t_ns;
  open_.push_back(square);
  if (open_.size() == static_cast<std::size_t>(kRunningMeanFixes)) close(t_ns);
}

void StretchCollector::close(int64_t end_ns) {
  const double size = std::sqrt(quantile(open_, 0.5) / chi_square_quantile(0.5, kComponents));
  open_.clear();
  ++result_.stretches;
  if (size >= StretchConsistency::kTooLarge) ++result_.too_large;
  if (!(size > result_.worst)) return;
  result_.worst = size;
  result_.worst_begin_ns = open_begin_ns_;
  result_.worst_end_ns = end_ns;
}

// ---- one component

void ResidualCollector::add(double z) {
  double power = 1;
  for (double& sum : power_sums_) {
    sum += power;
    power *= z;
  }
  for (std::size_t k = 0; k < inside_.size(); ++k) {
    if (std::abs(z) <= static_cast<double>(k + 1)) ++inside_[k];
  }
  const double bin = std::floor((z + ResidualHistogram::kLimit) / ResidualHistogram::kWidth);
  if (bin >= 0 && bin < static_cast<double>(ResidualHistogram::kBins)) {
    ++histogram_.counts[static_cast<std::size_t>(bin)];
  } else {
    ++histogram_.outside;
  }
}

ResidualStatistics ResidualCollector::statistics() const {
  ResidualStatistics s;
  const double n = power_sums_[0];
  s.samples = static_cast<int64_t>(n);
  s.histogram = histogram_;
  if (n == 0) return s;
  const double m = power_sums_[1] / n;
  const double second = power_sums_[2] / n;
  const double variance = std::max(0.0, second - m * m);
  const double fourth =
      power_sums_[4] / n - 4 * m * power_sums_[3] / n + 6 * m * m * second - 3 * m * m * m * m;
  s.mean = m;
  s.sigma = std::sqrt(variance);
  if (variance > 1e-12 * second) s.excess_kurtosis = fourth / (variance * variance) - 3;
  for (std::size_t k = 0; k < inside_.size(); ++k) {
    s.inside[k] = static_cast<double>(inside_[k]) / n;
  }
  return s;
}

// ---- a run

ConsistencyCollector::ConsistencyCollector(int64_t from_ns, Callback callback)
    : from_ns_(from_ns),
      callback_(std::move(callback)),
      single_band_(mean_nees_band(kComponents, 1)),
      autocorrelation_(kLongestLag) {}

void ConsistencyCollector::fix(const state::FixResult& fix) {
  const std::optional<Eigen::Vector3d> z = whitened(fix.innovation_n, fix.innovation_covariance);
  if (!z) return;
  NormalizedSquare square;
  square.t_ns = fix.t_ns;
  square.value = z->squaredNorm();
  square.used = fix.verdict == state::FixVerdict::used;
  if (square.used) square.running_mean = running_mean(square.value);
  add(square);
  if (!square.used || fix.t_ns < from_ns_) return;
  watch_interval(fix.t_ns);
  if (square.value > largest_nis_.value) largest_nis_ = square;
  stretches_.add(fix.t_ns, square.value);
  autocorrelation_.add(*z);
  for (Eigen::Index axis = 0; axis < kComponents; ++axis) {
    residuals_[static_cast<std::size_t>(axis)].add((*z)[axis]);
  }
}

void ConsistencyCollector::prediction(const state::PredictionResult& prediction) {
  if (prediction.t_ns < from_ns_) return;
  const std::optional<Eigen::Vector3d> z =
      whitened(prediction.innovation_n, prediction.innovation_covariance);
  if (!z) return;
  PredictionSum& sum = predictions_[prediction.ahead_s];
  ++sum.samples;
  sum.sum += z->squaredNorm();
}

void ConsistencyCollector::error(NormalizedKind kind, int64_t t_ns, const Eigen::Vector3d& error,
                                 const Eigen::Matrix3d& covariance) {
  const std::optional<Eigen::Vector3d> z = whitened(error, covariance);
  if (!z) return;
  NormalizedSquare square;
  square.t_ns = t_ns;
  square.kind = kind;
  square.value = z->squaredNorm();
  add(square);
}

void ConsistencyCollector::add(const NormalizedSquare& square) {
  if (callback_) callback_(square);
  if (!square.used || square.t_ns < from_ns_) return;
  Squares& squares = squares_[index_of(square.kind)];
  squares.mean.add(square.value);
  if (single_band_.holds(square.value)) ++squares.inside;
}

std::optional<double> ConsistencyCollector::running_mean(double square) {
  recent_.push_back(square);
  if (recent_.size() > static_cast<std::size_t>(kRunningMeanFixes)) recent_.pop_front();
  if (recent_.size() < static_cast<std::size_t>(kRunningMeanFixes)) return std::nullopt;
  return std::accumulate(recent_.begin(), recent_.end(), 0.0) /
         static_cast<double>(kRunningMeanFixes);
}

void ConsistencyCollector::watch_interval(int64_t t_ns) {
  if (last_fix_ns_ && intervals_s_.size() < kMostIntervals) {
    intervals_s_.push_back(seconds_between(*last_fix_ns_, t_ns));
  }
  last_fix_ns_ = t_ns;
}

SquareConsistency ConsistencyCollector::consistency(const Squares& squares) const {
  SquareConsistency c;
  c.samples = squares.mean.samples();
  if (c.samples == 0) return c;
  c.effective_samples = squares.mean.effective_samples();
  c.mean = squares.mean.mean();
  c.mean_band = mean_nees_band(kComponents, c.effective_samples);
  c.inside_share = static_cast<double>(squares.inside) / static_cast<double>(c.samples);
  return c;
}

std::optional<SquareConsistency> ConsistencyCollector::nees(NormalizedKind kind) const {
  const Squares& squares = squares_[index_of(kind)];
  if (squares.mean.samples() == 0) return std::nullopt;
  return consistency(squares);
}

std::vector<PredictionConsistency> ConsistencyCollector::predictions() const {
  std::vector<PredictionConsistency> result;
  for (const auto& [ahead_s, p] : predictions_) {
    const auto samples = static_cast<double>(p.samples);
    result.push_back({ahead_s, p.samples, p.sum / samples, mean_nees_band(kComponents, samples)});
  }
  return result;
}

ResidualAutocorrelation ConsistencyCollector::autocorrelation() const {
  ResidualAutocorrelation a;
  a.samples = autocorrelation_.samples();
  if (a.samples == 0) return a;
  if (!intervals_s_.empty()) a.interval_s = quantile(intervals_s_, 0.5);
  a.white_bound = kTwoSided95 / std::sqrt(static_cast<double>(a.samples));
  a.lag = autocorrelation_.lags();
  a.outside_share = share_outside(a.lag, a.white_bound);
  return a;
}

Consistency ConsistencyCollector::result() const {
  Consistency c;
  c.single_band = single_band_;
  c.running_mean_band = mean_nees_band(kComponents, kRunningMeanFixes);
  c.nis = consistency(squares_[index_of(NormalizedKind::innovation)]);
  c.largest_nis = largest_nis_;
  c.stretches = stretches_.result();
  for (std::size_t axis = 0; axis < residuals_.size(); ++axis) {
    c.innovations[axis] = residuals_[axis].statistics();
  }
  c.autocorrelation = autocorrelation();
  c.predictions = predictions();
  c.position_nees = nees(NormalizedKind::position);
  c.velocity_nees = nees(NormalizedKind::velocity);
  c.attitude_nees = nees(NormalizedKind::attitude);
  return c;
}

}  // namespace foucault::evaluation
