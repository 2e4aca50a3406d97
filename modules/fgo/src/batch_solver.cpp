#include "foucault/fgo/batch_solver.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "foucault/core/profile.h"
#include "foucault/fgo/chain.h"
#include "robust_loss.h"

namespace foucault::fgo {
namespace {

/// The second order of gravity is 3 g (d / R)^2 or less: 7e-7 m/s^2.
constexpr double kGravityIsLinear = 1000;  // [m]

/// Forward runs that were off by tens of kilometres need two.
constexpr int kRounds = 5;

/// Nodes between two whose elimination is kept.
constexpr std::size_t kSegment = 64;

/// A step is taken if it lowers the cost by this share of what the quadratic model says.
constexpr double kLeastShare = 1e-3;
/// Share of the cost that is not worth another step.
constexpr double kCostShareLeft = 1e-7;
/// A thousandth of a sigma.
constexpr double kCostLeft = 1e-6;

/// Levenberg and Marquardt's radius, as Ceres has it: what is known of a column by itself, over it,
/// is added to what is known of all.
struct TrustRegion {
  double radius = kDampedRadius;
  double shrink = 2;

  void adapt(bool better, double share) {
    if (better) {
      radius /= std::max(1.0 / 3, 1 - std::pow(2 * share - 1, 3));
      shrink = 2;
    } else {
      radius /= shrink;
      shrink *= 2;
    }
  }
};

/// The chain at its states, and the search for better ones.
class BatchSolver {
 public:
  BatchSolver(BatchChain& chain, const GraphContext& context, const FgoOptions& options)
      : chain_(chain),
        context_(context),
        options_(options),
        loss_(make_loss(options)),
        prior_(chain.prior),
        at_{{}, chain.prior.slow_at} {
    for (const BatchNode& node : chain.nodes) at_.x.push_back(node.x);
  }

  void optimize();

  /// New factors where biases or places have left those of the first estimate. True if there were
  /// any.
  bool renew_factors(const imu::ImuNoise& noise);

  BatchSolution solution();
  BatchPart part(const NodeEstimate* behind);

 private:
  struct States {
    std::vector<state::NodeState> x;
    state::SlowVector slow;
  };
  /// What is known of the newest node when all before it are eliminated.
  struct Front {
    NodeInformation information;
    state::StateVector squares;  ///< of the columns' norms
  };
  /// An eliminated node.
  struct Pivot : Conditional {
    state::NodeVector damping;
  };

  bool plain_steps(SolveTimer& effort);
  void damped_steps(SolveTimer& effort);
  bool take_if_better(double predicted, double& share);
  double step();
  double cost(const States& at) const;

  Front first_front() const;
  Pivot advance(std::size_t k, Front& front) const;
  void add_own(std::size_t k, Front& front) const;
  void add(const ObservationRows& z, Front& front) const;
  state::NodeVector damp_node(Front& front) const;
  state::StateVector damp_all(Front& front) const;
  void damp(const state::StateVector& diagonal, Front& front) const;
  Front sweep();
  template <class Each>
  void go_back(const Each& each);

  void take_off(std::size_t nodes);

  bool reintegrate_turned(std::size_t k, const imu::ImuNoise& noise);
  bool move_earth(std::size_t k);

  BatchChain& chain_;
  const GraphContext& context_;
  const FgoOptions& options_;
  std::unique_ptr<ceres::LossFunction> loss_;
  PriorFactor prior_;
  std::optional<TrustRegion> region_;  ///< none: plain steps
  States at_, next_;
  double cost_ = 0;
  std::vector<Front> kept_;    ///< of every kSegment-th node
  std::vector<Pivot> pivots_;  ///< of a segment
};

// The elimination --------------------------------------------------------------------------------

BatchSolver::Front BatchSolver::first_front() const {
  const Eigen::Index slow = at_.slow.size();
  Front front{NodeInformation(slow), state::StateVector::Zero(state::state_size(slow))};
  const StateRows prior = prior_.linearize(at_.x[0], at_.slow);
  front.information.add(prior);
  front.squares += prior.J.colwise().squaredNorm().transpose();
  add_own(0, front);
  return front;
}

void BatchSolver::add_own(std::size_t k, Front& front) const {
  for (const NodeObservation& observation : chain_.nodes[k].observations)
    add(linearize(observation, at_.x[k], at_.slow, context_), front);
}

void BatchSolver::add(const ObservationRows& z, Front& front) const {
  const double weight = robust_cost(loss_.get(), z).weight;
  front.information.add(z, weight);
  front.squares += weight * z.J.colwise().squaredNorm().transpose();
}

/// Eliminates node k; what is known of it becomes what is known of the next.
BatchSolver::Pivot BatchSolver::advance(std::size_t k, Front& front) const {
  const IntervalRows interval =
      chain_.intervals[k].factor->linearize(at_.x[k], at_.x[k + 1], at_.slow);
  const Eigen::Index slow = at_.slow.size();
  state::node_part(front.squares) += interval.J_x0.colwise().squaredNorm().transpose();
  front.squares.tail(slow) += interval.J_slow.colwise().squaredNorm().transpose();
  const state::NodeVector damping = damp_node(front);
  const Elimination elimination = eliminate(front.information, interval);
  front.information = elimination.rest;
  state::node_part(front.squares) = interval.J_x1.colwise().squaredNorm().transpose();
  add_own(k + 1, front);
  return {elimination, damping};
}

state::NodeVector BatchSolver::damp_node(Front& front) const {
  state::StateVector diagonal = state::StateVector::Zero(front.squares.size());
  if (!region_) return state::node_part(diagonal);
  state::node_part(diagonal) = (state::node_part(front.squares) / region_->radius).cwiseSqrt();
  damp(diagonal, front);
  return state::node_part(diagonal);
}

state::StateVector BatchSolver::damp_all(Front& front) const {
  if (!region_) return state::StateVector::Zero(front.squares.size());
  const state::StateVector diagonal = (front.squares / region_->radius).cwiseSqrt();
  damp(diagonal, front);
  return diagonal;
}

void BatchSolver::damp(const state::StateVector& diagonal, Front& front) const {
  const Eigen::Index size = diagonal.size();
  StateRows rows{state::StateVector::Zero(size), state::StateMatrix::Zero(size, size)};
  rows.J.diagonal() = diagonal;
  front.information.add(rows);
}

/// Eliminates all nodes but the last.
BatchSolver::Front BatchSolver::sweep() {
  kept_.clear();
  Front front = first_front();
  for (std::size_t k = 0; k + 1 < at_.x.size(); ++k) {
    if (k % kSegment == 0) kept_.push_back(front);
    advance(k, front);
  }
  return front;
}

/// From the last node that was eliminated to the first, each(k, pivot).
template <class Each>
void BatchSolver::go_back(const Each& each) {
  std::size_t end = at_.x.size() - 1;
  for (std::size_t segment = kept_.size(); segment-- > 0;) {
    const std::size_t begin = segment * kSegment;
    pivots_.clear();
    for (std::size_t k = begin; k < end; ++k) pivots_.push_back(advance(k, kept_[segment]));
    for (std::size_t k = end; k-- > begin;) each(k, pivots_[k - begin]);
    end = begin;
  }
}

// The search -------------------------------------------------------------------------------------

double BatchSolver::cost(const States& at) const {
  double twice = prior_.linearize(at.x[0], at.slow).r.squaredNorm();
  for (std::size_t k = 0; k < at.x.size(); ++k) {
    for (const NodeObservation& z : chain_.nodes[k].observations)
      twice += robust_cost(loss_.get(), linearize(z, at.x[k], at.slow, context_)).cost;
    if (k + 1 < at.x.size())
      twice += chain_.intervals[k].factor->residual(at.x[k], at.x[k + 1], at.slow).squaredNorm();
  }
  return 0.5 * twice;
}

/// Goes to next_. By how much the cost falls if it is as quadratic as here.
double BatchSolver::step() {
  Front front = sweep();
  const state::StateVector damping = damp_all(front);
  state::StateVector d = front.information.solution();
  const Eigen::Index slow = at_.slow.size();
  double twice = front.information.r.squaredNorm() + damping.cwiseProduct(d).squaredNorm();
  next_.x.resize(at_.x.size());
  next_.x.back() = state::boxplus(at_.x.back(), state::NodeVector(state::node_part(d)));
  next_.slow = at_.slow + d.tail(slow);
  go_back([&](std::size_t k, const Pivot& pivot) {
    const state::NodeVector own = pivot.eliminated(d);
    next_.x[k] = state::boxplus(at_.x[k], own);
    twice += pivot.a.squaredNorm() + pivot.damping.cwiseProduct(own).squaredNorm();
    state::node_part(d) = own;
  });
  return 0.5 * twice;
}

void BatchSolver::optimize() {
  const StageTimer timer(Stage::solve);
  SolveTimer effort(chain_.nodes.back().t_ns, at_.x.size());
  cost_ = cost(at_);
  if (!std::isfinite(cost_))
    throw std::runtime_error("the factor graph could not be solved: its cost is not finite");
  region_.reset();
  if (plain_steps(effort)) return;
  region_.emplace();
  damped_steps(effort);
  region_.reset();
}

/// True when the step that was taken is known to be the last one that matters. If the quadratic
/// model missed the change of cost by a share e, the gradient left is of order e and the cost left
/// e^2 of the change. Not so if nearly all of the change was in directions that are linear, as when
/// the biases of a forward run jump from node to node by many sigmas of their drift: a change that
/// exceeds what is left says nothing of the others.
bool BatchSolver::plain_steps(SolveTimer& effort) {
  for (int64_t i = 0; i < options_.max_iterations; ++i) {
    effort.iterated();
    const double predicted = step();
    const double before = cost_;
    double share = 0;
    const bool better = take_if_better(predicted, share);
    const double change = share * predicted;
    if (predicted < kCostLeft || std::abs(change) <= kCostShareLeft * before) return true;
    if (!better) return false;
    if (change < cost_ && (1 - share) * (1 - share) * change < kCostLeft) return true;
  }
  return false;
}

/// Of a damped step the model holds, too.
void BatchSolver::damped_steps(SolveTimer& effort) {
  for (int64_t i = 0; i < kDampedIterations * options_.max_iterations; ++i) {
    effort.iterated();
    const double predicted = step();
    const double before = cost_;
    double share = 0;
    const bool better = take_if_better(predicted, share);
    if (std::abs(share * predicted) <= kCostShareLeft * before) return;
    region_->adapt(better, share);
  }
}

/// share: of the predicted change, what came.
bool BatchSolver::take_if_better(double predicted, double& share) {
  const double next_cost = cost(next_);
  share = (cost_ - next_cost) / predicted;
  if (!(share > kLeastShare)) return false;
  std::swap(at_, next_);
  cost_ = next_cost;
  return true;
}

// Factors and covariances ------------------------------------------------------------------------

bool BatchSolver::renew_factors(const imu::ImuNoise& noise) {
  bool renewed = false;
  for (std::size_t k = 0; k < chain_.intervals.size(); ++k) {
    const bool integrated = reintegrate_turned(k, noise);
    const bool placed =
        context_.model == preintegration::PreintegrationModel::full && move_earth(k);
    renewed = renewed || integrated || placed;
  }
  return renewed;
}

bool BatchSolver::reintegrate_turned(std::size_t k, const imu::ImuNoise& noise) {
  ImuInterval& interval = chain_.intervals[k];
  if (interval.increments.empty()) return false;
  if (!has_turned(interval, at_.x[k].bias, at_.slow)) return false;
  reintegrate(interval, at_.x[k].bias, at_.slow, noise, context_);
  return true;
}

/// Gravity is linear about the place where the forward run was.
bool BatchSolver::move_earth(std::size_t k) {
  PreintegrationFactor& factor = *chain_.intervals[k].factor;
  const Eigen::Vector3d& p_w = at_.x[k].p_w_b;
  if ((p_w - factor.earth().p_ref).norm() < kGravityIsLinear) return false;
  factor.set_earth(preintegration::earth_model(context_.model, context_.frame, p_w));
  return true;
}

BatchSolution BatchSolver::solution() {
  const StageTimer timer(Stage::covariance);
  next_ = {};
  std::vector<state::PackedSymmetric> covariances(at_.x.size());
  state::StateMatrix P = covariance(sweep().information);
  covariances.back() = state::PackedSymmetric(P);
  go_back([&](std::size_t k, const Pivot& pivot) {
    P = pivot.covariance(P);
    covariances[k] = state::PackedSymmetric(P);
    chain_.intervals.pop_back();  // its memory goes to what is still to come
  });
  return {std::move(at_.x), at_.slow, std::move(covariances)};
}

state::StateVector difference(const NodeEstimate& a, const NodeEstimate& b) {
  return joined(state::boxminus(a.x, b.x), a.slow - b.slow);
}

BatchPart BatchSolver::part(const NodeEstimate* behind) {
  const StageTimer timer(Stage::covariance);
  next_ = {};
  const std::size_t nodes = 3 * at_.x.size() / 4;
  BatchPart out;
  out.solution.slow = behind != nullptr ? behind->slow : at_.slow;
  out.solution.x.resize(nodes);
  out.solution.covariance_w.resize(nodes);
  PartLink& link = out.link;
  link.first = {at_.x.front(), at_.slow};
  link.behind = {at_.x[nodes], at_.slow};
  state::StateMatrix P = covariance(sweep().information);
  state::StateVector d = state::StateVector::Zero(P.rows());
  go_back([&](std::size_t k, const Pivot& pivot) {
    P = pivot.covariance(P);
    if (k > nodes) return;
    if (k == nodes) {
      link.dependence = on_itself(at_.slow.size());
      if (behind == nullptr) return;
      P = behind->covariance;
      d = difference(*behind, link.behind);
      return;
    }
    link.dependence = of_node_before(pivot, link.dependence);
    const state::NodeVector own = -pivot.R.triangularView<Eigen::Upper>().solve(pivot.A * d);
    state::node_part(d) = own;
    out.solution.x[k] = state::boxplus(at_.x[k], own);
    out.solution.covariance_w[k] = state::PackedSymmetric(P);
  });
  take_off(nodes);
  return out;
}

/// What they know, with the observations of the next, becomes its prior.
void BatchSolver::take_off(std::size_t nodes) {
  Front front = first_front();
  for (std::size_t k = 0; k < nodes; ++k) advance(k, front);
  chain_.prior = to_prior(front.information, at_.x[nodes], at_.slow);
  const auto gone = static_cast<std::ptrdiff_t>(nodes);
  chain_.nodes.erase(chain_.nodes.begin(), chain_.nodes.begin() + gone);
  chain_.intervals.erase(chain_.intervals.begin(), chain_.intervals.begin() + gone);
  chain_.nodes.front().observations.clear();
  for (std::size_t k = 0; k < chain_.nodes.size(); ++k) chain_.nodes[k].x = at_.x[nodes + k];
}

void minimize(BatchSolver& solver, const imu::ImuNoise& noise) {
  solver.optimize();
  for (int round = 0; round < kRounds && solver.renew_factors(noise); ++round) solver.optimize();
}

}  // namespace

NodeEstimate through(const PartLink& link, const NodeEstimate& behind) {
  const state::NodeVector moved = link.dependence.F * difference(behind, link.behind);
  return {state::boxplus(link.first.x, moved), behind.slow,
          covariance(link.dependence, behind.covariance)};
}

std::vector<NodeEstimate> nodes_behind(const std::vector<PartLink>& links) {
  std::vector<NodeEstimate> behind(links.size());
  NodeEstimate known;
  for (std::size_t i = links.size(); i-- > 0;) {
    behind[i] = known;
    known = links[i].ends_chain ? links[i].first : through(links[i], known);
  }
  return behind;
}

BatchSolution solve(BatchChain& chain, const GraphContext& context, const FgoOptions& options,
                    const imu::ImuNoise& noise) {
  BatchSolver solver(chain, context, options);
  minimize(solver, noise);
  return solver.solution();
}

BatchPart solve_part(BatchChain& chain, const GraphContext& context, const FgoOptions& options,
                     const imu::ImuNoise& noise, const NodeEstimate* behind) {
  BatchSolver solver(chain, context, options);
  minimize(solver, noise);
  return solver.part(behind);
}

}  // namespace foucault::fgo
