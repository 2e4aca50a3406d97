#include "foucault/fgo/batch.h"

#include <cmath>
#include <deque>

#include "chain_problem.h"
#include "foucault/core/profile.h"
#include "foucault/fgo/chain.h"
#include "foucault/measurement/gnss_position.h"
#include "graph_noise.h"
#include "node_epoch.h"

namespace foucault {
namespace {

/// The second order of gravity is 3 g (d / R)^2 or less: 7e-7 m/s^2.
constexpr double kGravityIsLinear = 1000;  // [m]

/// Forward runs that were off by tens of kilometres need two.
constexpr int kRounds = 5;

/// The chain with its factors.
class BatchGraph {
 public:
  BatchGraph(BatchChain& chain, const FgoOptions& options)
      : chain_(chain), options_(options), loss_(make_loss(options)), prior_(chain.prior) {
    for (const BatchNode& node : chain.nodes) {
      x_.push_back(node.x);
      std::deque<GnssFactor>& fixes = fixes_.emplace_back();
      for (const LocalFix& fix : node.fixes) fixes.emplace_back(fix);
    }
  }

  void optimize() {
    ChainProblem problem(x_[0], prior_, loss_.get());
    for (GnssFactor& fix : fixes_[0]) problem.add_fix(fix);
    for (std::size_t k = 1; k < x_.size(); ++k) {
      problem.add_node(x_[k], *chain_.intervals[k - 1].factor);
      for (GnssFactor& fix : fixes_[k]) problem.add_fix(fix);
    }
    problem.optimize(options_);
    for (std::size_t k = 0; k < x_.size(); ++k) x_[k] = problem.state(k);
  }

  /// New factors where biases or places have left those of the first estimate. True if there were
  /// any.
  bool renew_factors(const ImuNoise& noise, PreintegrationModel model) {
    bool renewed = false;
    for (std::size_t k = 0; k < chain_.intervals.size(); ++k) {
      const bool integrated = reintegrate_moved_bias(k, noise, model);
      const bool placed = model == PreintegrationModel::full && move_earth(k);
      renewed = renewed || integrated || placed;
    }
    return renewed;
  }

  const std::vector<NodeState>& states() const { return x_; }

  /// Adds what the node itself brings: its fixes, and the prior at the first.
  void add_own(std::size_t k, NodeInformation& information) const {
    if (k == 0) information.add(prior_.linearize(x_[0]));
    for (const GnssFactor& factor : fixes_[k]) {
      const GnssFactor::Linearized fix = factor.linearize(x_[k]);
      information.add(fix, loss_weight(loss_.get(), fix));
    }
  }

  /// The interval from node k to k + 1.
  MotionResidual interval(std::size_t k) const {
    return chain_.intervals[k].factor->linearize(x_[k], x_[k + 1]);
  }

 private:
  bool reintegrate_moved_bias(std::size_t k, const ImuNoise& noise, PreintegrationModel model) {
    ImuInterval& interval = chain_.intervals[k];
    if (interval.increments.empty()) return false;
    if (!bias_moved(interval.factor->preintegration(), x_[k].bias)) return false;
    reintegrate(interval, x_[k].bias, noise, model);
    return true;
  }

  /// Gravity is linear about the place where the forward run was.
  bool move_earth(std::size_t k) {
    std::unique_ptr<PreintegrationFactor>& factor = chain_.intervals[k].factor;
    const Eigen::Vector3d& p_w = x_[k].p_w_b;
    if ((p_w - factor->earth().p_ref).norm() < kGravityIsLinear) return false;
    factor = std::make_unique<PreintegrationFactor>(
        factor->preintegration(), earth_model(PreintegrationModel::full, chain_.frame, p_w));
    return true;
  }

  BatchChain& chain_;
  const FgoOptions& options_;
  std::unique_ptr<ceres::LossFunction> loss_;
  PriorFactor prior_;
  std::vector<NodeState> x_;
  std::vector<std::deque<GnssFactor>> fixes_;  ///< of each node
};

MotionResidual reversed(const MotionResidual& interval) {
  return {interval.r, interval.J_x1, interval.J_x0};
}

/// Information on every node from all before it and from all behind it; their sum's inverse.
std::vector<Matrix15d> covariances(const BatchGraph& graph) {
  const StageTimer timer(Stage::covariance);
  const std::size_t nodes = graph.states().size();
  std::vector<Matrix15d> result(nodes);  // the root from before, until it is the covariance
  NodeInformation from_before;
  for (std::size_t k = 0; k < nodes; ++k) {
    if (k > 0) from_before = eliminate(from_before, graph.interval(k - 1)).rest;
    graph.add_own(k, from_before);
    result[k] = from_before.S;
  }
  NodeInformation from_behind;
  for (std::size_t k = nodes; k-- > 0;) {
    NodeInformation all = from_behind;
    all.add(NodeInformation{result[k], Vector15d::Zero()});
    result[k] = covariance(all);
    if (k == 0) break;
    graph.add_own(k, from_behind);
    from_behind = eliminate(from_behind, reversed(graph.interval(k - 1))).rest;
  }
  return result;
}

}  // namespace

void BatchOptions::fields(ConfigFields& f) {
  f.text("model", model, {"full", "refined", "rough"}, "preintegration of method batch");
  f.text("start", start, {"ekf", "full", "refined", "rough"},
         "forward method that gives the batch its first estimate");
}

PreintegrationModel BatchOptions::preintegration_model() const {
  if (model == "rough") return PreintegrationModel::rough;
  return model == "refined" ? PreintegrationModel::refined : PreintegrationModel::full;
}

BatchSolution solve(BatchChain& chain, const FgoOptions& options, PreintegrationModel model,
                    const ImuNoise& noise) {
  const StageTimer timer(Stage::solve);
  BatchGraph graph(chain, options);
  graph.optimize();
  for (int round = 0; round < kRounds && graph.renew_factors(noise, model); ++round) {
    graph.optimize();
  }
  return {graph.states(), covariances(graph)};
}

// The forward run -------------------------------------------------------------------------------

BatchRecorder::BatchRecorder(std::unique_ptr<Navigator> forward, const FgoOptions& options,
                             PreintegrationModel model, const ImuNoise& noise)
    : forward_(std::move(forward)), options_(options), model_(model), noise_(noise) {
  require_noise(noise);
}

void BatchRecorder::start(const Epoch& initial) {
  if (integrator_) mark();
  forward_->start(initial);
  if (!frame_) frame_.emplace(initial.position);
  integrator_.reset();
  BatchChain& chain = chains_.emplace_back();
  chain.frame = *frame_;
  chain.prior = prior_from_covariance(to_node(initial, *frame_, model_), covariance_w(initial));
  add_node(initial);
}

void BatchRecorder::propagate(const ImuIncrement& increment) {
  forward_->propagate(increment);
  integrator_->add(increment);
  open_.increments.push_back(increment);
}

void BatchRecorder::update(const ObservationPtr& observation) {
  const GnssFix fix = dynamic_cast<const GnssPosition&>(*observation).fix();
  mark();
  forward_->update(observation);
  const Epoch now = forward_->epoch();
  BatchNode& node = chains_.back().nodes.back();
  node.fixes.push_back(to_local(fix, *frame_));
  node.x = to_node(now, *frame_, model_);
  passages_.back().filtered = now;
  begin_interval(now);
}

Matrix15d BatchRecorder::covariance_w(const Epoch& now) const {
  return turned(now.covariance, frame_->R_w_n(now.position));
}

/// The interval that ends here gets the noise, or the prior if none does.
void BatchRecorder::loosen(const Matrix15d& added) {
  mark();
  forward_->loosen(added);
  BatchChain& chain = chains_.back();
  const Epoch now = forward_->epoch();
  if (chain.intervals.empty()) {
    chain.prior = prior_from_covariance(chain.nodes.back().x, covariance_w(now));
    return;
  }
  const NodeState& before = chain.nodes[chain.nodes.size() - 2].x;
  const MotionResidual m = unwhitened(chain.intervals.back(), before, chain.nodes.back().x);
  const Matrix15d added_w = turned(added, frame_->R_w_n(now.position));
  foucault::loosen(chain.intervals.back(), m.J_x1 * added_w * m.J_x1.transpose());
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
  node.x = to_node(now, *frame_, model_);
  Passage& passage = passages_.emplace_back();
  passage.predicted = passage.filtered = now;
  begin_interval(now);
}

void BatchRecorder::begin_interval(const Epoch& now) {
  open_ = ImuInterval{};
  if (integrator_) open_.before = integrator_->previous();
  earth_ = earth_model(model_, *frame_, chains_.back().nodes.back().x.p_w_b);
  integrator_.emplace(noise_, now.bias, now.t_ns, open_.before);
}

/// The increments are kept if five sigmas of the bias may turn the interval too far.
void BatchRecorder::close_interval() {
  const Preintegration pre = measured(*integrator_, model_);
  const double bias_sigma = std::sqrt(
      forward_->epoch().covariance.diagonal().segment<3>(error_state::kGyroBias).maxCoeff());
  if (5 * bias_sigma * pre.dt < kReintegrationAngle) open_.increments = {};
  open_.factor = std::make_unique<PreintegrationFactor>(pre, earth_);
  chains_.back().intervals.push_back(std::move(open_));
}

std::deque<SmoothedEpoch> BatchRecorder::smoothed() {
  std::deque<SmoothedEpoch> out;
  for (BatchChain& chain : chains_) {
    const BatchSolution solution = solve(chain, options_, model_, noise_);
    for (std::size_t k = 0; k < chain.nodes.size(); ++k) {
      const Epoch epoch =
          to_epoch(chain.nodes[k].t_ns, solution.x[k], solution.covariance_w[k], *frame_, model_);
      out.push_back(smoothed_at(passages_[out.size()], epoch));
    }
  }
  return out;
}

SmoothedEpoch BatchRecorder::smoothed_at(const Passage& passage, const Epoch& epoch) const {
  return {epoch, PackedSymmetric(epoch.covariance), boxminus(epoch, passage.predicted),
          boxminus(epoch, passage.filtered)};
}

std::unique_ptr<Estimator> make_batch_smoother(std::unique_ptr<Navigator> forward,
                                               const FgoOptions& options, PreintegrationModel model,
                                               const ImuNoise& noise, Aligner aligner,
                                               const NavigationRunOptions& run_options,
                                               Sink& sink) {
  auto recorder = std::make_unique<BatchRecorder>(std::move(forward), options, model, noise);
  BatchRecorder& recording = *recorder;
  return std::make_unique<Smoother>(std::move(recorder), recording, std::move(aligner), run_options,
                                    sink);
}

}  // namespace foucault
