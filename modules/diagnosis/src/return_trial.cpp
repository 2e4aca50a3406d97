#include "foucault/diagnosis/return_trial.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "foucault/core/time.h"
#include "foucault/measurement/gnss_position.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLogOutlier = -4.6;  ///< log of one fix in a hundred; chosen
constexpr double kLogOffset = -4.6;   ///< log of one return in a hundred; chosen
/// Of the posterior, by KITTI with the noise of another IMU: 23 true fixes had odds of 33.
constexpr double kOffsetOdds = 100;
constexpr double kCertainOdds = 1000;
constexpr double kLongEnough = 5;        ///< [s], of fixes
constexpr std::size_t kEnoughFixes = 5;  ///< two to tell velocity, the others for outliers

double log_density(const Vector3d& value, const Matrix3d& covariance) {
  const Eigen::LLT<Matrix3d> llt(covariance);
  const Vector3d diagonal = Matrix3d(llt.matrixL()).diagonal();
  return -0.5 * value.dot(llt.solve(value)) - diagonal.array().log().sum();
}

/// Of an error whose size nobody knows before: as large as it is, on all axes.
double log_density_of_error(const Vector3d& value, const Matrix3d& covariance) {
  return log_density(value, covariance + value.squaredNorm() / 3 * Matrix3d::Identity());
}

}  // namespace

FixLikelihood likelihood_of(const state::Innovation& innovation) {
  const double true_fix = log_density(innovation.value, innovation.covariance);
  const double outlier =
      kLogOutlier + log_density_of_error(innovation.value, innovation.covariance);
  return {true_fix >= outlier, std::max(true_fix, outlier)};
}

ReturnTrial::ReturnTrial(const measurement::Navigator& navigator, const GnssFix& first,
                         double level)
    : level_(level), begin_ns_(first.t_ns), last_ns_(first.t_ns) {
  for (double scale = 1; scale <= kLargestScale; scale *= 2) add_scale(navigator, scale);
  add_offset(navigator,
             navigator.innovation(measurement::GnssPosition(first)).value.squaredNorm() / 3);
}

void ReturnTrial::add_scale(const measurement::Navigator& navigator, double scale) {
  Hypothesis& h = hypotheses_.emplace_back();
  h.navigator = navigator.ahead(scale);
  h.scale = scale;
  h.log_probability = -std::log(scale);
}

void ReturnTrial::add_offset(const measurement::Navigator& navigator, double variance) {
  state::NodeMatrix added = state::NodeMatrix::Zero();
  state::part(added.diagonal(), state::block::position).setConstant(variance);
  Hypothesis& h = hypotheses_.emplace_back();
  h.navigator = navigator.ahead(1);
  h.navigator->loosen(added);
  h.offset = true;
  h.log_probability = kLogOffset;
}

void ReturnTrial::propagate(const ImuIncrement& increment) {
  for (Hypothesis& h : hypotheses_) h.navigator->propagate(increment);
}

void ReturnTrial::add(const GnssFix& fix) {
  GnssFix trusted = fix;
  trusted.position_covariance *= level_;
  for (Hypothesis& h : hypotheses_) try_fix(h, trusted);
  last_ns_ = fix.t_ns;
}

void ReturnTrial::try_fix(Hypothesis& h, const GnssFix& fix) {
  const FixLikelihood likelihood =
      likelihood_of(h.navigator->innovation(measurement::GnssPosition(fix)));
  h.used.push_back(likelihood.is_true);
  h.log_probability += likelihood.log_density;
  if (likelihood.is_true) h.navigator->update(measurement::gnss_position(fix));
}

bool ReturnTrial::is_over() const {
  return hypotheses_.front().used.size() >= kEnoughFixes &&
         seconds_between(begin_ns_, last_ns_) >= kLongEnough;
}

/// Sigmas as they are unless others are kScaleOdds times as likely; of those that believe most of
/// the fixes, if there are any: else the largest.
const ReturnTrial::Hypothesis& ReturnTrial::best_scale() const {
  constexpr double kScaleOdds = 20;  // of the posterior
  const Hypothesis* best = nullptr;
  for (const Hypothesis& h : hypotheses_) {
    const auto used = std::count(h.used.begin(), h.used.end(), true);
    if (h.offset || 2 * static_cast<std::size_t>(used) < h.used.size()) continue;
    const double margin = best == &hypotheses_.front() ? std::log(kScaleOdds) : 0;
    if (!best || h.log_probability > best->log_probability + margin) best = &h;
  }
  return best ? *best : hypotheses_[hypotheses_.size() - 2];
}

ReturnTrial::Verdict ReturnTrial::verdict() const {
  const Hypothesis& believed = best_scale();
  const double odds = hypotheses_.back().log_probability - believed.log_probability;
  return {odds > std::log(kOffsetOdds), odds > std::log(kCertainOdds), believed.scale,
          believed.used};
}

}  // namespace foucault::diagnosis
