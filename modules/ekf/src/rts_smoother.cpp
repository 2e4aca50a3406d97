#include "foucault/ekf/rts_smoother.h"

namespace foucault {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace

void RtsSmoother::Keeper::epoch(const Epoch&) {
  if (rate_ == EpochRate::imu && !recorder_.at_node()) {
    kept_.emplace_back(BetweenEpoch{recorder_.nodes().size() - 1, recorder_.state().motion});
  } else {
    kept_.emplace_back(NodeEpoch{recorder_.mark()});
  }
}

void RtsSmoother::Keeper::fix(const FixResult& result) {
  if (result.verdict == FixVerdict::used) {
    kept_.emplace_back(NodeFix{recorder_.mark(), result});
  } else {
    kept_.emplace_back(result);
  }
}

void RtsSmoother::Keeper::notice(const Notice& notice) { kept_.emplace_back(notice); }

FixResult RtsSmoother::Keeper::smoothed(const NodeFix& fix, const SmoothedNode& node) const {
  const StrapdownState& motion = node.state.motion;
  FixResult result = fix.result;
  result.postfit_n = displacement_n(motion.position, result.antenna, Place(motion.position)) -
                     motion.q_n_b * recorder_.nodes()[fix.node].p_b_a;
  return result;
}

void RtsSmoother::Keeper::give_out(Sink& sink) {
  recorder_.mark();  // so that every epoch has a node after it
  const std::vector<SmoothedNode> nodes = smooth(recorder_.nodes());
  const auto give = Overloaded{[&](const NodeEpoch& e) { sink.epoch(to_epoch(nodes[e.node])); },
                               [&](const BetweenEpoch& e) {
                                 sink.epoch(between(nodes[e.node], nodes[e.node + 1], e.forward));
                               },
                               [&](const NodeFix& f) { sink.fix(smoothed(f, nodes[f.node])); },
                               [&](const FixResult& f) { sink.fix(f); },
                               [&](const Notice& n) { sink.notice(n); }};
  for (const auto& kept : kept_) std::visit(give, kept);
}

RtsSmoother::RtsSmoother(const ImuNoise& imu, const EkfOptions& options, Aligner aligner,
                         const NavigationRunOptions& run_options, Sink& sink)
    : RtsSmoother(std::make_unique<RtsRecorder>(imu, options), std::move(aligner), run_options,
                  sink) {}

RtsSmoother::RtsSmoother(std::unique_ptr<RtsRecorder> recorder, Aligner aligner,
                         const NavigationRunOptions& run_options, Sink& sink)
    : keeper_(*recorder, run_options.rate),
      run_(std::move(recorder), std::move(aligner), run_options, keeper_),
      sink_(sink) {}

void RtsSmoother::finish() {
  run_.finish();
  keeper_.give_out(sink_);
}

}  // namespace foucault
