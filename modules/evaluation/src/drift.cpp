#include "foucault/evaluation/drift.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "foucault/core/time.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/state/blocks.h"

namespace foucault::evaluation {
namespace {

constexpr double kLongestInterpolation = 2;  // [s]

/// What is not a number is larger than any, so that a diverged estimate does not look good.
double or_infinite(double value) {
  return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
}

DriftValue value_of(const DriftSample& sample) {
  return {or_infinite(sample.horizontal()), or_infinite(sample.vertical())};
}

bool sampled_to_the_end(const Outage& outage, const std::vector<DriftSample>& samples) {
  const double length = seconds_between(outage.begin_ns, outage.end_ns);
  return samples.back().since_begin_s >= length - std::max(1.0, 0.1 * length);
}

template <int kSize>
double square_per_degree(const Eigen::Matrix<double, kSize, 1>& error,
                         const Eigen::Matrix<double, kSize, kSize>& covariance) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!error.allFinite() || !covariance.allFinite()) return kInfinity;
  const Eigen::LLT<Eigen::Matrix<double, kSize, kSize>> llt(covariance);
  if (llt.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  return llt.matrixL().solve(error).squaredNorm() / kSize;
}

}  // namespace

NormalizedSquares normalized_squares(const Eigen::Vector3d& error_n,
                                     const Eigen::Matrix3d& covariance_n) {
  return {square_per_degree<2>(error_n.head<2>(), covariance_n.topLeftCorner<2, 2>()),
          square_per_degree<1>(error_n.tail<1>(), covariance_n.bottomRightCorner<1, 1>())};
}

const std::vector<double>& default_drift_marks_s() {
  static const std::vector<double> marks{10, 20, 30, 60};
  return marks;
}

std::optional<DriftValue> drift_at(const std::vector<DriftSample>& samples, double since_begin_s) {
  constexpr double kSame = 5e-3;  // as the schedule takes stamps
  const auto after = std::find_if(samples.begin(), samples.end(), [&](const DriftSample& s) {
    return s.since_begin_s >= since_begin_s - kSame;
  });
  if (after == samples.end()) return std::nullopt;
  if (after->since_begin_s <= since_begin_s + kSame) return value_of(*after);
  if (after == samples.begin()) return std::nullopt;
  const DriftSample& before = *(after - 1);
  const double interval = after->since_begin_s - before.since_begin_s;
  if (interval > kLongestInterpolation) return std::nullopt;
  const double s = (since_begin_s - before.since_begin_s) / interval;
  const Eigen::Vector3d error_n = (1 - s) * before.error_n + s * after->error_n;
  return value_of({since_begin_s, error_n});
}

const DriftSample* sample_near(const std::vector<DriftSample>& samples, double since_begin_s) {
  constexpr double kFarthest = 1;  // [s]
  const auto distance = [&](const DriftSample& s) {
    return std::abs(s.since_begin_s - since_begin_s);
  };
  const auto nearest =
      std::min_element(samples.begin(), samples.end(),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  return nearest != samples.end() && distance(*nearest) <= kFarthest ? &*nearest : nullptr;
}

OutageDrift outage_drift(const Outage& outage, std::vector<DriftSample> samples,
                         const std::vector<double>& marks_s) {
  OutageDrift drift;
  drift.outage = outage;
  for (const DriftSample& sample : samples) {
    const DriftValue value = value_of(sample);
    drift.maximum.horizontal = std::max(drift.maximum.horizontal, value.horizontal);
    drift.maximum.vertical = std::max(drift.maximum.vertical, value.vertical);
  }
  drift.end = value_of(samples.back());
  for (const double mark_s : marks_s) drift.at_marks.push_back(drift_at(samples, mark_s));
  drift.samples = std::move(samples);
  return drift;
}

FixError fix_error(const state::Epoch& epoch, const GnssFix& fix, const state::Layout& layout) {
  const bool has_slow = epoch.slow.size() == layout.slow_size();
  const state::Linearized z =
      measurement::GnssPosition(fix).linearize(epoch, {}, has_slow ? layout : state::Layout());
  const Eigen::Index size = z.H.cols();
  return {-z.r, z.H * epoch.covariance.topLeftCorner(size, size) * z.H.transpose()};
}

DriftCollector::DriftCollector(std::vector<double> marks_s) : marks_s_(std::move(marks_s)) {}

void DriftCollector::add(const Outage& outage, int64_t t_ns, const Eigen::Vector3d& error_n,
                         const NormalizedSquares& normalized) {
  Samples& samples = outages_.try_emplace(outage.index, Samples{outage, {}}).first->second;
  samples.samples.push_back({seconds_between(outage.begin_ns, t_ns), error_n, normalized});
}

std::vector<OutageDrift> DriftCollector::complete(int64_t until_ns) const {
  std::vector<OutageDrift> drifts;
  for (const auto& [index, samples] : outages_) {
    if (samples.outage.end_ns > until_ns + kStampToleranceNs) continue;
    if (!sampled_to_the_end(samples.outage, samples.samples)) continue;
    drifts.push_back(outage_drift(samples.outage, samples.samples, marks_s_));
  }
  return drifts;
}

FixTruth::FixTruth(Callback callback, const state::Layout& layout)
    : callback_(std::move(callback)), layout_(layout) {}

void FixTruth::add(const Outage& outage, const GnssFix& fix) { waiting_.push_back({outage, fix}); }

void FixTruth::epoch(const state::Epoch& epoch) {
  while (!waiting_.empty() && waiting_.front().fix.t_ns < epoch.t_ns) waiting_.pop_front();
  if (waiting_.empty() || waiting_.front().fix.t_ns != epoch.t_ns) return;
  const Truth& truth = waiting_.front();
  callback_(truth.outage, truth.fix, epoch, fix_error(epoch, truth.fix, layout_));
  waiting_.pop_front();
}

}  // namespace foucault::evaluation
