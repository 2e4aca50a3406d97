#include "foucault/diagnosis/steady_way.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/time.h"

namespace foucault::diagnosis {

void SteadyWay::add(const GnssFix& fix, double sigma) {
  if (!frame_) {
    frame_.emplace(fix.antenna);
    first_ns_ = fix.t_ns;
  }
  const double t = seconds_between(first_ns_, fix.t_ns);
  const Eigen::Vector2d x = frame_->to_local(fix.antenna).head<2>();
  ++count_;
  t_ += t;
  tt_ += t * t;
  x_ += x;
  tx_ += t * x;
  xx_ += x.squaredNorm();
  variance_ += sigma * sigma;
}

std::optional<SteadyWay::Velocity> SteadyWay::velocity() const {
  const double spread = tt_ - t_ * t_ / count_;
  if (count_ < 3 || !(spread > 0)) return std::nullopt;
  Velocity velocity;
  velocity.mean = (tx_ - t_ * x_ / count_) / spread;
  const double about_mean = xx_ - x_.squaredNorm() / count_;
  const double about_line = about_mean - spread * velocity.mean.squaredNorm();
  const double freedom = 2 * (count_ - 2);
  const double variance = std::max(variance_ / count_, about_line / freedom);
  velocity.sigma = std::sqrt(variance / spread);
  return velocity;
}

}  // namespace foucault::diagnosis
