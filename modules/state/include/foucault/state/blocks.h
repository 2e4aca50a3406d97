#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string_view>
#include <type_traits>

/// The list of all that can be estimated, the one home of sizes and offsets. Every state holds
/// position, velocity, attitude and the biases of the IMU, the blocks of a node; behind them come
/// the slow blocks that a Layout has, in its order.
namespace foucault::state {

/// Something that is estimated: a short vector with a name. Blocks of one name are the same.
struct Block {
  std::string_view name;  ///< as in metrics.json; calibrate.NAME in the configuration
  int size = 3;
  std::string_view unit;
};

/// A block of a node: three rows at a fixed place.
struct NodeBlock : Block {
  int offset = 0;
};

constexpr int kMotionSize = 9;  ///< rows of position, velocity and attitude
constexpr int kNodeSize = 15;
constexpr int kMostSlow = 28;                     ///< rows of slow blocks
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
/// What of one true axis shows on another, measured = (I + M) true + bias: M's xy, yz, zx, xz, yx,
/// zy of the gyroscopes; xy, yz, xz of the accelerometers, whose x and y so define the axes b.
inline constexpr Block gyro_cross_axis{"gyro_cross_axis", 6, "1"};
inline constexpr Block accel_cross_axis{"accel_cross_axis", 3, "1"};

/// IMU to antenna, what has to be added to the one that fixes come with; in b.
inline constexpr Block lever_arm{"lever_arm", 3, "m"};
/// Fixes are of so much before their stamps, on the clock of the IMU: offset plus drift times the
/// time since the first fix.
inline constexpr Block time_offset{"time_offset", 1, "s"};
inline constexpr Block time_drift{"time_drift", 1, "1"};
/// The vehicle's axes are those that the log tells turned by exp(0, pitch, heading): a vector of
/// the told ones times that matrix is one of the vehicle's. Roll does not show where wheels do not
/// slip.
inline constexpr Block mounting{"mounting", 2, "rad"};
/// Forward speed = (1 + scale) times what the wheels tell.
inline constexpr Block wheel_scale{"wheel_scale", 1, "1"};
/// IMU to the point of the vehicle that does not slip sideways; in b.
inline constexpr Block wheel_lever_arm{"wheel_lever_arm", 3, "m"};
/// That point drifts outward in a bend, by an angle of so much times its acceleration to the side:
/// tyres are springs.
inline constexpr Block cornering_compliance{"cornering_compliance", 1, "rad/(m/s^2)"};
/// Direction of the baseline between two antennas on the told axes of the vehicle, what it was told
/// wrong by.
inline constexpr Block baseline_heading{"baseline_heading", 1, "rad"};
}  // namespace block

using NodeVector = Eigen::Matrix<double, kNodeSize, 1>;
using NodeMatrix = Eigen::Matrix<double, kNodeSize, kNodeSize>;
using NodeRow = Eigen::Matrix<double, 1, kNodeSize>;
template <int kColumns>
using NodeBy = Eigen::Matrix<double, kNodeSize, kColumns>;

template <int kRows>
using RowsByNode = Eigen::Matrix<double, kRows, kNodeSize>;
using MotionVector = Eigen::Matrix<double, kMotionSize, 1>;
using MotionMatrix = Eigen::Matrix<double, kMotionSize, kMotionSize>;
using BiasVector = Eigen::Matrix<double, kNodeSize - kMotionSize, 1>;

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
template <class Matrix>
auto node_columns(Matrix&& m) {
  return m.template leftCols<kNodeSize>();
}
template <class Matrix>
auto motion_columns(Matrix&& m) {
  return m.template leftCols<kMotionSize>();
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

/// Three elements of a matrix M of scales: row[m], column[m].
struct AxisPairs {
  std::array<int, 3> row, column;
};
namespace axis_pairs {
inline constexpr AxisPairs scale{{0, 1, 2}, {0, 1, 2}};
inline constexpr std::array<AxisPairs, 2> gyro_cross{
    AxisPairs{{0, 1, 2}, {1, 2, 0}}, AxisPairs{{0, 1, 2}, {2, 0, 1}}};  ///< as the block has them
inline constexpr AxisPairs accel_cross{{0, 1, 0}, {1, 2, 2}};
}  // namespace axis_pairs

/// C M v by three elements of M, a column each.
inline Eigen::Matrix3d by_elements(const Eigen::Matrix3d& C, const Eigen::Vector3d& v,
                                   const AxisPairs& pairs) {
  Eigen::Matrix3d out;
  for (int m = 0; m < 3; ++m) out.col(m) = v[pairs.column[m]] * C.col(pairs.row[m]);
  return out;
}

/// Errors of an IMU's scales and axes: measured = (I + M) true + bias.
struct ImuScale {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();  ///< diagonal of M
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 1> gyro_cross = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Vector3d accel_cross = Eigen::Vector3d::Zero();

  Eigen::Matrix3d gyro_matrix() const;   ///< M
  Eigen::Matrix3d accel_matrix() const;  ///< M
  Eigen::Matrix3d gyro_gain() const;     ///< (I + M)^-1
  Eigen::Matrix3d accel_gain() const;
};

}  // namespace foucault::state
