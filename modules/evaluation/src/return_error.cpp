#include "foucault/evaluation/return_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "foucault/core/time.h"

namespace foucault::evaluation {
namespace {

bool in_window(int64_t begin_ns, int64_t t_ns) {
  return t_ns >= begin_ns && t_ns <= begin_ns + nanoseconds(kReturnWindowS) + kStampToleranceNs;
}

}  // namespace

bool ReturnCollector::fix(const Outage& before, const GnssFix& fix) {
  if (returns_.empty() || returns_.rbegin()->second.outage_index != before.index) {
    returns_.emplace_hint(returns_.end(), fix.t_ns, Return{before.index, 0, 0, 0, {}});
  }
  if (!in_window(returns_.rbegin()->first, fix.t_ns)) return false;
  const Eigen::LLT<Eigen::Matrix2d> llt(fix.position_covariance.topLeftCorner<2, 2>());
  if (llt.info() == Eigen::Success) {
    fixes_.push_back({fix.t_ns, llt.solve(Eigen::Matrix2d::Identity())});
  }
  return true;
}

void ReturnCollector::error(int64_t t_ns, const Eigen::Vector3d& error_n) {
  auto at = returns_.upper_bound(t_ns);
  if (at == returns_.begin() || !in_window((--at)->first, t_ns)) return;
  const Eigen::Vector2d horizontal = error_n.head<2>();
  const double size =
      error_n.allFinite() ? horizontal.norm() : std::numeric_limits<double>::infinity();
  Return& r = at->second;
  ++r.samples;
  r.sum_of_squares += size * size;
  r.maximum = std::max(r.maximum, size);
  if (!within_three_sigma(at->first, t_ns, horizontal)) {
    r.settled_ns.reset();
  } else if (!r.settled_ns) {
    r.settled_ns = t_ns;
  }
}

/// By the last fix up to t_ns that has a sigma; false if the return has none.
bool ReturnCollector::within_three_sigma(int64_t begin_ns, int64_t t_ns,
                                         const Eigen::Vector2d& error) {
  while (fixes_.size() > 1 && fixes_[1].t_ns <= t_ns) fixes_.pop_front();
  if (fixes_.empty() || fixes_.front().t_ns < begin_ns || fixes_.front().t_ns > t_ns) return false;
  return error.dot(fixes_.front().information * error) <= 9;
}

std::map<int64_t, ReturnError> ReturnCollector::results() const {
  std::map<int64_t, ReturnError> results;
  for (const auto& [begin_ns, r] : returns_) {
    if (r.samples == 0) continue;
    ReturnError error{std::sqrt(r.sum_of_squares / static_cast<double>(r.samples)), r.maximum, {}};
    if (r.settled_ns) error.settled_s = seconds_between(begin_ns, *r.settled_ns);
    results.emplace(r.outage_index, error);
  }
  return results;
}

}  // namespace foucault::evaluation
