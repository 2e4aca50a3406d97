#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "foucault/ekf/ekf.h"
#include "foucault/measurement/observation.h"
#include "foucault/state/blocks.h"

/// A run of a filter as a linear system. Transitions of errors, residuals about the nominal state
/// and what a unit of white noise drives into the state do not depend on how large the noise is: a
/// recording is gone again in a hundredth of the time, with any.
namespace foucault::calibration {

/// Whose noise a measurement has.
enum class NoiseOf { position, velocity, heading, slip, wheel, rest };

/// Without satellites there is none of it.
inline bool is_of_receiver(NoiseOf kind) {
  return kind == NoiseOf::position || kind == NoiseOf::velocity || kind == NoiseOf::heading;
}

/// Something measured at a node: r = H error + noise, by rows whose noise is white, of one, as it
/// was told. Afterwards the nominal state was moved by `correction`.
struct WayMeasurement {
  NoiseOf kind = NoiseOf::position;
  int rows = 0;                                 ///< 1 to 3
  Eigen::Vector3d r = Eigen::Vector3d::Zero();  ///< those beyond are zero
  state::RowsByNode<3> H = state::RowsByNode<3>::Zero();
  Eigen::Matrix3d by_sigmas = Eigen::Matrix3d::Zero();   ///< of an error of one sigma, by axis of n
  Eigen::Vector3d told_sigma = Eigen::Vector3d::Zero();  ///< of each row as it was measured
  state::NodeVector correction = state::NodeVector::Zero();
};

/// An instant at which something was measured or a second had passed:
/// error = (motion; decay) * error at the node before + input + noise.
struct WayNode {
  int64_t t_ns = 0;
  double dt = 0;                                ///< since the node before [s]
  bool begins = false;                          ///< nothing comes from the node before
  std::optional<state::NodeMatrix> covariance;  ///< where it begins; elsewhere what was added to it
  state::RowsByNode<state::MotionVector::RowsAtCompileTime> motion =
      state::RowsByNode<state::MotionVector::RowsAtCompileTime>::Zero();
  state::BiasVector decay = state::BiasVector::Ones();  ///< of the biases
  state::MotionVector input =
      state::MotionVector::Zero();  ///< of slow blocks, which are at what they came to be
  /// Covariance that a unit of white noise drives [rad/s, m/s^2]
  state::MotionMatrix by_gyro = state::MotionMatrix::Zero(), by_accel = state::MotionMatrix::Zero();
  std::vector<WayMeasurement> measured;  ///< in the order of use
};

/// From a node to a later one as one step, for those who meet none of the fixes between: with what
/// moved the nominal state there in the input, and biases that vary driving all they act on.
struct WayLeg {
  std::size_t to = 0;  ///< node
  double dt = 0;       ///< [s]
  state::RowsByNode<state::MotionVector::RowsAtCompileTime> motion =
      state::RowsByNode<state::MotionVector::RowsAtCompileTime>::Identity();
  state::BiasVector decay = state::BiasVector::Ones();
  state::NodeVector input = state::NodeVector::Zero();
  /// Covariance that a unit of white noise drives, of sensors and of their biases
  state::MotionMatrix by_gyro = state::MotionMatrix::Zero(), by_accel = state::MotionMatrix::Zero();
  state::NodeMatrix by_gyro_bias = state::NodeMatrix::Zero(),
                    by_accel_bias = state::NodeMatrix::Zero();
};

struct RecordedWay {
  std::vector<WayNode> nodes;
  std::vector<WayLeg> legs;  ///< one after the other, the first to where the way begins

  bool empty() const { return nodes.empty(); }
};

/// Legs end at measurements that are no fixes, at a fix every second, and where covariance is added
/// or nothing comes from before.
std::vector<WayLeg> legs_of(const std::vector<WayNode>& nodes);

/// What the recorder leaves, with slow blocks as they were on the way.
struct UnfoldedNode {
  struct Measured {
    NoiseOf kind;
    state::Linearized z;
    state::SlowVector slow;
    state::NodeVector correction;
  };
  WayNode node;
  state::MotionByState motion;
  state::SlowVector slow;  ///< at the node before
  std::vector<Measured> measured;
};
using UnfoldedWay = std::vector<UnfoldedNode>;

/// The EKF, that leaves a way. It begins a minute after the run, when attitude and biases are
/// settled and errors are as linear as the filter takes them to be, and ends an hour later, or
/// after fifty thousand nodes of 4 kB each.
class WayRecorder final : public ekf::EkfNavigator {
 public:
  /// `way` gets the nodes and must outlive this.
  WayRecorder(const imu::ImuNoise& imu, const state::Layout& layout, const ekf::EkfOptions& options,
              UnfoldedWay& way);

  void start(const state::Epoch& initial) override;
  void update(const measurement::ObservationPtr& observation) override;
  void loosen(const state::NodeMatrix& added) override;
  void hold() override;

 protected:
  void stepped(const Step& step) override;

 private:
  bool records() const;
  void begin_node();
  void add_node();

  UnfoldedWay& way_;
  std::optional<int64_t> first_ns_;
  int64_t node_ns_ = 0;
  bool begins_ = true;
  UnfoldedNode next_;
  ekf::Phi phi_;  ///< since the last node
};

/// The way with slow blocks known to be `slow`, what they lacked on it as an input. Measurements of
/// more than three rows are left out.
RecordedWay folded(const UnfoldedWay& way, const state::SlowVector& slow);

/// Root mean square of the sigmas that were told with measurements of a kind, by row; zero of none.
Eigen::Vector3d told_sigma(const RecordedWay& way, NoiseOf kind);

/// Time on the way [s].
double length_s(const RecordedWay& way);

}  // namespace foucault::calibration
