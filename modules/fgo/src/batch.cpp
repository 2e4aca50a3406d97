#include "foucault/fgo/batch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "graph_noise.h"
#include "node_epoch.h"

namespace foucault::fgo {

namespace {

state::NavState without_slow(const state::NavState& x) {
  state::NavState out = x;
  out.slow.resize(0);
  return out;
}

}  // namespace

void BatchOptions::fields(ConfigFields& f) {
  f.text("model", model, {"full", "refined", "rough"}, "preintegration of method batch");
  f.text("start", start, {"ekf", "full", "refined", "rough"},
         "forward method that gives the batch its first estimate");
  f.number("memory_mb", memory_mb, {1, 1e6},
           "of `run`: a log that takes more is smoothed in parts, in two passes");
}

preintegration::PreintegrationModel BatchOptions::preintegration_model() const {
  if (model == "rough") return preintegration::PreintegrationModel::rough;
  return model == "refined" ? preintegration::PreintegrationModel::refined
                            : preintegration::PreintegrationModel::full;
}

std::size_t BatchOptions::most_nodes(const state::Layout& layout) const {
  constexpr double kNode = 7500;  // [B], measured; and the covariance of what is smoothed
  constexpr double kFewest = 64;
  const auto size = static_cast<double>(layout.size());
  const double node = kNode + sizeof(double) * size * (size + 1) / 2;
  return static_cast<std::size_t>(std::max(kFewest, memory_mb * 1e6 / node));
}

BatchRecorder::BatchRecorder(std::unique_ptr<measurement::Navigator> forward,
                             const FgoOptions& options, preintegration::PreintegrationModel model,
                             const imu::ImuNoise& noise, const state::Layout& layout,
                             std::shared_ptr<BatchPasses> passes)
    : forward_(std::move(forward)),
      options_(options),
      context_{geodesy::LocalFrame(Geodetic{}), model, as_constants(layout)},
      noise_(noise),
      passes_(std::move(passes)),
      behind_(passes_ ? nodes_behind(passes_->known) : std::vector<NodeEstimate>()) {
  require_noise(noise);
}

void BatchRecorder::start(const state::Epoch& initial) {
  if (integrator_) mark();
  forward_->start(initial);
  if (chains_.empty()) context_.frame = geodesy::LocalFrame(initial.position);
  integrator_.reset();
  chains_.emplace_back().prior = prior_of(initial);
  add_node(initial);
}

SquareRootPrior BatchRecorder::prior_of(const state::Epoch& epoch) const {
  const state::Epoch whole = state::with_slow_blocks(epoch, context_.layout);
  return prior_from_covariance(to_node(whole, context_), whole.slow,
                               turned(whole.covariance, context_.frame.R_w_n(whole.position)));
}

void BatchRecorder::propagate(const ImuIncrement& increment) {
  forward_->propagate(increment);
  rates_.add(increment);
  integrator_->add(increment);
  open_.increments.push_back(increment);
}

void BatchRecorder::update(const measurement::ObservationPtr& observation) {
  mark();
  forward_->update(observation);
  const state::Epoch now = forward_->epoch();
  BatchNode& node = chains_.back().nodes.back();
  node.observations.push_back({observation, {rates_.gyro_b, rates_.accel_b}});
  node.x = to_node(now, context_);
  passages_.back().filtered = without_slow(now);
  begin_interval(now);
}

/// The interval that ends here gets the noise, or the prior if none does.
void BatchRecorder::loosen(const state::NodeMatrix& added) {
  mark();
  forward_->loosen(added);
  BatchChain& chain = chains_.back();
  const state::Epoch now = forward_->epoch();
  const state::NodeState& x = chain.nodes.back().x;
  if (chain.intervals.empty()) {
    chain.prior = prior_of(now);
    return;
  }
  const state::NodeMatrix added_w = turned(added, context_.frame.R_w_n(now.position));
  fgo::loosen(chain.intervals.back(), chain.nodes[chain.nodes.size() - 2].x, x, added_w,
              context_.layout);
}

void BatchRecorder::hold() {
  mark();
  forward_->hold();
}

std::size_t BatchRecorder::mark() {
  if (!at_node()) {
    close_interval();
    add_node(forward_->epoch());
  }
  return size() - 1;
}

void BatchRecorder::add_node(const state::Epoch& now) {
  BatchNode& node = chains_.back().nodes.emplace_back();
  node.t_ns = now.t_ns;
  node.x = to_node(now, context_);
  passages_.push_back({without_slow(now), without_slow(now)});
  begin_interval(now);
}

void BatchRecorder::begin_interval(const state::Epoch& now) {
  open_ = ImuInterval{};
  if (integrator_) open_.before = integrator_->previous();
  earth_ = preintegration::earth_model(context_.model, context_.frame,
                                       chains_.back().nodes.back().x.p_w_b);
  integrator_.emplace(
      noise_, now.bias, now.t_ns, open_.before,
      scale_of(context_.layout, state::with_slow_blocks(now, context_.layout).slow));
}

/// The increments are kept if five sigmas of the bias may turn the interval too far.
void BatchRecorder::close_interval() {
  const preintegration::Preintegration pre = measured(*integrator_, context_.model);
  const double bias_sigma = forward_->epoch().sigma_of(state::block::gyro_bias).maxCoeff();
  if (5 * bias_sigma * pre.dt < kReintegrationAngle) open_.increments.clear();
  open_.increments.shrink_to_fit();
  open_.factor = std::make_unique<PreintegrationFactor>(pre, earth_, context_.layout);
  chains_.back().intervals.push_back(std::move(open_));
}

std::deque<measurement::SmoothedEpoch> BatchRecorder::settled() {
  std::deque<measurement::SmoothedEpoch> out;
  if (!passes_) return out;
  while (chains_.size() > 1) smooth_first_chain(out);
  if (!chains_.empty() && chains_.back().nodes.size() >= passes_->most_nodes) smooth_part(out);
  return out;
}

void BatchRecorder::smooth_part(std::deque<measurement::SmoothedEpoch>& out) {
  const std::size_t index = passes_->found.size();
  const NodeEstimate* behind = index < behind_.size() ? &behind_[index] : nullptr;
  BatchPart part = solve_part(chains_.back(), context_, options_, noise_, behind);
  passes_->in_parts = true;
  passes_->found.push_back(part.link);
  give_out(part.solution, out);
}

std::deque<measurement::SmoothedEpoch> BatchRecorder::smoothed() {
  std::deque<measurement::SmoothedEpoch> out;
  while (!chains_.empty()) smooth_first_chain(out);
  return out;
}

void BatchRecorder::smooth_first_chain(std::deque<measurement::SmoothedEpoch>& out) {
  BatchSolution solution = solve(chains_.front(), context_, options_, noise_);
  if (passes_) {
    PartLink end;
    end.first = {solution.x.front(), solution.slow, solution.covariance_w.front().full()};
    end.ends_chain = true;
    passes_->found.push_back(end);
  }
  give_out(solution, out);
  chains_.pop_front();
}

void BatchRecorder::give_out(BatchSolution& solution, std::deque<measurement::SmoothedEpoch>& out) {
  for (std::size_t k = 0; k < solution.x.size(); ++k) {
    const Passage& passage = passages_.front();
    const state::Epoch epoch = to_epoch(passage.predicted.t_ns, solution.x[k], solution.slow,
                                        solution.covariance_w[k].full(), context_);
    solution.covariance_w[k] = {};
    out.push_back(smoothed_at(passage, epoch));
    passages_.pop_front();
    ++given_out_;
  }
}

measurement::SmoothedEpoch BatchRecorder::smoothed_at(const Passage& passage,
                                                      const state::Epoch& epoch) const {
  const state::NavState state = without_slow(epoch);
  return {epoch, state::PackedSymmetric(epoch.covariance),
          state::boxminus(state, passage.predicted), state::boxminus(state, passage.filtered)};
}

}  // namespace foucault::fgo
