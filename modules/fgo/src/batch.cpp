#include "foucault/fgo/batch.h"

#include <cmath>

#include "graph_noise.h"
#include "node_epoch.h"

namespace foucault {

void BatchOptions::fields(ConfigFields& f) {
  f.text("model", model, {"full", "refined", "rough"}, "preintegration of method batch");
  f.text("start", start, {"ekf", "full", "refined", "rough"},
         "forward method that gives the batch its first estimate");
}

PreintegrationModel BatchOptions::preintegration_model() const {
  if (model == "rough") return PreintegrationModel::rough;
  return model == "refined" ? PreintegrationModel::refined : PreintegrationModel::full;
}

BatchRecorder::BatchRecorder(std::unique_ptr<Navigator> forward, const FgoOptions& options,
                             PreintegrationModel model, const ImuNoise& noise, const Layout& layout)
    : forward_(std::move(forward)),
      options_(options),
      context_{LocalFrame(Geodetic{}), model, layout},
      noise_(noise) {
  require_noise(noise);
}

void BatchRecorder::start(const Epoch& initial) {
  if (integrator_) mark();
  forward_->start(initial);
  if (chains_.empty()) context_.frame = LocalFrame(initial.position);
  integrator_.reset();
  BatchChain& chain = chains_.emplace_back();
  chain.prior = prior_from_covariance(to_node(initial, context_),
                                      SlowVector::Zero(context_.layout.slow_size()),
                                      covariance_w(initial, context_));
  add_node(initial);
}

void BatchRecorder::propagate(const ImuIncrement& increment) {
  forward_->propagate(increment);
  integrator_->add(increment);
  open_.increments.push_back(increment);
}

void BatchRecorder::update(const GnssFix& fix) {
  mark();
  forward_->update(fix);
  const Epoch now = forward_->epoch();
  BatchNode& node = chains_.back().nodes.back();
  node.observations.push_back({gnss_position(fix), newest_rate(*integrator_)});
  node.x = to_node(now, context_);
  Passage& passage = passages_.back();
  passage.filtered = {now.t_ns, now.position, now.velocity_n, now.q_n_b};
  passage.filtered_bias = now.bias;
  passage.p_b_a = fix.p_b_a;
  begin_interval(now);
}

/// The interval that ends here gets the noise, or the prior if none does.
void BatchRecorder::loosen(const NodeMatrix& added) {
  mark();
  forward_->loosen(added);
  BatchChain& chain = chains_.back();
  const Epoch now = forward_->epoch();
  const NodeState& x = chain.nodes.back().x;
  if (chain.intervals.empty()) {
    chain.prior = prior_from_covariance(x, chain.prior.slow_at, covariance_w(now, context_));
    return;
  }
  const NodeMatrix added_w = turned(added, context_.frame.R_w_n(now.position));
  foucault::loosen(chain.intervals.back(), chain.nodes[chain.nodes.size() - 2].x, x, added_w,
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
  return passages_.size() - 1;
}

void BatchRecorder::add_node(const Epoch& now) {
  BatchNode& node = chains_.back().nodes.emplace_back();
  node.t_ns = now.t_ns;
  node.x = to_node(now, context_);
  Passage& passage = passages_.emplace_back();
  passage.predicted = passage.filtered = {now.t_ns, now.position, now.velocity_n, now.q_n_b};
  passage.predicted_bias = passage.filtered_bias = now.bias;
  begin_interval(now);
}

void BatchRecorder::begin_interval(const Epoch& now) {
  open_ = ImuInterval{};
  if (integrator_) open_.before = integrator_->previous();
  earth_ = earth_model(context_.model, context_.frame, chains_.back().nodes.back().x.p_w_b);
  integrator_.emplace(noise_, now.bias, now.t_ns, open_.before);
}

/// The increments are kept if five sigmas of the bias may turn the interval too far.
void BatchRecorder::close_interval() {
  const Preintegration pre = measured(*integrator_, context_.model);
  const double bias_sigma =
      std::sqrt(part(forward_->epoch().covariance.diagonal(), block::gyro_bias).maxCoeff());
  if (5 * bias_sigma * pre.dt < kReintegrationAngle) open_.increments = {};
  open_.factor = std::make_unique<PreintegrationFactor>(pre, earth_, context_.layout);
  chains_.back().intervals.push_back(std::move(open_));
}

std::vector<SmoothedEpoch> BatchRecorder::smoothed() {
  std::vector<SmoothedEpoch> out;
  out.reserve(passages_.size());
  for (BatchChain& chain : chains_) {
    const BatchSolution solution = solve(chain, context_, options_, noise_);
    chain.intervals.clear();
    for (std::size_t k = 0; k < chain.nodes.size(); ++k) {
      const Epoch epoch = to_epoch(chain.nodes[k].t_ns, solution.x[k], solution.slow,
                                   solution.covariance_w[k], context_);
      out.push_back(smoothed_at(passages_[out.size()], epoch));
    }
  }
  return out;
}

SmoothedEpoch BatchRecorder::smoothed_at(const Passage& passage, const Epoch& epoch) const {
  const StrapdownState state{epoch.t_ns, epoch.position, epoch.velocity_n, epoch.q_n_b};
  const auto error = [&](const StrapdownState& forward, const ImuBias& bias) {
    NodeVector e;
    e << difference(forward, state), epoch.bias.gyro - bias.gyro, epoch.bias.accel - bias.accel;
    return e;
  };
  return {epoch, error(passage.predicted, passage.predicted_bias),
          error(passage.filtered, passage.filtered_bias), passage.p_b_a};
}

std::unique_ptr<Estimator> make_batch_smoother(std::unique_ptr<Navigator> forward,
                                               const FgoOptions& options, PreintegrationModel model,
                                               const ImuNoise& noise, Aligner aligner,
                                               const NavigationRunOptions& run_options, Sink& sink,
                                               const Layout& layout) {
  auto recorder =
      std::make_unique<BatchRecorder>(std::move(forward), options, model, noise, layout);
  BatchRecorder& recording = *recorder;
  return std::make_unique<Smoother>(std::move(recorder), recording, std::move(aligner), run_options,
                                    sink);
}

}  // namespace foucault
