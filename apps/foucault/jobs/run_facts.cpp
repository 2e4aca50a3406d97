#include "jobs/run_facts.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/state/vehicle_attitude.h"

namespace foucault::app {
namespace {

constexpr std::size_t kMostNotices = 200;
constexpr double kStanding = 0.1;  // [m/s]
constexpr double kLongStep = 3;    // [s]: the way over it is straight

double way(const state::Epoch& from, const state::Epoch& to, double dt) {
  if (dt > kLongStep) return geodesy::LocalFrame(from.position).to_local(to.position).norm();
  const double speed = 0.5 * (from.velocity_n.norm() + to.velocity_n.norm());
  return speed > kStanding ? speed * dt : 0;
}

}  // namespace

void Level::add(double value) {
  if (!std::isfinite(value)) return;
  ++count_;
  sum_ += value;
  largest_ = std::max(largest_, value);
}

void RunFacts::measurement(const Measurement& measurement) {
  const int64_t t_ns = stamp(measurement);
  recording_begin_ns = std::min(t_ns, recording_begin_ns.value_or(t_ns));
  recording_end_ns = std::max(t_ns, recording_end_ns.value_or(t_ns));
  const auto* fix = std::get_if<GnssFix>(&measurement);
  if (fix == nullptr) return;
  ++fixes[fix->quality];
  if (lever_arm_b) return;
  lever_arm_b = fix->p_b_a;
  lever_arm_known = fix->lever_arm_known;
}

void RunFacts::epoch(const state::Epoch& epoch) {
  if (!begin_ns) begin_ns = epoch.t_ns;
  end_ns = epoch.t_ns;
  speed_m_s.add(epoch.velocity_n.norm());
  const Eigen::Vector3d position = epoch.sigma_of(state::block::position);
  const Eigen::Vector3d attitude = state::vehicle_attitude(epoch, mounting_).sigma;
  horizontal_sigma_m.add(position.head<2>().norm());
  vertical_sigma_m.add(position.z());
  tilt_sigma_rad.add(attitude.head<2>().maxCoeff());
  heading_sigma_rad.add(attitude.z());
  travel(epoch);
}

void RunFacts::travel(const state::Epoch& epoch) {
  if (last_) {
    const double dt = seconds_between(last_->t_ns, epoch.t_ns);
    const double step = dt > 0 ? way(*last_, epoch, dt) : 0;
    if (std::isfinite(step)) distance_m += step;
    if (step > 0) moving_s += dt;
  }
  last_ = epoch;
}

void RunFacts::notice(const state::Notice& notice) {
  ++notices_seen;
  if (notices.size() < kMostNotices) notices.push_back(notice);
}

}  // namespace foucault::app
