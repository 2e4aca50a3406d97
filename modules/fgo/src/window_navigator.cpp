#include "foucault/fgo/window_navigator.h"

#include <algorithm>

#include "chain_problem.h"
#include "foucault/core/profile.h"
#include "foucault/core/time.h"
#include "foucault/measurement/gnss_position.h"
#include "graph_noise.h"
#include "node_epoch.h"

namespace foucault {
namespace {

/// What a turn d leaves out of the quadratic form is of second order: with 2e-4 rad, 2e-8 of a
/// velocity increment and 0.02 % of a sigma.
constexpr double kSettled = 2e-4;  // [rad]

/// A robust loss weighs a fix by its residual: its node is settled while that is. [sigma]
constexpr double kSettledResidual = 0.05;

/// Each round solves a longer part of the window; the whole of it within a few.
constexpr int kRounds = 8;

}  // namespace

WindowNavigator::WindowNavigator(const FgoOptions& options, PreintegrationModel model,
                                 const ImuNoise& noise)
    : options_(options), model_(model), noise_(noise), loss_(make_loss(options)) {
  require_noise(noise);
}

WindowNavigator::~WindowNavigator() = default;

void WindowNavigator::start(const Epoch& initial) {
  integrator_.reset();
  frame_.emplace(initial.position);
  begin_window(initial.t_ns, to_node(initial, *frame_, model_),
               turned(initial.covariance, frame_->R_w_n(initial.position)));
}

/// A window of one node.
void WindowNavigator::begin_window(int64_t t_ns, const NodeState& x, const Matrix15d& covariance) {
  nodes_.clear();
  intervals_.clear();
  Node& node = nodes_.emplace_back();
  node.t_ns = t_ns;
  node.x = x;
  covariance_ = covariance;
  prior_ = prior_from_covariance(node.x, covariance_);
  linearize(0);
  begin_interval();
}

void WindowNavigator::loosen(const Matrix15d& added) {
  const Prediction now = prediction();
  const Eigen::Matrix3d R_w_n = frame_->R_w_n(frame_->to_geodetic(now.x.p_w_b));
  begin_window(integrator_->t_end_ns(), now.x, now.covariance + turned(added, R_w_n));
}

std::unique_ptr<Navigator> WindowNavigator::ahead(double scale) const {
  const Prediction now = prediction();
  auto copy = std::make_unique<WindowNavigator>(options_, model_, noise_);
  copy->frame_ = frame_;
  copy->integrator_ = integrator_;  // for the increment before the first
  copy->begin_window(integrator_->t_end_ns(), now.x, scale * scale * now.covariance);
  return copy;
}

void WindowNavigator::begin_interval() {
  open_ = ImuInterval{};
  if (integrator_) open_.before = integrator_->previous();
  const Node& node = nodes_.back();
  earth_ = earth_model(model_, *frame_, node.x.p_w_b);
  integrator_.emplace(noise_, node.x.bias, node.t_ns, open_.before);
}

void WindowNavigator::propagate(const ImuIncrement& increment) {
  integrator_->add(increment);
  open_.increments.push_back(increment);
}

WindowNavigator::Prediction WindowNavigator::prediction() const {
  const NodeState& x0 = nodes_.back().x;
  if (at_node()) return {x0, covariance_};
  const StageTimer timer(Stage::covariance);
  const Preintegration pre = measured(*integrator_, model_);
  const NodeState x1 = predict(x0, pre, earth_);
  return {x1, predict_covariance(x0, x1, pre, earth_, covariance_)};
}

Innovation WindowNavigator::innovation(const Observation& observation) const {
  const GnssFix fix = dynamic_cast<const GnssPosition&>(observation).fix();
  const Prediction predicted = prediction();
  const LocalFix local = to_local(fix, *frame_);
  const Eigen::Matrix<double, 3, 15> H = antenna_jacobian(predicted.x, local);
  const Eigen::Matrix3d R_n_w = frame_->R_w_n(fix.antenna).transpose();
  const Eigen::Matrix3d S = H * predicted.covariance * H.transpose() + local.covariance_w;
  return {R_n_w * antenna_innovation(predicted.x, local), R_n_w * S * R_n_w.transpose()};
}

Epoch WindowNavigator::epoch() const {
  const Prediction now = prediction();
  return to_epoch(integrator_->t_end_ns(), now.x, now.covariance, *frame_, model_);
}

void WindowNavigator::update(const ObservationPtr& observation) {
  const GnssFix fix = dynamic_cast<const GnssPosition&>(*observation).fix();
  if (!at_node()) {
    const Preintegration pre = measured(*integrator_, model_);
    add_node(predict(nodes_.back().x, pre, earth_), pre);
  }
  nodes_.back().fixes.emplace_back(to_local(fix, *frame_));
  solve();
  marginalize_old();
  begin_interval();  // at the bias just estimated
}

/// A node without a fix brings no information: there is nothing to solve.
void WindowNavigator::hold() {
  if (at_node()) return;
  const Prediction now = prediction();
  add_node(now.x, measured(*integrator_, model_));
  linearize(nodes_.size() - 1);
  covariance_ = now.covariance;
  marginalize_old();
  begin_interval();
}

void WindowNavigator::add_node(const NodeState& x, const Preintegration& pre) {
  open_.factor = std::make_unique<PreintegrationFactor>(pre, earth_);
  Node& node = nodes_.emplace_back();
  node.t_ns = pre.t_end_ns;
  node.x = x;
  static_cast<ImuInterval&>(intervals_.emplace_back()) = std::move(open_);
}

/// The newest node has changed; all before it are linearized.
void WindowNavigator::solve() {
  std::size_t from = nodes_.size() - 1;
  for (int round = 0; round < kRounds && from < nodes_.size(); ++round) {
    optimize(from);
    linearize(from);
    carry_back(from);
    from = first_unsettled();
  }
  const StageTimer timer(Stage::covariance);
  covariance_ = covariance(nodes_.back().past.information);
}

/// Solves for the nodes from `from` on, and for the settled one before them.
void WindowNavigator::optimize(std::size_t from) {
  const StageTimer timer(Stage::solve);
  const std::size_t base = from > 0 ? from - 1 : 0;
  PriorFactor prior(from > 0 ? to_prior(nodes_[base].past.information, nodes_[base].past.at)
                             : prior_);
  ChainProblem problem(nodes_[base].x, prior, loss_.get());
  for (std::size_t k = base; k < nodes_.size(); ++k) {
    if (k > base) problem.add_node(nodes_[k].x, *intervals_[k - 1].factor);
    if (k < from) continue;  // its fixes are in the prior
    for (GnssFactor& fix : nodes_[k].fixes) problem.add_fix(fix);
  }
  problem.optimize(options_);
  for (std::size_t k = base; k < nodes_.size(); ++k) nodes_[k].x = problem.state(k - base);
}

/// The quadratic forms of the nodes from `from` on, each at its present state.
void WindowNavigator::linearize(std::size_t from) {
  const StageTimer timer(Stage::marginalize);
  for (std::size_t k = from; k < nodes_.size(); ++k) {
    Node& node = nodes_[k];
    node.past = {node.x, {}};
    if (k == 0) {
      node.past.information.add(PriorFactor(prior_).linearize(node.x));
    } else {
      const Linearization& before = nodes_[k - 1].past;
      Interval& interval = intervals_[k - 1];
      interval.elimination =
          eliminate(before.information, interval.factor->linearize(before.at, node.x));
      node.past.information = interval.elimination.rest;
    }
    add_fixes(node);
  }
}

void WindowNavigator::add_fixes(Node& node) const {
  for (const GnssFactor& factor : node.fixes) {
    const GnssFactor::Linearized fix = factor.linearize(node.x);
    node.past.information.add(fix, loss_weight(loss_.get(), fix));
  }
}

/// The states before `from` that go with those behind.
void WindowNavigator::carry_back(std::size_t from) {
  const StageTimer timer(Stage::solve);
  if (from < 2) return;
  const Node& base = nodes_[from - 1];
  Vector15d d = boxminus(base.x, base.past.at);
  for (std::size_t k = from - 1; k-- > 0;) {
    d = intervals_[k].elimination.eliminated(d);
    nodes_[k].x = boxplus(nodes_[k].past.at, d);
  }
}

/// The first node whose quadratic form does not hold any more; the number of nodes if all do.
/// Intervals whose bias has moved are integrated again.
std::size_t WindowNavigator::first_unsettled() {
  const StageTimer timer(Stage::solve);
  std::size_t first = nodes_.size();
  for (std::size_t k = nodes_.size(); k-- > 0;) {
    const Node& node = nodes_[k];
    if (k < intervals_.size() && bias_moved(intervals_[k].factor->preintegration(), node.x.bias)) {
      const StageTimer again(Stage::preintegrate);
      reintegrate(intervals_[k], node.x.bias, noise_, model_);
      first = k + 1;
    }
    if (has_moved(node)) first = k;
  }
  return first;
}

bool WindowNavigator::has_moved(const Node& node) const {
  if (node.x.q_w_b.angularDistance(node.past.at.q_w_b) > kSettled) return true;
  if (!loss_) return false;
  return std::any_of(node.fixes.begin(), node.fixes.end(), [&](const GnssFactor& fix) {
    const Eigen::Vector3d change = fix.linearize(node.x).r - fix.linearize(node.past.at).r;
    return change.norm() > kSettledResidual;
  });
}

void WindowNavigator::marginalize_old() {
  const StageTimer timer(Stage::marginalize);
  while (nodes_.size() > 1 &&
         seconds_between(nodes_.front().t_ns, nodes_.back().t_ns) > options_.window_s) {
    prior_ = to_prior(intervals_.front().elimination.rest, nodes_[1].past.at);
    nodes_.pop_front();
    intervals_.pop_front();
  }
}

}  // namespace foucault
