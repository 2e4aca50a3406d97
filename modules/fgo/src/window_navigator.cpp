#include "foucault/fgo/window_navigator.h"

#include <ceres/solver.h>

#include <cmath>
#include <stdexcept>

#include "foucault/core/time.h"

namespace foucault {
namespace {

/// A change of the gyro bias turns an interval by |dbg| T. Beyond this angle the second order of
/// (46), g (|dbg| T)^2 T / 6, nears 1e-6 m/s, and the interval is integrated anew.
constexpr double kReintegrationAngle = 1e-3;  // [rad]

std::unique_ptr<ceres::LossFunction> make_loss(const FgoOptions& options) {
  if (options.robust == "huber") return std::make_unique<ceres::HuberLoss>(options.robust_scale);
  if (options.robust == "cauchy") return std::make_unique<ceres::CauchyLoss>(options.robust_scale);
  return nullptr;
}

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.enable_fast_removal = true;
  return options;
}

ceres::Solver::Options solver_options(const FgoOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  solver.initial_trust_region_radius = 1e16;  // the start is good: plain Gauss-Newton steps
  solver.max_trust_region_radius = 1e32;
  solver.max_num_iterations = static_cast<int>(options.max_iterations);
  solver.function_tolerance = 1e-7;
  solver.gradient_tolerance = 0;
  solver.parameter_tolerance = 0;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  return solver;
}

/// Stops when the step that was taken is known to be the last one that matters. If the quadratic
/// model missed the change of cost by a share e, the gradient left is of order e and the cost left
/// e^2 of the change; at 1e-6, a step of another thousandth of a sigma. Without this every solve
/// ends with an iteration that only confirms.
class StopWhenModelHolds final : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    constexpr double kCostLeft = 1e-6;
    const double missed = 1 - iteration.relative_decrease;
    const bool done = iteration.iteration > 0 && iteration.step_is_successful &&
                      missed * missed * std::abs(iteration.cost_change) < kCostLeft;
    return done ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
};

/// Turns the position and velocity rows of a covariance from one local frame to another.
Matrix15d turned(const Matrix15d& P, const Eigen::Matrix3d& R) {
  Matrix15d T = Matrix15d::Identity();
  T.block<3, 3>(error_state::kPosition, error_state::kPosition) = R;
  T.block<3, 3>(error_state::kVelocity, error_state::kVelocity) = R;
  return T * P * T.transpose();
}

NodeState to_node(const Epoch& epoch, const LocalFrame& frame) {
  const Eigen::Matrix3d R_w_n = frame.R_w_n(epoch.position);
  NodeState x;
  x.p_w_b = frame.to_local(epoch.position);
  x.v_w_b = R_w_n * epoch.velocity_n;
  x.q_w_b = Eigen::Quaterniond(R_w_n) * epoch.q_n_b;
  x.bias = epoch.bias;
  return x;
}

/// The part of a rotation that turns about the vertical.
Eigen::Quaterniond heading_part(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return Eigen::Quaterniond(q.w(), 0, 0, q.z()).normalized();
}

/// A model whose gravity is constant in w levels its attitude by the accelerometers, which feel the
/// gravity of the place: what it calls the vertical of w is the local vertical. Its attitude is
/// turned by the convergence of the meridians alone, or the curvature would count twice.
Epoch to_epoch(int64_t t_ns, const NodeState& x, const Matrix15d& covariance_w,
               const LocalFrame& frame, bool constant_gravity) {
  Epoch epoch;
  epoch.t_ns = t_ns;
  epoch.position = frame.to_geodetic(x.p_w_b);
  const Eigen::Matrix3d R_n_w = frame.R_w_n(epoch.position).transpose();
  epoch.velocity_n = R_n_w * x.v_w_b;
  const Eigen::Quaterniond q_n_w =
      constant_gravity ? heading_part(R_n_w) : Eigen::Quaterniond(R_n_w);
  epoch.q_n_b = (q_n_w * x.q_w_b).normalized();
  epoch.bias = x.bias;
  epoch.covariance = turned(covariance_w, R_n_w);
  return epoch;
}

}  // namespace

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

  const NodeState x = to_node(initial, *frame_);
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

Preintegration WindowNavigator::measured(const Preintegrator& integrator) const {
  return model_ == PreintegrationModel::full ? integrator.result_with_bias_decay()
                                             : integrator.result();
}

void WindowNavigator::propagate(const ImuIncrement& increment) {
  integrator_->add(increment);
  open_.increments.push_back(increment);
}

WindowNavigator::Prediction WindowNavigator::prediction() const {
  const NodeState x0 = last_state();
  if (at_node()) return {x0, covariance_};
  const Preintegration pre = measured(*integrator_);
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
  return to_epoch(integrator_->t_end_ns(), now.x, now.covariance, *frame_,
                  model_ != PreintegrationModel::full);
}

void WindowNavigator::add_node() {
  const Preintegration pre = measured(*integrator_);
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
  optimize();
  if (reintegrate_moved_biases()) optimize();
  update_covariance();
  marginalize_old();
  begin_interval();  // at the bias just estimated
}

void WindowNavigator::optimize() {
  StopWhenModelHolds stop;
  ceres::Solver::Options solver = solver_options(options_);
  solver.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, problem_.get(), &summary);
  if (!summary.IsSolutionUsable())
    throw std::runtime_error("the factor graph could not be solved: " + summary.message);
}

bool WindowNavigator::reintegrate_moved_biases() {
  bool moved = false;
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    Interval& interval = intervals_[i];
    const Preintegration& pre = interval.factor->preintegration();
    const ImuBias bias = read_block(nodes_[i].x.data()).bias;
    if ((bias.gyro - pre.bias.gyro).norm() * pre.dt < kReintegrationAngle) continue;
    const EarthModel earth = interval.factor->earth();
    Preintegrator integrator(noise_, bias, pre.t_begin_ns, interval.before);
    for (const ImuIncrement& increment : interval.increments) integrator.add(increment);
    problem_->RemoveResidualBlock(interval.block);
    interval.factor = std::make_unique<PreintegrationFactor>(measured(integrator), earth);
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
    out.add(fix, loss_weight(fix));
  }
  return out;
}

/// rho'(s): a robust loss as a weight on the squared residual at the solution.
double WindowNavigator::loss_weight(const GnssFactor::Linearized& fix) const {
  if (!loss_) return 1;
  double rho[3];
  loss_->Evaluate(fix.r.squaredNorm(), rho);
  return rho[1];
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
