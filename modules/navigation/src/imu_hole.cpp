#include "imu_hole.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::navigation {

namespace {

using Eigen::Vector3d;

constexpr double kSlowest = 2.5;                // [m/s]: slower, a course says little
constexpr double kShortestWay = 0.4;            // [s] between the fixes of a course
constexpr double kCoarsest = 8 * kDegree;       // sigma of a useful course
constexpr double kSideslipSigma = 2 * kDegree;  // course against heading, in turns too
constexpr double kKnownTurnShare = 1.0 / 3.0;   // of the rate's sigma that a known turn leaves

/// A course and the gyroscopes' turn from the end of the hole to where it holds.
struct CourseAfter {
  double course = 0;
  double sigma = 0;
  double turned = 0;
};

/// Turn about the vertical from the hole's end, growing with the increments.
class TurnAfter {
 public:
  explicit TurnAfter(const ImuHole& hole)
      : down_b_(hole.before.q_n_b.conjugate() * Vector3d::UnitZ()), bias_(hole.before.bias.gyro) {}
  void add(const ImuIncrement& increment) {
    turned_ += down_b_.dot(increment.dtheta_b - bias_ * increment.dt());
  }
  double turned() const { return turned_; }

 private:
  Vector3d down_b_;
  Vector3d bias_;
  double turned_ = 0;
};

std::optional<CourseAfter> course_by_velocity(const GnssFix& fix, double turned) {
  const bool coarse = geodesy::horizontal_sigma(fix.position_covariance) > geodesy::kPreciseSigma;
  if (!coarse || !fix.velocity_n || fix.velocity_n->head<2>().norm() < kSlowest) {
    return std::nullopt;
  }
  return CourseAfter{geodesy::azimuth(*fix.velocity_n),
                     geodesy::course_sigma(fix.velocity_covariance, *fix.velocity_n), turned};
}

std::optional<CourseAfter> course_by_way(const GnssFix& first, double turned_first,
                                         const GnssFix& last, double turned_last) {
  const double dt = seconds_between(first.t_ns, last.t_ns);
  if (dt < kShortestWay) return std::nullopt;
  const Vector3d way = geodesy::LocalFrame(first.antenna).to_local(last.antenna);
  if (way.head<2>().norm() < kSlowest * dt) return std::nullopt;
  return CourseAfter{
      geodesy::azimuth(way),
      geodesy::course_sigma(first.position_covariance + last.position_covariance, way),
      0.5 * (turned_first + turned_last)};
}

std::optional<CourseAfter> course_after(const ImuHole& hole, const std::deque<Measurement>& after) {
  TurnAfter turn(hole);
  std::optional<GnssFix> first;
  double turned_first = 0;
  for (const Measurement& measurement : after) {
    if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) turn.add(*increment);
    const auto* fix = std::get_if<GnssFix>(&measurement);
    if (!fix || fix->t_ns < hole.after.t_begin_ns || !fix->position_covariance.allFinite())
      continue;
    std::optional<CourseAfter> course = course_by_velocity(*fix, turn.turned());
    if (!course && first) {
      course = course_by_way(*first, turned_first, *fix, turn.turned());
    }
    if (course) return course;
    if (!first) {
      first = *fix;
      turned_first = turn.turned();
    }
  }
  return std::nullopt;
}

}  // namespace

/// The first increment after a hole may be of any length, 100 ns where stamps are slips. Made-up
/// rates are linear in time: the bound, 5 ms in the longest hole there is by default, costs
/// nothing.
int64_t ImuHole::step_ns() const {
  constexpr double kMostSteps = 2000;
  return std::max<int64_t>(nanoseconds(std::max(interval, length() / kMostSteps)), 1);
}

std::optional<HoleTurn> turn_over(const ImuHole& hole, const std::deque<Measurement>& after) {
  const Vector3d& velocity = hole.before.velocity_n;
  const double speed = velocity.head<2>().norm();
  if (speed < kSlowest) return std::nullopt;
  const std::optional<CourseAfter> end = course_after(hole, after);
  if (!end || end->sigma > kCoarsest) return std::nullopt;
  const Eigen::Matrix3d P = hole.before.covariance_of(state::block::velocity);
  HoleTurn turn;
  turn.angle = so3::wrap(end->course - geodesy::azimuth(velocity) - end->turned);
  turn.sigma =
      std::hypot(std::hypot(end->sigma, geodesy::course_sigma(P, velocity)), kSideslipSigma);
  return turn;
}

ImuIncrement made_up_increment(const ImuHole& hole, const GapOptions& options, int64_t t_begin_ns,
                               int64_t t_end_ns) {
  ImuIncrement increment;
  increment.t_begin_ns = t_begin_ns;
  increment.t_end_ns = t_end_ns;
  const double dt = increment.dt(), T = hole.length();
  const Vector3d gyro_after = hole.after.dtheta_b / hole.after.dt();
  const Vector3d accel_after = hole.after.dvel_b / hole.after.dt();
  const double fraction = (seconds_between(hole.before.t_ns, t_begin_ns) + 0.5 * dt) / T;
  Vector3d gyro = (1 - fraction) * hole.gyro_before_b + fraction * gyro_after;
  Vector3d accel = (1 - fraction) * hole.accel_before_b + fraction * accel_after;
  double rate_sigma = options.rate_sigma_deg_s * kDegree;
  if (hole.turn) {
    const Vector3d down = hole.before.q_n_b.conjugate() * Vector3d::UnitZ();
    const Vector3d forward = hole.before.q_n_b.conjugate() * hole.before.velocity_n;
    const Vector3d interpolated = 0.5 * (hole.gyro_before_b + gyro_after) - hole.before.bias.gyro;
    const double shift = hole.turn->angle / T - down.dot(interpolated);
    gyro += shift * down;
    accel += shift * down.cross(forward);
    rate_sigma = std::max(kKnownTurnShare * rate_sigma, hole.turn->sigma / T);
  }
  increment.dtheta_b = gyro * dt;
  increment.dvel_b = accel * dt;
  increment.extra_gyro_noise_density = rate_sigma * std::sqrt(T);
  increment.extra_accel_noise_density = options.accel_sigma_m_s2 * std::sqrt(T);
  return increment;
}

}  // namespace foucault::navigation
