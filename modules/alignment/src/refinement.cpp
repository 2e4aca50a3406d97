#include "refinement.h"

#include <cmath>

#include "foucault/core/so3.h"

namespace foucault::alignment {
namespace {

using Eigen::Vector3d;

/// Turn between two starts over the sigma of the first, about the axis that was turned about.
double moved(const state::Epoch& from, const state::Epoch& to) {
  const Vector3d turn = so3::log(from.q_n_b.conjugate() * to.q_n_b);
  const Eigen::Matrix3d covariance = from.covariance_of(state::block::attitude);
  return std::sqrt(turn.dot(covariance.inverse() * turn));
}

}  // namespace

Refined drive_over(const state::Epoch& start, const std::deque<Step>& steps,
                   const imu::ImuNoise& noise, const state::Layout& layout) {
  Trial trial(noise, layout, start);
  Refined result;
  result.start = start;
  for (const Step& step : steps) {
    if (const auto* increment = std::get_if<ImuIncrement>(&step)) {
      if (increment->t_begin_ns >= start.t_ns) trial.propagate(*increment);
    } else if (const GnssFix& fix = std::get<GnssFix>(step); fix.t_ns > start.t_ns) {
      trial.update(fix);
    }
  }
  result.end = trial.epoch();
  result.level = trial.level();
  result.settling = trial.settling();
  result.agreement = trial.agreement();
  return result;
}

std::optional<Refined> refine(const state::Epoch& found, double level,
                              const std::deque<Step>& steps, const imu::ImuNoise& noise,
                              const state::Layout& layout, const MakeStart& make_start) {
  constexpr int kRounds = 6;
  constexpr double kStays = 0.2;  // sigmas of the start, which are three times those found
  std::optional<state::Epoch> start = make_start(found, level);
  for (int round = 0; start && round < kRounds; ++round) {
    const Refined refined = drive_over(*start, steps, noise, layout);
    start = make_start(refined.end, refined.level);
    if (start && moved(refined.start, *start) < kStays) return refined;
  }
  return std::nullopt;
}

}  // namespace foucault::alignment
