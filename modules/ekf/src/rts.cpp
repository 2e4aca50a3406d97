#include "foucault/ekf/rts.h"

#include <Eigen/Cholesky>

#include "foucault/core/time.h"

namespace foucault {
namespace {

using error_state::kAttitude;
using error_state::kPosition;
using error_state::kVelocity;

/// State and covariance from all fixes, every component of the filter's.
struct Smoothed {
  ekf::FullState state;
  Eigen::MatrixXd covariance;
};

/// One step back. G = P_f phi' P_p^-1; the error found in the next node's prediction is carried to
/// the filtered state.
Smoothed step_back(const RtsNode& node, const RtsNode& next, const Smoothed& next_smoothed) {
  const Eigen::MatrixXd carried = next.phi * node.filtered_covariance;
  const Eigen::MatrixXd gain = next.predicted_covariance.ldlt().solve(carried).transpose();
  const ekf::Vector found =
      difference(next.predicted, next_smoothed.state, static_cast<int>(gain.rows()));
  const Eigen::MatrixXd change = next_smoothed.covariance - next.predicted_covariance;
  const Eigen::MatrixXd covariance = node.filtered_covariance + gain * change * gain.transpose();
  return {corrected(node.filtered, gain * found), 0.5 * (covariance + covariance.transpose())};
}

SmoothedNode result_of(const RtsNode& node, const Smoothed& smoothed) {
  return {smoothed.state, smoothed.covariance.topLeftCorner<15, 15>(),
          difference(node.predicted, smoothed.state, error_state::kSize),
          difference(node.filtered, smoothed.state, error_state::kSize)};
}

/// Value at s in [0, 1] between (a, slope a) and (b, slope b), slopes by s.
Eigen::Vector3d hermite(double s, const Eigen::Vector3d& a, const Eigen::Vector3d& slope_a,
                        const Eigen::Vector3d& b, const Eigen::Vector3d& slope_b) {
  const double r = 1 - s;
  return r * r * ((1 + 2 * s) * a + s * slope_a) + s * s * ((1 + 2 * r) * b - r * slope_b);
}

/// The error of the forward run between nodes. It is the error in n that changes smoothly.
ekf::Vector error_between(double s, double length, const SmoothedNode& begin,
                          const SmoothedNode& end, const Eigen::Quaterniond& q_n_b) {
  const Vector15d& a = begin.after;
  const Vector15d& b = end.before;
  const Eigen::Vector3d attitude_n =
      (1 - s) * (begin.state.motion.q_n_b * a.segment<3>(kAttitude)) +
      s * (end.state.motion.q_n_b * b.segment<3>(kAttitude));
  ekf::Vector error = (1 - s) * a + s * b;
  error.segment<3>(kPosition) =
      hermite(s, a.segment<3>(kPosition), length * a.segment<3>(kVelocity), b.segment<3>(kPosition),
              length * b.segment<3>(kVelocity));
  error.segment<3>(kAttitude) = q_n_b.conjugate() * attitude_n;
  return error;
}

Epoch to_epoch(const ekf::FullState& state, const Matrix15d& covariance) {
  Epoch epoch;
  epoch.t_ns = state.motion.t_ns;
  epoch.position = state.motion.position;
  epoch.velocity_n = state.motion.v_n;
  epoch.q_n_b = state.motion.q_n_b;
  epoch.bias = state.bias;
  epoch.covariance = covariance;
  return epoch;
}

}  // namespace

std::vector<SmoothedNode> smooth(const std::vector<RtsNode>& nodes) {
  std::vector<SmoothedNode> results(nodes.size());
  Smoothed smoothed;
  for (std::size_t k = nodes.size(); k-- > 0;) {
    const bool ends_run = k + 1 == nodes.size() || nodes[k + 1].begins_run;
    smoothed = ends_run ? Smoothed{nodes[k].filtered, nodes[k].filtered_covariance}
                        : step_back(nodes[k], nodes[k + 1], smoothed);
    results[k] = result_of(nodes[k], smoothed);
  }
  return results;
}

Epoch to_epoch(const SmoothedNode& node) { return to_epoch(node.state, node.covariance); }

Epoch between(const SmoothedNode& begin, const SmoothedNode& end, const StrapdownState& forward) {
  const int64_t begin_ns = begin.state.motion.t_ns;
  const double length = seconds_between(begin_ns, end.state.motion.t_ns);
  const double s = seconds_between(begin_ns, forward.t_ns) / length;
  ekf::FullState state;
  state.motion = forward;
  state = corrected(state, error_between(s, length, begin, end, forward.q_n_b));
  state.bias.gyro = (1 - s) * begin.state.bias.gyro + s * end.state.bias.gyro;
  state.bias.accel = (1 - s) * begin.state.bias.accel + s * end.state.bias.accel;
  return to_epoch(state, (1 - s) * begin.covariance + s * end.covariance);
}

void RtsRecorder::start(const Epoch& initial) {
  if (!nodes_.empty()) mark();
  EkfNavigator::start(initial);
  add_node();
  nodes_.back().begins_run = true;
}

void RtsRecorder::update(const GnssFix& fix) {
  catch_up();
  add_node();
  EkfNavigator::update(fix);
  RtsNode& node = nodes_.back();
  node.filtered = state();
  node.filtered_covariance = covariance();
  node.p_b_a = fix.p_b_a;
}

std::size_t RtsRecorder::mark() {
  if (!at_node()) {
    catch_up();
    add_node();
  }
  return nodes_.size() - 1;
}

bool RtsRecorder::at_node() const {
  return !nodes_.empty() && nodes_.back().filtered.motion.t_ns == state().motion.t_ns;
}

void RtsRecorder::stepped(const ekf::Matrix& phi) { phi_ = (phi * phi_).eval(); }

void RtsRecorder::add_node() {
  RtsNode node;
  node.predicted = node.filtered = state();
  node.predicted_covariance = node.filtered_covariance = covariance();
  node.phi = phi_;
  phi_ = ekf::Matrix::Identity(node.predicted_covariance.rows(), node.predicted_covariance.cols());
  nodes_.push_back(std::move(node));
}

}  // namespace foucault
