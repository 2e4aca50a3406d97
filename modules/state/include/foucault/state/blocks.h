#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string_view>
#include <type_traits>

/// The list of all that can be estimated, the one home of sizes and offsets. Every state holds
/// position, velocity, attitude and the biases of the IMU, the blocks of a node; behind them come
/// the slow blocks that a Layout has, in its order.
namespace foucault::state {

/// Something that is estimated: a short vector with a name. Blocks of one name are the same.
struct Block {
  std::string_view name;  ///< as in metrics.json; calibrate.<name> in the configuration
  int size = 3;
  std::string_view unit;
};

/// A block of a node: three rows at a fixed place.
struct NodeBlock : Block {
  int offset = 0;
};

constexpr int kMotionSize = 9;  ///< rows of position, velocity and attitude
constexpr int kNodeSize = 15;
constexpr int kMostSlow = 17;                     ///< rows of slow blocks
constexpr int kMostSize = kNodeSize + kMostSlow;  ///< rows of a state

/// Rows of a state with so many rows of slow blocks.
constexpr Eigen::Index state_size(Eigen::Index slow_size) { return kNodeSize + slow_size; }

/// Errors are true minus estimated; the attitude's is a right perturbation, q = q_hat * exp(d).
namespace block {
inline constexpr NodeBlock position{{"position", 3, "m"}, 0};
inline constexpr NodeBlock velocity{{"velocity", 3, "m/s"}, 3};
inline constexpr NodeBlock attitude{{"attitude", 3, "rad"}, 6};  ///< in b
inline constexpr NodeBlock gyro_bias{{"gyro_bias", 3, "rad/s"}, 9};
inline constexpr NodeBlock accel_bias{{"accel_bias", 3, "m/s^2"}, 12};

/// measured = (1 + scale) * true + bias, an axis of b each.
inline constexpr Block gyro_scale{"gyro_scale", 3, "1"};
inline constexpr Block accel_scale{"accel_scale", 3, "1"};

/// IMU to antenna, what has to be added to the one that fixes come with; in b.
inline constexpr Block lever_arm{"lever_arm", 3, "m"};
/// Fixes are of so much before their stamps, on the clock of the IMU.
inline constexpr Block time_offset{"time_offset", 1, "s"};
}  // namespace block

using NodeVector = Eigen::Matrix<double, kNodeSize, 1>;
using NodeMatrix = Eigen::Matrix<double, kNodeSize, kNodeSize>;
using NodeRow = Eigen::Matrix<double, 1, kNodeSize>;
template <int kColumns>
using NodeBy = Eigen::Matrix<double, kNodeSize, kColumns>;

/// Of the slow blocks, on the stack.
using SlowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostSlow, 1>;
using SlowMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostSlow, kMostSlow>;
/// Rows of a node by columns of the slow blocks.
using NodeBySlow =
    Eigen::Matrix<double, kNodeSize, Eigen::Dynamic, Eigen::ColMajor, kNodeSize, kMostSlow>;

/// Of a whole state, on the stack.
using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostSize, 1>;
using StateMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostSize, kMostSize>;
template <int kMostRows>
using RowsByState =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostRows, kMostSize>;
template <int kMostColumns>
using StateByColumns =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostSize, kMostColumns>;
/// The rows of a node, and of its motion.
using NodeByState =
    Eigen::Matrix<double, kNodeSize, Eigen::Dynamic, Eigen::ColMajor, kNodeSize, kMostSize>;
using MotionByState =
    Eigen::Matrix<double, kMotionSize, Eigen::Dynamic, Eigen::ColMajor, kMotionSize, kMostSize>;

/// The part of a vector, or of a matrix, that belongs to blocks of a node.
template <class Vector>
auto part(Vector&& v, const NodeBlock& block) {
  return v.template segment<3>(block.offset);
}
template <class Matrix>
auto part(Matrix&& m, const NodeBlock& row, const NodeBlock& column) {
  return m.template block<3, 3>(row.offset, column.offset);
}
template <class Matrix>
auto rows_of(Matrix&& m, const NodeBlock& block) {
  return m.template middleRows<3>(block.offset);
}
template <class Matrix>
auto columns_of(Matrix&& m, const NodeBlock& block) {
  return m.template middleCols<3>(block.offset);
}

/// Of a vector or a square matrix of a whole state: what belongs to the node, what to the slow
/// blocks, and the two rectangles between them.
template <class Matrix>
auto node_part(Matrix&& m) {
  if constexpr (std::decay_t<Matrix>::IsVectorAtCompileTime)
    return m.template head<kNodeSize>();
  else
    return m.template topLeftCorner<kNodeSize, kNodeSize>();
}
template <class Matrix>
auto slow_part(Matrix&& m) {
  if constexpr (std::decay_t<Matrix>::IsVectorAtCompileTime)
    return m.tail(m.size() - kNodeSize);
  else
    return m.bottomRightCorner(m.rows() - kNodeSize, m.cols() - kNodeSize);
}
template <class Matrix>
auto node_by_slow(Matrix&& m) {
  return m.topRightCorner(kNodeSize, m.cols() - kNodeSize);
}
template <class Matrix>
auto slow_by_node(Matrix&& m) {
  return m.bottomLeftCorner(m.rows() - kNodeSize, kNodeSize);
}
/// What of a vector is not motion: biases and slow blocks.
template <class Vector>
auto sensor_part(Vector&& v) {
  return v.tail(v.size() - kMotionSize);
}

/// Biases of an IMU; subtracted from its measurements.
struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s], b
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< [m/s^2], b
};

/// Errors of an IMU's scales: measured = (1 + scale) * true + bias.
struct ImuScale {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
};

}  // namespace foucault::state
