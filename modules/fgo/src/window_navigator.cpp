#include "foucault/fgo/window_navigator.h"

#include <stdexcept>

#include "foucault/core/time.h"
#include "node_epoch.h"
#include "solving.h"

namespace foucault {

WindowNavigator::WindowNavigator(const FgoOptions& options, PreintegrationModel model,
                                 const ImuNoise& noise)
    : options_(options), model_(model), noise_(noise), loss_(make_loss(options)) {}

WindowNavigator::~WindowNavigator() = default;

void WindowNavigator::start(const Epoch& initial) {
  problem_ = std::make_unique<ceres::Problem>(problem_options());
  nodes_.clear();
  intervals_.clear();
  integrator_.reset();
  frame_.emplace(initial.position);

  const NodeState x = to_node(initial, *frame_, model_);
  Node& node = nodes_.emplace_back();
  node.t_ns = initial.t_ns;
  write_block(x, node.x.data());
  problem_->AddParameterBlock(node.x.data(), kStateBlockSize, &manifold_);
  covariance_ = turned(initial.covariance, frame_->R_w_n(initial.position));
  prior_block_ = nullptr;
  set_prior(prior_from_covariance(x, covariance_));
  begin_interval();
}

void WindowNavigator::begin_interval() {
  open_ = Interval{};
  if (integrator_) open_.before = integrator_->previous();
  const NodeState x = last_state();
  earth_ = earth_model(model_, *frame_, x.p_w_b);
  integrator_.emplace(noise_, x.bias, nodes_.back().t_ns, open_.before);
}

void WindowNavigator::propagate(const ImuIncrement& increment) {
  integrator_->add(increment);
  open_.increments.push_back(increment);
}

WindowNavigator::Prediction WindowNavigator::prediction() const {
  const NodeState x0 = last_state();
  if (at_node()) return {x0, covariance_};
  const Preintegration pre = measured(*integrator_, model_);
  const NodeState x1 = predict(x0, pre, earth_);
  return {x1, predict_covariance(x0, x1, pre, earth_, covariance_)};
}

Innovation WindowNavigator::innovation(const GnssFix& fix) const {
  const Prediction predicted = prediction();
  const LocalFix local = to_local(fix, *frame_);
  const Eigen::Matrix<double, 3, 15> H = antenna_jacobian(predicted.x, local);
  const Eigen::Matrix3d R_n_w = frame_->R_w_n(fix.antenna).transpose();
  const Eigen::Matrix3d S = H * predicted.covariance * H.transpose() + local.covariance_w;
  return {R_n_w * antenna_innovation(predicted.x, local), R_n_w * S * R_n_w.transpose()};
}

void WindowNavigator::update(const GnssFix& fix) {
  if (!at_node()) add_node();
  Node& node = nodes_.back();
  node.forward.reset();
  node.fixes.push_back(std::make_unique<GnssFactor>(to_local(fix, *frame_)));
  problem_->AddResidualBlock(node.fixes.back().get(), loss_.get(), node.x.data());
  solve();
}

void WindowNavigator::hold() {
  if (at_node()) return;
  covariance_ = prediction().covariance;
  add_node();
  marginalize_old();
}

Epoch WindowNavigator::epoch() const {
  const Prediction now = prediction();
  return to_epoch(integrator_->t_end_ns(), now.x, now.covariance, *frame_, model_);
}

void WindowNavigator::add_node() {
  const Preintegration pre = measured(*integrator_, model_);
  const NodeState x = predict(last_state(), pre, earth_);
  open_.factor = std::make_unique<PreintegrationFactor>(pre, earth_);
  double* const previous = nodes_.back().x.data();

  Node& node = nodes_.emplace_back();
  node.t_ns = pre.t_end_ns;
  write_block(x, node.x.data());
  problem_->AddParameterBlock(node.x.data(), kStateBlockSize, &manifold_);
  open_.block = problem_->AddResidualBlock(open_.factor.get(), nullptr, previous, node.x.data());
  intervals_.push_back(std::move(open_));
  begin_interval();
}

void WindowNavigator::solve() {
  optimize(*problem_, options_);
  if (reintegrate_moved_biases()) optimize(*problem_, options_);
  update_covariance();
  marginalize_old();
  begin_interval();  // at the bias just estimated
}

bool WindowNavigator::reintegrate_moved_biases() {
  bool moved = false;
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    Interval& interval = intervals_[i];
    const ImuBias bias = read_block(nodes_[i].x.data()).bias;
    if (!bias_moved(interval.factor->preintegration(), bias)) continue;
    problem_->RemoveResidualBlock(interval.block);
    reintegrate(interval, bias, noise_, model_);
    interval.block = problem_->AddResidualBlock(interval.factor.get(), nullptr, nodes_[i].x.data(),
                                                nodes_[i + 1].x.data());
    nodes_[i + 1].forward.reset();
    moved = true;
  }
  return moved;
}

void WindowNavigator::marginalize_old() {
  const auto length_s = [this] { return seconds_between(nodes_.front().t_ns, nodes_.back().t_ns); };
  while (nodes_.size() > 1 && length_s() > options_.window_s) marginalize_first();
}

void WindowNavigator::marginalize_first() {
  const NodeState x0 = read_block(nodes_[0].x.data());
  const NodeState x1 = read_block(nodes_[1].x.data());
  NodeInformation first = information(nodes_[0]);
  first.add(prior_->linearize(x0));
  const NodeInformation rest = eliminate(first, intervals_.front().factor->linearize(x0, x1));
  problem_->RemoveParameterBlock(nodes_.front().x.data());
  prior_block_ = nullptr;  // went with its parameter block
  intervals_.pop_front();
  nodes_.pop_front();
  set_prior(to_prior(rest, x1));
}

void WindowNavigator::set_prior(const SquareRootPrior& prior) {
  if (prior_block_ != nullptr) problem_->RemoveResidualBlock(prior_block_);
  prior_ = std::make_unique<PriorFactor>(prior);
  prior_block_ = problem_->AddResidualBlock(prior_.get(), nullptr, nodes_.front().x.data());
}

NodeInformation WindowNavigator::information(const Node& node) const {
  NodeInformation out;
  const NodeState x = read_block(node.x.data());
  for (const std::unique_ptr<GnssFactor>& factor : node.fixes) {
    const GnssFactor::Linearized fix = factor->linearize(x);
    out.add(fix, loss_weight(loss_.get(), fix));
  }
  return out;
}

/// Information on each node from all before it, kept from epoch to epoch. It depends on the
/// estimates by their attitudes alone, and to first order; a node that has not turned by kSettled
/// keeps what it has, so that an epoch costs little more than its own node.
void WindowNavigator::update_covariance() {
  constexpr double kSettled = 2e-4;  // [rad]: 0.02 % of a sigma
  bool moved = false;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    const NodeState x = read_block(node.x.data());
    moved = moved || !node.forward || x.q_w_b.angularDistance(node.forward->attitude) > kSettled;
    if (!moved) continue;
    NodeInformation info = information(node);
    if (i == 0) {
      info.add(prior_->linearize(x));
    } else {
      const NodeState before = read_block(nodes_[i - 1].x.data());
      const NodeInformation carried = eliminate(nodes_[i - 1].forward->information,
                                                intervals_[i - 1].factor->linearize(before, x));
      info.H += carried.H;
    }
    node.forward = Node::Forward{info, x.q_w_b};
  }
  covariance_ = covariance(nodes_.back().forward->information);
}

}  // namespace foucault
