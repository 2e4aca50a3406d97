#include "foucault/diagnosis/force_match.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foucault/core/median.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/diagnosis/missing.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/imu/increments.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Vector3d;

/// Chosen: a wrong scale of the gyroscopes of 20 % turns the force by 0.2 rad over kLargestTurn,
/// which shortens its mean by 2 %.
constexpr double kLongestWindow = 20;  // [s]
constexpr double kLargestTurn = 1;     // [rad]
/// A tenth of gravity, so that ten windows tell the factor to 4 %, a fifth of what is judged.
constexpr double kPrecise = 1;              // [m/s^2], sigma of the acceleration by fixes, any axis
constexpr std::size_t kFewestWindows = 10;  // windows
constexpr std::size_t kMost = 1000;         // windows; chosen: bounds memory, 0.4 %
/// Where fixes tell of more, one of them may be wrong: 5 m off make 20 m/s^2 at 1 Hz. With 30 % of
/// outliers of 50 to 500 m rtk_car was refused without this.
constexpr double kGentle = 4;  // [m/s^2]

/// Second difference over a, m, b: the mean acceleration, weighted by a triangle with its top at m.
Vector3d second_difference(const Vector3d& a, const Vector3d& m, const Vector3d& b, double h1,
                           double h2) {
  return 2 / (h1 + h2) * ((b - m) / h2 - (m - a) / h1);
}

double second_difference_sigma(double sigma, double h1, double h2) {
  const double middle = 1 / h1 + 1 / h2;
  return 2 / (h1 + h2) * sigma * std::sqrt(1 / (h1 * h1) + middle * middle + 1 / (h2 * h2));
}

double largest_sigma(const GnssFix& fix) {
  return std::sqrt(fix.position_covariance.diagonal().maxCoeff());
}

}  // namespace

void ForceMatch::Motion::add(const ImuIncrement& increment) {
  const double dt = increment.dt();
  const Vector3d dv = q_a_b * (so3::exp(0.5 * increment.dtheta_b) * increment.dvel_b);
  position += velocity * dt + 0.5 * dv * dt;
  velocity += dv;
  q_a_b = (q_a_b * so3::exp(increment.dtheta_b)).normalized();
  turned += increment.dtheta_b.norm();
}

void ForceMatch::add(const ImuIncrement& increment) {
  const bool hole = last_ns_ && seconds_between(*last_ns_, increment.t_begin_ns) > kLongestMissing;
  if (hole) {
    a_.reset();
    due_.reset();
  }
  last_ns_ = increment.t_end_ns;
  if (due_ && due_->t_ns > increment.t_begin_ns && due_->t_ns < increment.t_end_ns) {
    const auto [until, after] = imu::split(increment, due_->t_ns);
    motion_.add(until);
    add_at(*std::exchange(due_, std::nullopt));
    motion_.add(after);
    return;
  }
  if (due_ && due_->t_ns <= increment.t_begin_ns) add_at(*std::exchange(due_, std::nullopt));
  motion_.add(increment);
}

void ForceMatch::add(const GnssFix& fix) {
  if (due_ || !last_ns_ || fix.t_ns < *last_ns_) return;
  if (seconds_between(*last_ns_, fix.t_ns) < kLongestWindow) due_ = fix;
}

void ForceMatch::restart(const GnssFix& fix) {
  motion_ = Motion();
  a_ = Point{fix, fix.p_b_a};
  m_.reset();
}

void ForceMatch::add_at(const GnssFix& fix) {
  if (!(largest_sigma(fix) > 0)) return;
  const bool over = a_ && (seconds_between(a_->fix.t_ns, fix.t_ns) > kLongestWindow ||
                           motion_.turned > kLargestTurn);
  if (!a_ || over) return restart(fix);
  const double sigma = std::max(largest_sigma(a_->fix), largest_sigma(fix));
  const Point point{fix, motion_.position + motion_.q_a_b * fix.p_b_a};
  const double from_a = seconds_between(a_->fix.t_ns, fix.t_ns);
  if (!m_) {
    if (second_difference_sigma(sigma, from_a, from_a) <= kPrecise) m_ = point;
    return;
  }
  const double h1 = seconds_between(a_->fix.t_ns, m_->fix.t_ns);
  const double h2 = seconds_between(m_->fix.t_ns, fix.t_ns);
  if (second_difference_sigma(sigma, h1, h2) > 1.01 * kPrecise) return;
  compare(point);
  restart(fix);
}

void ForceMatch::compare(const Point& b) {
  const double h1 = seconds_between(a_->fix.t_ns, m_->fix.t_ns);
  const double h2 = seconds_between(m_->fix.t_ns, b.fix.t_ns);
  const geodesy::LocalFrame frame(m_->fix.antenna);
  const Vector3d acceleration_n = second_difference(
      frame.to_local(a_->fix.antenna), Vector3d::Zero(), frame.to_local(b.fix.antenna), h1, h2);
  const double gravity =
      geodesy::wgs84::normal_gravity(m_->fix.antenna.latitude, m_->fix.antenna.height);
  if (acceleration_n.norm() > kGentle) return;
  const double expected = (acceleration_n - gravity * Vector3d::UnitZ()).norm();
  const double ratio =
      second_difference(a_->antenna, m_->antenna, b.antenna, h1, h2).norm() / expected;
  if (ratios_.size() < kMost) {
    ratios_.push_back(ratio);
  } else {
    ratios_[next_] = ratio;
    next_ = (next_ + 1) % kMost;
  }
}

/// The median of n values has 1.25 sigma / sqrt(n); their sigma is 1.48 of the median deviation.
std::optional<MeasuredFactor> ForceMatch::factor() const {
  if (ratios_.size() < kFewestWindows) return std::nullopt;
  MeasuredFactor factor;
  factor.value = median(ratios_);
  std::vector<double> deviations;
  for (const double ratio : ratios_) deviations.push_back(std::abs(ratio - factor.value));
  factor.sigma = 1.25 * 1.48 * median(deviations) / std::sqrt(static_cast<double>(ratios_.size()));
  factor.samples = static_cast<int64_t>(ratios_.size());
  return factor;
}

}  // namespace foucault::diagnosis
