#include "foucault/navigation/smoother.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/hermite.h"
#include "foucault/core/profile.h"
#include "foucault/core/time.h"
#include "foucault/measurement/gnss_position.h"
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
  if (forward_ != nullptr) forward_->forward_epoch(epoch);
  if (rate_ == EpochRate::imu && !recording_.at_node()) {
    kept_.emplace_back(BetweenEpoch{recording_.size() - 1, epoch});
  } else {
    kept_.emplace_back(NodeEpoch{recording_.mark()});
  }
  give_out_settled();
}

void Smoother::Keeper::fix(const state::FixResult& result) {
  if (result.verdict == state::FixVerdict::used) {
    kept_.emplace_back(NodeFix{recording_.mark(), result});
  } else {
    kept_.emplace_back(result);
  }
}

void Smoother::Keeper::notice(const state::Notice& notice) { kept_.emplace_back(notice); }

/// With the lever arm and the clocks that were found. How the antenna swings and accelerates in
/// what is left of a time offset is left out.
state::FixResult Smoother::Keeper::with_postfit(const state::FixResult& forward,
                                                const state::NavState& x) const {
  GnssFix fix;
  fix.antenna = forward.antenna;
  fix.p_b_a = forward.p_b_a;
  if (first_fix_ns_) fix.since_first_s = seconds_between(*first_fix_ns_, forward.t_ns);
  state::FixResult result = forward;
  result.postfit_n =
      measurement::GnssPosition(fix).linearize(x, measurement::MeanMotion{}, layout_).r;
  return result;
}

const measurement::SmoothedEpoch* Smoother::Keeper::node_at(std::size_t node) const {
  return node - nodes_gone_ < nodes_.size() ? &nodes_[node - nodes_gone_] : nullptr;
}

bool Smoother::Keeper::give(const Kept& kept) {
  const auto at_node = [&](std::size_t index, const auto& give) {
    const measurement::SmoothedEpoch* node = node_at(index);
    if (node != nullptr) give(*node);
    return node != nullptr;
  };
  const auto freely = [](const auto& give) {
    give();
    return true;
  };
  return std::visit(
      Overloaded{
          [&](const NodeEpoch& e) {
            return at_node(e.node, [&](const auto& n) { sink_.epoch(n.epoch()); });
          },
          [&](const BetweenEpoch& e) {
            return at_node(e.node + 1, [&](const auto& next) {
              sink_.epoch(between(*node_at(e.node), next, e.forward));
            });
          },
          [&](const NodeFix& f) {
            return at_node(f.node,
                           [&](const auto& n) { sink_.fix(with_postfit(f.result, n.state)); });
          },
          [&](const state::FixResult& f) { return freely([&] { sink_.fix(f); }); },
          [&](const state::ObservationResult& o) { return freely([&] { sink_.observation(o); }); },
          [&](const state::Notice& n) { return freely([&] { sink_.notice(n); }); }},
      kept);
}

/// The last node may be the begin of epochs that follow it.
void Smoother::Keeper::give_out(std::deque<measurement::SmoothedEpoch> nodes) {
  throw_if_unsound(nodes);
  std::move(nodes.begin(), nodes.end(), std::back_inserter(nodes_));
  for (; !kept_.empty() && give(kept_.front()); kept_.pop_front()) {
  }
  for (; nodes_.size() > 1; ++nodes_gone_) nodes_.pop_front();
}

void Smoother::Keeper::give_out_settled() {
  std::deque<measurement::SmoothedEpoch> settled = recording_.settled();
  if (settled.empty()) return;
  const StageTimer timer(Stage::smooth);
  give_out(std::move(settled));
}

void Smoother::Keeper::give_out() {
  recording_.mark();  // so that every epoch has a node after it
  const StageTimer timer(Stage::smooth);
  give_out(recording_.smoothed());
  for (const state::Notice& warning : warnings_) sink_.warning(warning);
}

Smoother::Smoother(std::unique_ptr<measurement::Navigator> navigator,
                   measurement::Recording& recording, alignment::Aligner aligner,
                   const NavigationRunOptions& options, state::Sink& sink)
    : keeper_(recording, options.rate, sink, options.layout),
      run_(std::move(navigator), std::move(aligner), options, keeper_) {}

void Smoother::process(const Measurement& measurement) {
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) keeper_.first_fix(fix->t_ns);
  run_.process(measurement);
}

void Smoother::finish() {
  run_.finish();
  keeper_.give_out();
}

}  // namespace foucault::navigation
