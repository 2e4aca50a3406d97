#pragma once

#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/system/datetime.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "foucault/core/measurement.h"
#include "foucault/imu/increments.h"

/// Between MRPT's observations and our measurements: the one place where stamps change their epoch
/// and frames turn from forward-left-up to forward-right-down. For programs that have one and want
/// the other; they link mrpt::obs beside foucault::rawlog.
namespace foucault::rawlog {

/// MRPT counts 100 ns since 1601. None for MRPT's invalid stamp and outside the years 1950 to 2150.
std::optional<int64_t> from_mrpt(mrpt::system::TTimeStamp t);
mrpt::system::TTimeStamp to_mrpt(int64_t t_ns);
/// Nearest stamp that MRPT can hold.
int64_t quantized(int64_t t_ns);

/// Pose of a sensor in the vehicle v, forward-right-down. The sensor's own axes stay what they are.
struct SensorPose {
  Eigen::Quaterniond q_v_s = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_v_s = Eigen::Vector3d::Zero();
};
SensorPose from_mrpt(const mrpt::poses::CPose3D& pose_flu);
mrpt::poses::CPose3D to_mrpt(const SensorPose& pose);

/// The rotation between two frames that are both forward-left-up, between their
/// forward-right-down counterparts (and back: it is its own inverse).
Eigen::Quaterniond flip_both(const Eigen::Quaterniond& q);

void encode_imu(const imu::ImuSample& sample, mrpt::obs::CObservationIMU& imu);

/// The position that a GPS record holds, and its velocity if there is one, without lever arm; none
/// if it holds no position.
std::optional<GnssFix> decode_fix(const mrpt::obs::CObservationGPS& gps, int64_t t_ns);
/// The position of an RMC, which has no height: zero, with a sigma of 1 km; with its velocity.
std::optional<GnssFix> decode_rmc(const mrpt::obs::CObservationGPS& gps, int64_t t_ns);

/// A velocity along the ground, of RMC or VTG; the vertical is left open by its covariance.
struct GroundVelocity {
  Eigen::Vector3d velocity_n = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};
std::optional<GroundVelocity> decode_velocity(const mrpt::obs::CObservationGPS& gps);

/// Messages of a fix; stamp, label and pose are the caller's.
void encode_fix(const GnssFix& fix, mrpt::obs::CObservationGPS& gps);

/// The heading of two antennas is the yaw of a pose in East-North-Up that bears this label and the
/// stamp of its fix, of whose covariance nothing else is small.
inline constexpr const char* kHeadingLabel = "HEADING";
/// None if it or its sigma is no number, or the sigma is zero.
std::optional<GnssHeading> decode_heading(const mrpt::obs::CObservationRobotPose& pose);
/// Stamp and label are the caller's.
void encode_heading(const GnssHeading& heading, mrpt::obs::CObservationRobotPose& pose);

/// The INSPVAS of a reference system; of its own place and axes (forward-right-down).
std::optional<ReferencePose> decode_reference(const mrpt::obs::CObservationGPS& gps, int64_t t_ns);
void encode_reference(const ReferencePose& pose, mrpt::obs::CObservationGPS& gps);

/// The same from a pose in East-North-Up at `origin`.
ReferencePose decode_reference(const mrpt::obs::CObservationRobotPose& pose, const Geodetic& origin,
                               int64_t t_ns);

/// Moves position and attitude of a sensor `from` to the IMU, on the vehicle's axes. The velocity
/// takes the rate, which no record of a reference has: the source adds it.
ReferencePose moved_to_imu(const ReferencePose& pose, const SensorPose& from,
                           const Eigen::Vector3d& p_v_imu);

}  // namespace foucault::rawlog
