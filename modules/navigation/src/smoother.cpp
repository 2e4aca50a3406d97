#include "foucault/navigation/smoother.h"

#include <fmt/format.h>

#include "foucault/core/error.h"
#include "foucault/core/hermite.h"
#include "foucault/core/profile.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/place.h"
#include "sound_epoch.h"

namespace foucault::navigation {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

/// The error of the forward run between nodes. It is the error in n that changes smoothly.
state::NodeVector error_between(double s, double length, const measurement::SmoothedEpoch& begin,
                                const measurement::SmoothedEpoch& end,
                                const Eigen::Quaterniond& q_n_b) {
  using namespace state::block;
  const state::NodeVector& a = begin.after;
  const state::NodeVector& b = end.before;
  const Eigen::Vector3d attitude_n =
      (1 - s) * (begin.state.q_n_b * part(a, attitude)) + s * (end.state.q_n_b * part(b, attitude));
  state::NodeVector error = (1 - s) * a + s * b;
  part(error, position) = hermite(s, part(a, position), length * part(a, velocity),
                                  part(b, position), length * part(b, velocity));
  part(error, attitude) = q_n_b.conjugate() * attitude_n;
  return error;
}

void throw_if_unsound(const std::deque<measurement::SmoothedEpoch>& nodes) {
  for (const measurement::SmoothedEpoch& node : nodes) {
    const std::optional<std::string> part = unsound_part(node.epoch());
    if (!part) continue;
    throw DataError(fmt::format(
        "the smoothed solution's {} is not finite at {}; see how far a forward method comes", *part,
        utc_text(node.state.t_ns)));
  }
}

state::FixResult with_postfit(const state::FixResult& forward, const state::NavState& x) {
  state::FixResult result = forward;
  result.postfit_n =
      geodesy::displacement_n(x.position, result.antenna, geodesy::Place(x.position)) -
      x.q_n_b * result.p_b_a;
  return result;
}

}  // namespace

state::Epoch between(const measurement::SmoothedEpoch& begin, const measurement::SmoothedEpoch& end,
                     const state::NavState& forward) {
  const double length = seconds_between(begin.state.t_ns, end.state.t_ns);
  const double s = seconds_between(begin.state.t_ns, forward.t_ns) / length;
  state::Epoch epoch{state::boxplus(forward, error_between(s, length, begin, end, forward.q_n_b)),
                     (1 - s) * begin.covariance.full() + s * end.covariance.full()};
  epoch.bias.gyro = (1 - s) * begin.state.bias.gyro + s * end.state.bias.gyro;
  epoch.bias.accel = (1 - s) * begin.state.bias.accel + s * end.state.bias.accel;
  epoch.slow = (1 - s) * begin.state.slow + s * end.state.slow;
  return epoch;
}

void Smoother::Keeper::epoch(const state::Epoch& epoch) {
  if (rate_ == EpochRate::imu && !recording_.at_node()) {
    kept_.emplace_back(BetweenEpoch{recording_.size() - 1, epoch});
  } else {
    kept_.emplace_back(NodeEpoch{recording_.mark()});
  }
}

void Smoother::Keeper::fix(const state::FixResult& result) {
  if (result.verdict == state::FixVerdict::used) {
    kept_.emplace_back(NodeFix{recording_.mark(), result});
  } else {
    kept_.emplace_back(result);
  }
}

void Smoother::Keeper::notice(const state::Notice& notice) { kept_.emplace_back(notice); }

void Smoother::Keeper::give_out() {
  recording_.mark();  // so that every epoch has a node after it
  const StageTimer timer(Stage::smooth);
  const std::deque<measurement::SmoothedEpoch> nodes = recording_.smoothed();
  throw_if_unsound(nodes);
  const auto give =
      Overloaded{[&](const NodeEpoch& e) { sink_.epoch(nodes[e.node].epoch()); },
                 [&](const BetweenEpoch& e) {
                   sink_.epoch(between(nodes[e.node], nodes[e.node + 1], e.forward));
                 },
                 [&](const NodeFix& f) { sink_.fix(with_postfit(f.result, nodes[f.node].state)); },
                 [&](const state::FixResult& f) { sink_.fix(f); },
                 [&](const state::ObservationResult& o) { sink_.observation(o); },
                 [&](const state::Notice& n) { sink_.notice(n); }};
  for (const auto& kept : kept_) std::visit(give, kept);
  for (const state::Notice& warning : warnings_) sink_.warning(warning);
}

Smoother::Smoother(std::unique_ptr<measurement::Navigator> navigator,
                   measurement::Recording& recording, alignment::Aligner aligner,
                   const NavigationRunOptions& options, state::Sink& sink)
    : keeper_(recording, options.rate, sink),
      run_(std::move(navigator), std::move(aligner), options, keeper_) {}

void Smoother::finish() {
  run_.finish();
  keeper_.give_out();
}

}  // namespace foucault::navigation
