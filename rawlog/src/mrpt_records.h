#pragma once

#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/poses/CPose3D.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

#include "foucault/core/measurement.h"
#include "foucault/imu/increments.h"
#include "inflated_file.h"
#include "record_cursor.h"

/// The records of MRPT that we use, read without trusting a byte of them.
///
/// MRPT's own deserializer takes any length it reads for true and allocates it before it looks for
/// the data; it also cannot read some of the messages it writes (NovAtel frames with a body). So
/// the classes that we use are read here, in bounds, and nothing else is deserialized at all:
/// records of other classes carry no length, but they end where the next record begins.
///
/// Format: github.com/MRPT/mrpt, CArchive.cpp (frame of an object) and serializeFrom() of the
/// classes: length of the class name + 128, the name, the version, the fields, 0x88.
namespace foucault::rawlog {

/// What stands before the fields of an object.
struct ObjectHeader {
  std::string_view name;  ///< of the class, with name spaces
  uint8_t version = 0;
  size_t size = 0;  ///< of the header [bytes]
};

constexpr unsigned char kEndOfObject = 0x88;
constexpr size_t kLongestHeader = 122;  ///< [bytes]; the name has 120 at most, as in MRPT

std::string_view without_namespace(std::string_view class_name);

/// None if the bytes do not begin an object. Throws RecordTooShort if they may but break off.
std::optional<ObjectHeader> read_header(Bytes bytes);

bool is_observation_class(std::string_view class_name);

/// Whether objects of this class follow each other in a rawlog: observations, sensory frames and
/// collections of actions.
bool is_rawlog_class(std::string_view class_name);

/// First byte in [from, bytes.end) that ends an object and is followed by the header of a rawlog
/// class; bytes.end if there is none.
const unsigned char* find_end_of_object(const unsigned char* from, Bytes bytes);

/// A CObservationIMU. Its views point into the bytes it was read from.
struct ImuRecord {
  std::optional<int64_t> t_ns;
  std::string_view label;
  std::optional<imu::ImuSample> sample;            ///< none without gyroscope or accelerometer
  std::optional<Eigen::Vector3d> gyro_b, accel_b;  ///< one of them, where the other is missing
  Bytes pose;                                      ///< the object sensorPose
};

/// A sensorPose.
mrpt::poses::CPose3D pose_of(Bytes pose);

/// A CObservationGPS of a reference, which has one at every sample of the IMU: its INSPVAS. Its
/// views point into the bytes it was read from.
struct InsRecord {
  std::optional<int64_t> t_ns;
  std::string_view label;
  Bytes pose;     ///< the object sensorPose
  Bytes message;  ///< the fields of INSPVAS
};

/// Its pose, as decode_reference() of the whole record.
ReferencePose decode_reference(const InsRecord& record, int64_t t_ns);

/// What CObservationGPS has since MRPT 2.11.12 (version 12) and 2.15 (version 13).
struct GpsExtras {
  /// MRPT's GnssFixType, which are numbers here since MRPT 2.5.8 has no names for them.
  enum FixType : uint8_t {
    kUnknown = 0,
    kNoFix = 1,
    kAutonomous = 2,
    kSbas = 3,
    kGbas = 4,
    kDgps = 5,
    kRtkFloat = 6,
    kRtkFixed = 7,
    kPpp = 8,
    kDeadReckoning = 9,
    kSimulation = 10
  };

  std::optional<Eigen::Matrix3d> position_covariance_w;  ///< east, north, up [m^2]
  uint8_t kind_of_fix = kUnknown;                        ///< a FixType, or one that came later
};

struct GpsRecord : mrpt::obs::CObservationGPS, GpsExtras {};

/// These read the fields of an object in one of the versions that its class has had, up to its end.
/// They throw RecordTooShort, BadRecord and UnknownVersion.
ImuRecord read_imu(RecordCursor& cursor, int version);  ///< 0 to 4
/// A GpsRecord of versions 3 (before, there was no stamp) to 13. Of the messages those that we use:
/// GGA, RMC, VTG, BESTPOS, INSPVAS, PZS.
mrpt::obs::CObservation::Ptr read_gps(RecordCursor& cursor, int version);
/// The same of one that bears this label and holds an INSPVAS and nothing else; none of another,
/// over which `cursor` has not been moved.
std::optional<InsRecord> read_ins(RecordCursor& cursor, int version, std::string_view label);
mrpt::obs::CObservation::Ptr read_comment(RecordCursor& cursor, int version);     ///< 0 and 1
mrpt::obs::CObservation::Ptr read_odometry(RecordCursor& cursor, int version);    ///< 0 to 2
mrpt::obs::CObservation::Ptr read_robot_pose(RecordCursor& cursor, int version);  ///< 0 and 1

}  // namespace foucault::rawlog
