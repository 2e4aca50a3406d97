#include "foucault/ekf/rts_smoother.h"

namespace foucault {
namespace {

Epoch to_epoch(const RtsNode& node) {
  const StrapdownState& motion = node.filtered.motion;
  Epoch epoch;
  epoch.t_ns = motion.t_ns;
  epoch.position = motion.position;
  epoch.velocity_n = motion.v_n;
  epoch.q_n_b = motion.q_n_b;
  epoch.bias = node.filtered.bias;
  epoch.covariance =
      node.filtered_covariance.topLeftCorner<error_state::kSize, error_state::kSize>();
  return epoch;
}

/// Fix minus smoothed antenna [m].
Eigen::Vector3d postfit_n(const RtsNode& node, const Geodetic& antenna) {
  const StrapdownState& motion = node.filtered.motion;
  return displacement_n(motion.position, antenna, Place(motion.position)) -
         motion.q_n_b * node.p_b_a;
}

}  // namespace

void RtsSmoother::Keeper::epoch(const Epoch&) { kept_.emplace_back(NodeEpoch{recorder_.mark()}); }

void RtsSmoother::Keeper::fix(const FixResult& result) {
  kept_.emplace_back(NodeFix{recorder_.mark(), result});
}

void RtsSmoother::Keeper::notice(const Notice& notice) { kept_.emplace_back(notice); }

void RtsSmoother::Keeper::give_out(Sink& sink) const {
  const std::vector<RtsNode>& nodes = recorder_.nodes();
  for (const auto& kept : kept_) {
    if (const auto* epoch = std::get_if<NodeEpoch>(&kept)) {
      sink.epoch(to_epoch(nodes[epoch->node]));
    } else if (const auto* fix = std::get_if<NodeFix>(&kept)) {
      FixResult result = fix->result;
      if (result.verdict == FixVerdict::used) {
        result.postfit_n = postfit_n(nodes[fix->node], result.antenna);
      }
      sink.fix(result);
    } else {
      sink.notice(std::get<Notice>(kept));
    }
  }
}

RtsSmoother::RtsSmoother(const ImuNoise& imu, const EkfOptions& options, Aligner aligner,
                         const NavigationRunOptions& run_options, Sink& sink)
    : RtsSmoother(std::make_unique<RtsRecorder>(imu, options), std::move(aligner), run_options,
                  sink) {}

RtsSmoother::RtsSmoother(std::unique_ptr<RtsRecorder> recorder, Aligner aligner,
                         const NavigationRunOptions& run_options, Sink& sink)
    : recorder_(*recorder),
      keeper_(recorder_),
      run_(std::move(recorder), std::move(aligner), run_options, keeper_),
      sink_(sink) {}

void RtsSmoother::finish() {
  run_.finish();
  smooth(recorder_.nodes());
  keeper_.give_out(sink_);
}

}  // namespace foucault
