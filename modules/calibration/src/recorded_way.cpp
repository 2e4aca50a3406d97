#include "foucault/calibration/recorded_way.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <string_view>
#include <utility>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"

namespace foucault::calibration {
namespace {

constexpr double kLongest = 3600;  // [s]
constexpr std::size_t kMostNodes = 50000;
constexpr double kSettles = 60;  // [s]

NoiseOf noise_of(std::string_view name) {
  if (name == "gnss_position") return NoiseOf::position;
  if (name == "gnss_velocity") return NoiseOf::velocity;
  if (name == "heading") return NoiseOf::heading;
  if (name == "nonholonomic") return NoiseOf::slip;
  if (name == "wheel_speed") return NoiseOf::wheel;
  return NoiseOf::rest;
}

using state::block::attitude;
using state::block::position;
using state::block::velocity;

/// What a unit of white noise of the accelerometers drives into the motion in a step of half a
/// second: a random walk of the velocity and its integral.
state::MotionMatrix driven_by_accel(double dt) {
  state::MotionMatrix q = state::MotionMatrix::Zero();
  state::part(q, velocity, velocity).diagonal().setConstant(dt);
  state::part(q, position, velocity).diagonal().setConstant(dt * dt / 2);
  state::part(q, velocity, position).diagonal().setConstant(dt * dt / 2);
  state::part(q, position, position).diagonal().setConstant(dt * dt * dt / 3);
  return q;
}

/// Of the gyroscopes: a random walk of the attitude, in b at the end, which turns the specific
/// force; of the position, whose share is of the order of dt^2, nothing.
state::MotionMatrix driven_by_gyro(const ekf::MotionIntegrals& integrals,
                                   const Eigen::Matrix3d& C_n_b) {
  const double dt = integrals.dt;
  const Eigen::Matrix3d turned = -so3::skew(integrals.specific_velocity_n) * C_n_b;
  state::MotionMatrix q = state::MotionMatrix::Zero();
  state::part(q, attitude, attitude).diagonal().setConstant(dt);
  state::part(q, velocity, attitude) = dt / 2 * turned;
  state::part(q, attitude, velocity) = dt / 2 * turned.transpose();
  state::part(q, velocity, velocity) = dt / 3 * turned * turned.transpose();
  return q;
}

WayMeasurement folded(const UnfoldedNode::Measured& measured, const state::SlowVector& slow) {
  WayMeasurement out;
  out.kind = measured.kind;
  out.correction = measured.correction;
  out.rows = static_cast<int>(measured.z.r.size());
  out.told_sigma.head(out.rows) = measured.z.R.diagonal().cwiseSqrt();
  const Eigen::MatrixXd by_slow = measured.z.H.rightCols(slow.size());
  const Eigen::LLT<Eigen::MatrixXd> told(measured.z.R);
  out.r.head(out.rows) =
      told.matrixL().solve(Eigen::VectorXd(measured.z.r - by_slow * (slow - measured.slow)));
  out.H.topRows(out.rows) =
      told.matrixL().solve(Eigen::MatrixXd(state::node_columns(measured.z.H)));
  if (measured.kind == NoiseOf::position)
    out.by_sigmas =
        told.matrixL().solve(Eigen::MatrixXd(measured.z.R.diagonal().cwiseSqrt().asDiagonal()));
  return out;
}

}  // namespace

WayRecorder::WayRecorder(const imu::ImuNoise& imu, const state::Layout& layout,
                         const ekf::EkfOptions& options, UnfoldedWay& way)
    : EkfNavigator(imu, layout, options), way_(way) {}

void WayRecorder::start(const state::Epoch& initial) {
  EkfNavigator::start(initial);
  if (!first_ns_) first_ns_ = initial.t_ns;
  begins_ = true;
  begin_node();
}

void WayRecorder::begin_node() {
  const Eigen::Index size = state::state_size(state().slow.size());
  node_ns_ = state().t_ns;
  next_ = {};
  next_.slow = state().slow;
  phi_ = ekf::Phi::identity(size);
}

bool WayRecorder::records() const {
  const double since = seconds_between(*first_ns_, state().t_ns);
  return since >= kSettles && since < kSettles + kLongest && way_.size() < kMostNodes;
}

void WayRecorder::stepped(const Step& step) {
  if (!records()) return;
  const auto phi = state::motion_columns(step.phi.motion);
  WayNode& node = next_.node;
  node.by_gyro = (phi * node.by_gyro * phi.transpose()).eval() +
                 driven_by_gyro(step.integrals, step.end.q_n_b.toRotationMatrix());
  node.by_accel =
      (phi * node.by_accel * phi.transpose()).eval() + driven_by_accel(step.integrals.dt);
  phi_ = step.phi * phi_;
}

/// Of what was gone since the last one.
void WayRecorder::add_node() {
  if (state().t_ns == node_ns_ && !begins_) return;
  WayNode& node = next_.node;
  node.t_ns = state().t_ns;
  node.dt = seconds_between(node_ns_, node.t_ns);
  node.begins = std::exchange(begins_, false);
  if (node.begins) node.covariance = state::node_part(covariance());
  node.decay = phi_.decay.head(node.decay.size());
  next_.motion = phi_.motion;
  way_.push_back(std::move(next_));
  begin_node();
}

void WayRecorder::update(const measurement::ObservationPtr& observation) {
  catch_up();
  if (!records()) {
    EkfNavigator::update(observation);
    return begin_node();
  }
  add_node();
  UnfoldedNode::Measured measured{
      noise_of(observation->name()), linearize(*observation), state().slow, {}};
  const state::NavState before = state();
  EkfNavigator::update(observation);
  measured.correction = state::node_part(state::boxminus(state(), before));
  next_.slow = state().slow;
  way_.back().measured.push_back(std::move(measured));
}

/// What is added comes before what is measured at the same stamp.
void WayRecorder::loosen(const state::NodeMatrix& added) {
  catch_up();
  if (records()) {
    add_node();
    std::optional<state::NodeMatrix>& all = way_.back().node.covariance;
    all = all ? *all + added : added;
  }
  EkfNavigator::loosen(added);
}

void WayRecorder::hold() {
  catch_up();
  if (records()) add_node();
}

RecordedWay folded(const UnfoldedWay& way, const state::SlowVector& slow) {
  RecordedWay out;
  out.nodes.reserve(way.size());
  for (const UnfoldedNode& unfolded : way) {
    WayNode& node = out.nodes.emplace_back(unfolded.node);
    node.motion = state::node_columns(unfolded.motion);
    node.input = unfolded.motion.rightCols(slow.size()) * (slow - unfolded.slow);
    for (const UnfoldedNode::Measured& measured : unfolded.measured)
      if (measured.z.r.size() <= 3) node.measured.push_back(folded(measured, slow));
  }
  out.legs = legs_of(out.nodes);
  return out;
}

Eigen::Vector3d told_sigma(const RecordedWay& way, NoiseOf kind) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const WayNode& node : way.nodes) {
    for (const WayMeasurement& z : node.measured) {
      if (z.kind != kind) continue;
      sum += z.told_sigma.cwiseAbs2();
      ++count;
    }
  }
  return (sum / std::max(count, 1)).cwiseSqrt();
}

double length_s(const RecordedWay& way) {
  double sum = 0;
  for (const WayNode& node : way.nodes)
    if (!node.begins) sum += node.dt;
  return sum;
}

}  // namespace foucault::calibration
