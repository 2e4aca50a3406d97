#include "foucault/rawlog/mrpt_convert.h"

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/rawlog/rawlog_writer.h"

namespace foucault::rawlog {

namespace {

constexpr int64_t kTicksPerSecond = 10'000'000;
constexpr int64_t kUnixEpochTicks = 11'644'473'600 * kTicksPerSecond;  // 1601 to 1970
constexpr int64_t kNanosecondsPerTick = kNanosecondsPerSecond / kTicksPerSecond;

int64_t nearest_tick(int64_t t_ns) {
  const int64_t shifted = t_ns + (t_ns >= 0 ? 1 : -1) * kNanosecondsPerTick / 2;
  return shifted / kNanosecondsPerTick;
}

/// Half a turn about the forward axis: forward-left-up <-> forward-right-down.
const Eigen::Quaterniond kHalfTurn(0, 1, 0, 0);

Eigen::Vector3d flip(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

Eigen::Quaterniond rotation_of(const mrpt::poses::CPose3D& pose) {
  const mrpt::math::CMatrixDouble33& R = pose.getRotationMatrix();
  Eigen::Matrix3d rotation;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation(row, column) = R(row, column);
  }
  return Eigen::Quaterniond(rotation).normalized();
}

}  // namespace

std::optional<int64_t> from_mrpt(mrpt::system::TTimeStamp t) {
  constexpr int64_t kEarliest = kUnixEpochTicks + kEarliestStamp / kNanosecondsPerTick;
  constexpr int64_t kLatest = kUnixEpochTicks + kLatestStamp / kNanosecondsPerTick;
  const int64_t ticks = t.time_since_epoch().count();
  if (ticks < kEarliest || ticks > kLatest) return std::nullopt;
  return (ticks - kUnixEpochTicks) * kNanosecondsPerTick;
}

mrpt::system::TTimeStamp to_mrpt(int64_t t_ns) {
  return mrpt::system::TTimeStamp(mrpt::Clock::duration(nearest_tick(t_ns) + kUnixEpochTicks));
}

int64_t quantized(int64_t t_ns) { return nearest_tick(t_ns) * kNanosecondsPerTick; }

SensorPose from_mrpt(const mrpt::poses::CPose3D& pose_flu) {
  SensorPose pose;
  pose.q_v_s = (kHalfTurn * rotation_of(pose_flu)).normalized();
  pose.p_v_s = flip({pose_flu.x(), pose_flu.y(), pose_flu.z()});
  return pose;
}

mrpt::poses::CPose3D to_mrpt(const SensorPose& pose) {
  const Eigen::Matrix3d R = (kHalfTurn * pose.q_v_s).normalized().toRotationMatrix();
  mrpt::math::CMatrixDouble33 rotation;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation(row, column) = R(row, column);
  }
  const Eigen::Vector3d p = flip(pose.p_v_s);
  mrpt::math::CVectorFixedDouble<3> translation;
  for (int row = 0; row < 3; ++row) translation[row] = p[row];
  return {rotation, translation};
}

Eigen::Quaterniond flip_both(const Eigen::Quaterniond& q) { return {q.w(), q.x(), -q.y(), -q.z()}; }

void encode_imu(const imu::ImuSample& sample, mrpt::obs::CObservationIMU& imu) {
  using namespace mrpt::obs;  // the names of the indices: angular rates are stored yaw first
  imu.timestamp = to_mrpt(sample.t_ns);
  imu.set(IMU_WX, sample.gyro_b.x());
  imu.set(IMU_WY, sample.gyro_b.y());
  imu.set(IMU_WZ, sample.gyro_b.z());
  imu.set(IMU_X_ACC, sample.accel_b.x());
  imu.set(IMU_Y_ACC, sample.accel_b.y());
  imu.set(IMU_Z_ACC, sample.accel_b.z());
}

namespace {

constexpr int kYaw = 3;  ///< of x, y, z, yaw, pitch, roll

/// Clockwise from North to counterclockwise from East, and back.
double turned_azimuth(double angle) { return so3::wrap(0.5 * kPi - angle); }

}  // namespace

std::optional<GnssHeading> decode_heading(const mrpt::obs::CObservationRobotPose& pose) {
  const double yaw = pose.pose.mean.yaw(), variance = pose.pose.cov(kYaw, kYaw);
  if (!std::isfinite(yaw) || !std::isfinite(variance) || !(variance > 0)) return std::nullopt;
  return GnssHeading{turned_azimuth(yaw), std::sqrt(variance)};
}

void encode_heading(const GnssHeading& heading, mrpt::obs::CObservationRobotPose& pose) {
  constexpr double kNotKnown = 1e12;
  pose.pose.mean = mrpt::poses::CPose3D(0, 0, 0, turned_azimuth(heading.azimuth), 0, 0);
  pose.pose.cov.setZero();
  for (int i = 0; i < 6; ++i) pose.pose.cov(i, i) = kNotKnown;
  pose.pose.cov(kYaw, kYaw) = heading.sigma * heading.sigma;
}

ReferencePose decode_reference(const mrpt::obs::CObservationRobotPose& observation,
                               const Geodetic& origin, int64_t t_ns) {
  const mrpt::poses::CPose3D& mean = observation.pose.mean;
  const geodesy::LocalFrame frame(origin);
  const Eigen::Vector3d p_w(mean.y(), mean.x(), -mean.z());
  ReferencePose pose;
  pose.t_ns = t_ns;
  pose.position = frame.to_geodetic(p_w);
  // East-North-Up to North-East-Down: half a turn about the line north-east.
  const Eigen::Quaterniond q_ned_enu(0, M_SQRT1_2, M_SQRT1_2, 0);
  const Eigen::Quaterniond q_w_v = q_ned_enu * rotation_of(mean) * kHalfTurn;
  const Eigen::Quaterniond q_w_n(frame.R_w_n(pose.position));
  pose.q_n_v = (q_w_n.conjugate() * q_w_v).normalized();
  return pose;
}

ReferencePose moved_to_imu(const ReferencePose& pose, const SensorPose& from,
                           const Eigen::Vector3d& p_v_imu) {
  if (!pose.q_n_v) return pose;
  ReferencePose moved = pose;
  // What the reference calls its axes is forward-right-down of itself: identity when it is mounted
  // straight, while q_v_s of a sensor with forward-left-up axes is half a turn.
  const Eigen::Quaterniond q_v_r = from.q_v_s * kHalfTurn;
  moved.q_n_v = (*pose.q_n_v * q_v_r.conjugate()).normalized();
  const Eigen::Vector3d arm_n = *moved.q_n_v * (p_v_imu - from.p_v_s);
  if (arm_n.squaredNorm() > 0)
    moved.position = geodesy::LocalFrame(pose.position).to_geodetic(arm_n);
  return moved;
}

}  // namespace foucault::rawlog
