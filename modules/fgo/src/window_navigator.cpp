#include "foucault/fgo/window_navigator.h"

#include <algorithm>

#include "chain_problem.h"
#include "foucault/core/profile.h"
#include "foucault/core/time.h"
#include "graph_noise.h"
#include "node_epoch.h"
#include "robust_loss.h"

namespace foucault::fgo {
namespace {

/// What a turn d leaves out of the quadratic form is of second order: with 2e-4 rad, 2e-8 of a
/// velocity increment and 0.02 % of a sigma.
constexpr double kSettled = 2e-4;  // [rad]

/// Nor does a residual count that is off by less. [sigma]
constexpr double kSettledResidual = 0.05;

/// Each round solves a longer part of the window; the whole of it within a few.
constexpr int kRounds = 8;

}  // namespace

WindowNavigator::WindowNavigator(const FgoOptions& options,
                                 preintegration::PreintegrationModel model,
                                 const imu::ImuNoise& noise, const state::Layout& layout)
    : options_(options),
      context_{geodesy::LocalFrame(Geodetic{}), model, as_constants(layout)},
      noise_(noise),
      loss_(make_loss(options)),
      slow_(state::SlowVector::Zero(layout.slow_size())) {
  require_noise(noise);
}

WindowNavigator::~WindowNavigator() = default;

void WindowNavigator::start(const state::Epoch& initial) {
  integrator_.reset();
  context_.frame = geodesy::LocalFrame(initial.position);
  const state::Epoch whole = state::with_slow_blocks(initial, context_.layout);
  slow_ = whole.slow;
  begin_window(initial.t_ns, to_node(whole, context_),
               turned(whole.covariance, context_.frame.R_w_n(whole.position)));
}

/// A window of one node.
void WindowNavigator::begin_window(int64_t t_ns, const state::NodeState& x,
                                   const state::StateMatrix& covariance) {
  nodes_.clear();
  intervals_.clear();
  Node& node = nodes_.emplace_back();
  node.t_ns = t_ns;
  node.x = x;
  covariance_ = covariance;
  prior_ = prior_from_covariance(node.x, slow_, covariance_);
  linearize(0);
  begin_interval();
}

void WindowNavigator::loosen(const state::NodeMatrix& added) {
  Prediction now = prediction();
  const Eigen::Matrix3d R_w_n = context_.frame.R_w_n(context_.frame.to_geodetic(now.x.p_w_b));
  state::node_part(now.covariance) += turned(added, R_w_n);
  begin_window(integrator_->t_end_ns(), now.x, now.covariance);
}

std::unique_ptr<measurement::Navigator> WindowNavigator::ahead(double scale) const {
  const Prediction now = prediction();
  auto copy = std::make_unique<WindowNavigator>(options_, context_.model, noise_, context_.layout);
  copy->is_trial_ = true;
  copy->context_.frame = context_.frame;
  copy->slow_ = slow_;
  copy->rates_ = rates_;
  copy->integrator_ = integrator_;  // for the increment before the first
  copy->begin_window(integrator_->t_end_ns(), now.x, scale * scale * now.covariance);
  return copy;
}

void WindowNavigator::begin_interval() {
  open_ = ImuInterval{};
  if (integrator_) open_.before = integrator_->previous();
  const Node& node = nodes_.back();
  earth_ = preintegration::earth_model(context_.model, context_.frame, node.x.p_w_b);
  integrator_.emplace(noise_, node.x.bias, node.t_ns, open_.before,
                      scale_of(context_.layout, slow_));
}

void WindowNavigator::propagate(const ImuIncrement& increment) {
  rates_.add(increment);
  integrator_->add(increment);
  open_.increments.push_back(increment);
}

WindowNavigator::Prediction WindowNavigator::prediction() const {
  const state::NodeState& x0 = nodes_.back().x;
  if (at_node()) return {x0, covariance_};
  const StageTimer timer(Stage::covariance);
  const preintegration::Preintegration pre = measured(*integrator_, context_.model);
  const state::NodeState x1 = predict(x0, pre, earth_, context_.layout.imu_scale(slow_));
  return {x1, preintegration::predict_covariance(x0, x1, pre, earth_, covariance_, context_.layout,
                                                 slow_)};
}

state::Innovation WindowNavigator::innovation(const measurement::Observation& observation) const {
  const Prediction predicted = prediction();
  const LocalNode local = to_nav(predicted.x, slow_, context_);
  return state::innovation_of(
      observation.linearize(local.x, {rates_.gyro_b, rates_.accel_b}, context_.layout),
      turned(predicted.covariance, local.R_n_w));
}

state::Epoch WindowNavigator::epoch() const {
  const Prediction now = prediction();
  return to_epoch(integrator_->t_end_ns(), now.x, slow_, now.covariance, context_);
}

void WindowNavigator::update(const measurement::ObservationPtr& observation) {
  if (!at_node()) {
    const preintegration::Preintegration pre = measured(*integrator_, context_.model);
    add_node(predict(nodes_.back().x, pre, earth_, context_.layout.imu_scale(slow_)), pre);
  }
  Node& node = nodes_.back();
  node.observations.emplace_back(NodeObservation{observation, {rates_.gyro_b, rates_.accel_b}},
                                 node.x, slow_, context_);
  solve();
  marginalize_old();
  begin_interval();  // at the bias just estimated
}

/// A node without an observation brings no information: there is nothing to solve.
void WindowNavigator::hold() {
  if (at_node()) return;
  const Prediction now = prediction();
  add_node(now.x, measured(*integrator_, context_.model));
  linearize(nodes_.size() - 1);
  covariance_ = now.covariance;
  marginalize_old();
  begin_interval();
}

void WindowNavigator::add_node(const state::NodeState& x,
                               const preintegration::Preintegration& pre) {
  open_.factor = std::make_unique<PreintegrationFactor>(pre, earth_, context_.layout);
  Node& node = nodes_.emplace_back();
  node.t_ns = pre.t_end_ns;
  node.x = x;
  static_cast<ImuInterval&>(intervals_.emplace_back()) = std::move(open_);
}

/// The newest node has changed; all before it are linearized. After the last round nothing is
/// integrated again: its elimination would be that of the factor before.
void WindowNavigator::solve() {
  std::optional<SolveTimer> effort;
  if (!is_trial_) effort.emplace(nodes_.back().t_ns, nodes_.size());
  std::size_t from = nodes_.size() - 1;
  for (int round = 1; from < nodes_.size(); ++round) {
    const int64_t iterations = optimize(from);
    if (effort) effort->iterated(iterations);
    linearize(from);
    carry_back(from);
    if (round == kRounds) break;
    from = first_unsettled();
  }
  const StageTimer timer(Stage::covariance);
  covariance_ = covariance(nodes_.back().past.information);
}

/// Solves for the nodes from `from` on, for the settled one before them, and for the border; gives
/// the number of iterations.
int64_t WindowNavigator::optimize(std::size_t from) {
  const StageTimer timer(Stage::solve);
  const std::size_t base = from > 0 ? from - 1 : 0;
  const Linearization& past = nodes_[base].past;
  PriorFactor prior(from > 0 ? to_prior(past.information, past.at, past.slow) : prior_);
  ChainProblem problem(nodes_[base].x, slow_, prior, loss_.get());
  for (std::size_t k = base; k < nodes_.size(); ++k) {
    if (k > base) problem.add_node(nodes_[k].x, *intervals_[k - 1].factor);
    if (k < from) continue;  // its observations are in the prior
    for (ObservationFactor& observation : nodes_[k].observations) problem.add(observation);
  }
  const int64_t iterations = problem.optimize(options_);
  for (std::size_t k = base; k < nodes_.size(); ++k) nodes_[k].x = problem.state(k - base);
  slow_ = problem.slow();
  return iterations;
}

/// The quadratic forms of the nodes from `from` on, each at its present state.
void WindowNavigator::linearize(std::size_t from) {
  const StageTimer timer(Stage::marginalize);
  for (std::size_t k = from; k < nodes_.size(); ++k) {
    Node& node = nodes_[k];
    node.past = {node.x, slow_, NodeInformation(slow_.size())};
    if (k == 0) {
      node.past.information.add(PriorFactor(prior_).linearize(node.x, slow_));
    } else {
      const Linearization& before = nodes_[k - 1].past;
      Interval& interval = intervals_[k - 1];
      NodeInformation known = before.information;
      known.move_border(slow_ - before.slow);
      interval.elimination = eliminate(known, interval.factor->linearize(before.at, node.x, slow_));
      node.past.information = interval.elimination.rest;
    }
    add_observations(node);
  }
}

void WindowNavigator::add_observations(Node& node) const {
  for (const ObservationFactor& observation : node.observations) {
    const ObservationRows z = observation.linearize(node.x, slow_);
    node.past.information.add(z, robust_cost(loss_.get(), z).weight);
  }
}

/// The states before `from` that go with those behind.
void WindowNavigator::carry_back(std::size_t from) {
  const StageTimer timer(Stage::solve);
  if (from < 2) return;
  state::StateVector d(state::state_size(slow_.size()));
  state::node_part(d) = state::boxminus(nodes_[from - 1].x, nodes_[from - 1].past.at);
  for (std::size_t k = from - 1; k-- > 0;) {
    d.tail(slow_.size()) = slow_ - nodes_[k + 1].past.slow;
    state::node_part(d) = intervals_[k].elimination.eliminated(d);
    nodes_[k].x = state::boxplus(nodes_[k].past.at, state::NodeVector(state::node_part(d)));
  }
}

/// The first node whose quadratic form does not hold any more; the number of nodes if all do.
/// Intervals whose bias or scale has moved are integrated again.
std::size_t WindowNavigator::first_unsettled() {
  const StageTimer timer(Stage::solve);
  std::size_t first = nodes_.size();
  for (std::size_t k = nodes_.size(); k-- > 0;) {
    const Node& node = nodes_[k];
    if (k < intervals_.size() && has_turned(intervals_[k], node.x.bias, slow_)) {
      const StageTimer again(Stage::preintegrate);
      reintegrate(intervals_[k], node.x.bias, slow_, noise_, context_);
      first = k + 1;
    }
    if (has_moved(node)) first = k;
  }
  return first;
}

bool WindowNavigator::has_moved(const Node& node) const {
  if (node.x.q_w_b.angularDistance(node.past.at.q_w_b) > kSettled) return true;
  if (!loss_ && slow_.size() == 0) return false;
  return std::any_of(node.observations.begin(), node.observations.end(),
                     [&](const ObservationFactor& z) { return has_bent(z, node); });
}

/// Whether a residual is not what the quadratic form counts on: with a robust loss, whose weight is
/// that of the residual, as it was; else, as its Jacobian says.
bool WindowNavigator::has_bent(const ObservationFactor& observation, const Node& node) const {
  const ObservationRows before = observation.linearize(node.past.at, node.past.slow);
  const ObservationRows now = observation.linearize(node.x, slow_);
  if (loss_) return (now.r - before.r).norm() > kSettledResidual;
  state::StateVector d(state::state_size(slow_.size()));
  d << state::boxminus(node.x, node.past.at), slow_ - node.past.slow;
  return (now.r - before.r - before.J * d).norm() > kSettledResidual;
}

void WindowNavigator::marginalize_old() {
  const StageTimer timer(Stage::marginalize);
  while (nodes_.size() > 1 &&
         seconds_between(nodes_.front().t_ns, nodes_.back().t_ns) > options_.window_s) {
    prior_ = to_prior(intervals_.front().elimination.rest, nodes_[1].past.at, nodes_[1].past.slow);
    nodes_.pop_front();
    intervals_.pop_front();
  }
}

}  // namespace foucault::fgo
