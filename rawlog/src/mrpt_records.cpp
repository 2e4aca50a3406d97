#include "mrpt_records.h"

#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/gnss_messages.h>
#include <mrpt/poses/CPose3DQuat.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "foucault/rawlog/mrpt_convert.h"

namespace foucault::rawlog {

namespace {

namespace gnss = mrpt::obs::gnss;

constexpr size_t kLongestName = kLongestHeader - 2;
constexpr size_t kLongestLabel = 1024;
constexpr size_t kMostImuFields = 256;
constexpr size_t kMostMessages = 64;
constexpr size_t kLongestMessage = size_t{1} << 14;

/// False also for a header that the bytes cut off.
bool begins_rawlog_object(Bytes bytes) {
  if (bytes.size() == 0 || bytes.size() < (bytes.begin[0] & 0x7FU) + 2) return false;
  const std::optional<ObjectHeader> header = read_header(bytes);
  return header && is_rawlog_class(header->name);
}

/// Of class names; every record has one, so a table.
constexpr std::array<bool, 256> name_characters() {
  std::array<bool, 256> allowed{};
  for (const char c : std::string_view("_:<>,")) allowed[static_cast<unsigned char>(c)] = true;
  for (unsigned char c = '0'; c <= '9'; ++c) allowed[c] = true;
  for (unsigned char c = 'A'; c <= 'Z'; ++c) allowed[c] = allowed[c + 'a' - 'A'] = true;
  return allowed;
}
constexpr std::array<bool, 256> kNameCharacters = name_characters();

bool is_name_character(unsigned char c) { return kNameCharacters[c]; }

/// A nested object whose class must be `name` (before MRPT 2: without name spaces); its version.
int nested(RecordCursor& cursor, std::string_view name) {
  const size_t length = cursor.get<uint8_t>();
  if (length < 0x80 || length - 0x80 > kLongestName) throw BadRecord("no object inside it");
  const std::string_view found(reinterpret_cast<const char*>(cursor.take(length - 0x80)),
                               length - 0x80);
  if (found != name && found != without_namespace(name)) {
    throw BadRecord("no " + std::string(without_namespace(name)) + " inside it");
  }
  return cursor.get<uint8_t>();
}

void require_version(int version, int oldest, int newest) {
  if (version < oldest) throw UnknownVersion(UnknownVersion::Age::older);
  if (version > newest) throw UnknownVersion(UnknownVersion::Age::newer);
}

void end_of_object(RecordCursor& cursor) {
  if (cursor.get<uint8_t>() != kEndOfObject) throw BadRecord("its end is not where it must be");
}

/// Version 2 holds a position and a quaternion, 3 a position and a rotation matrix.
Bytes walk_pose(RecordCursor& cursor) {
  const size_t start = cursor.position();
  const int version = nested(cursor, "mrpt::poses::CPose3D");
  require_version(version, 2, 3);
  cursor.skip((version == 2 ? 7 : 12) * sizeof(double));
  end_of_object(cursor);
  return cursor.since(start);
}

mrpt::poses::CPose3D pose_of(RecordCursor cursor) {
  const int version = nested(cursor, "mrpt::poses::CPose3D");
  const auto x = cursor.get<double>();
  const auto y = cursor.get<double>();
  const auto z = cursor.get<double>();
  if (version == 2) {
    mrpt::poses::CPose3DQuat pose;
    pose.x(x);
    pose.y(y);
    pose.z(z);
    for (size_t i = 0; i < 4; ++i) pose.quat()[i] = cursor.get<double>();
    return mrpt::poses::CPose3D(pose);
  }
  mrpt::math::CMatrixDouble33 rotation;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation(row, column) = cursor.get<double>();
  }
  mrpt::math::CVectorFixedDouble<3> translation;
  translation[0] = x;
  translation[1] = y;
  translation[2] = z;
  return {rotation, translation};
}

mrpt::poses::CPose3D read_pose(RecordCursor& cursor) {
  return pose_of(RecordCursor(walk_pose(cursor)));
}

mrpt::system::TTimeStamp read_stamp(RecordCursor& cursor) {
  return mrpt::system::TTimeStamp(mrpt::Clock::duration(cursor.get<int64_t>()));
}

// IMU -------------------------------------------------------------------------------------------

/// The values of a record, of which a part may be missing.
class ImuValues {
 public:
  ImuValues(const unsigned char* present, const unsigned char* values, size_t count,
            size_t value_size)
      : present_(present), values_(values), count_(count), value_size_(value_size) {}

  bool has(size_t index) const { return index < count_ && present_[index] != 0; }

  double get(size_t index) const {
    const unsigned char* const at = values_ + index * value_size_;
    if (value_size_ == sizeof(float)) return read<float>(at);
    return read<double>(at);
  }

 private:
  template <class T>
  static T read(const unsigned char* at) {
    T value;
    std::memcpy(&value, at, sizeof(T));
    return value;
  }

  const unsigned char* present_;
  const unsigned char* values_;
  size_t count_;
  size_t value_size_;
};

std::optional<Eigen::Vector3d> vector_of(const ImuValues& values,
                                         const std::array<size_t, 3>& indices) {
  for (const size_t index : indices) {
    if (!values.has(index)) return std::nullopt;
  }
  return Eigen::Vector3d(values.get(indices[0]), values.get(indices[1]), values.get(indices[2]));
}

/// Until version 1 grabbers stored roll and yaw rate the wrong way round.
void take_values(const ImuValues& values, bool swapped_rates, ImuRecord& record) {
  using namespace mrpt::obs;
  record.gyro_b = vector_of(values, {swapped_rates ? size_t{IMU_WZ} : size_t{IMU_WX}, IMU_WY,
                                     swapped_rates ? size_t{IMU_WX} : size_t{IMU_WZ}});
  record.accel_b = vector_of(values, {IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC});
  if (!record.gyro_b || !record.accel_b) return;
  record.sample = imu::ImuSample{record.t_ns.value_or(0), *record.gyro_b, *record.accel_b};
  record.gyro_b.reset();
  record.accel_b.reset();
}

// GNSS ------------------------------------------------------------------------------------------

/// A CMatrixF of floats or a CMatrixD of doubles.
template <class Value, int kSide>
Eigen::Matrix<Value, kSide, kSide> read_matrix(RecordCursor& cursor, std::string_view name) {
  require_version(nested(cursor, name), 0, 0);
  if (cursor.get<uint32_t>() != kSide || cursor.get<uint32_t>() != kSide) {
    throw BadRecord("a covariance of another size");
  }
  Eigen::Matrix<Value, kSide, kSide> matrix;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) matrix(row, column) = cursor.get<Value>();
  }
  end_of_object(cursor);
  return matrix;
}

/// The diagonal, then what is above it by rows.
void read_symmetric(RecordCursor& cursor, mrpt::math::CMatrixDouble66& matrix) {
  for (int i = 0; i < 6; ++i) matrix(i, i) = cursor.get<double>();
  for (int row = 0; row < 6; ++row) {
    for (int column = row + 1; column < 6; ++column)
      matrix(row, column) = matrix(column, row) = cursor.get<double>();
  }
}

mrpt::math::CMatrixFloat44 read_covariance(RecordCursor& cursor) {
  return mrpt::math::CMatrixFloat44(read_matrix<float, 4>(cursor, "mrpt::math::CMatrixF"));
}

/// A std::optional: these words, the name of its type, whether it is there.
std::optional<Eigen::Matrix3d> read_optional_covariance(RecordCursor& cursor) {
  constexpr size_t kLongestWord = 80;
  if (cursor.text(kLongestWord) != "std::optional") throw BadRecord("no std::optional inside it");
  cursor.text(kLongestWord);
  if (!cursor.flag()) return std::nullopt;
  return read_matrix<double, 3>(cursor, "mrpt::math::CMatrixD");
}

void read_pzs_position(RecordCursor& cursor, gnss::Message_TOPCON_PZS& pzs) {
  cursor.get(pzs.latitude_degrees, pzs.longitude_degrees, pzs.height_meters, pzs.RTK_height_meters,
             pzs.PSigma, pzs.angle_transmitter, pzs.nId, pzs.Fix, pzs.TXBattery, pzs.RXBattery,
             pzs.error);
}

void read_pzs_extras(RecordCursor& cursor, bool with_progress, gnss::Message_TOPCON_PZS& pzs) {
  pzs.hasCartesianPosVel = cursor.flag();
  cursor.get(pzs.cartesian_x, pzs.cartesian_y, pzs.cartesian_z, pzs.cartesian_vx, pzs.cartesian_vy,
             pzs.cartesian_vz);
  pzs.hasPosCov = cursor.flag();
  pzs.pos_covariance = read_covariance(cursor);
  pzs.hasVelCov = cursor.flag();
  pzs.vel_covariance = read_covariance(cursor);
  pzs.hasStats = cursor.flag();
  cursor.get(pzs.stats_GPS_sats_used, pzs.stats_GLONASS_sats_used);
  if (with_progress) cursor.get(pzs.stats_rtk_fix_progress);
}

void skip_sats(RecordCursor& cursor) {
  cursor.skip(cursor.count(kLongestMessage));
  cursor.skip(cursor.count(kLongestMessage));
  cursor.skip(cursor.count(kLongestMessage) * sizeof(int16_t));
}

/// NovAtel logs of a variable length: a length, a header, a count, elements.
void skip_list(RecordCursor& cursor, size_t element) {
  constexpr size_t kHeader = 28;
  cursor.skip(sizeof(uint32_t) + kHeader);
  cursor.skip(cursor.count(kLongestMessage) * element);
}

void skip_frame(RecordCursor& cursor, size_t header) {
  cursor.skip(header);
  cursor.skip(cursor.count(kLongestMessage));
}

template <class Message>
void set_message(const Message& message, mrpt::obs::CObservationGPS& gps) {
  gps.messages[message.message_type].set(new Message(message));
}

/// Of a field that may hold any byte.
bool is_set(const bool& field) {
  unsigned char byte = 0;
  std::memcpy(&byte, &field, 1);
  return byte != 0;
}

/// The fields of a message, which lie in one block.
template <class Message>
Bytes take_block(RecordCursor& cursor) {
  constexpr size_t kSize = sizeof(Message::fields);
  if (cursor.get<uint32_t>() != kSize) throw BadRecord("a GNSS message of another length");
  const unsigned char* const begin = cursor.take(kSize);
  return {begin, begin + kSize};
}

template <class Message>
void read_block(RecordCursor& cursor, mrpt::obs::CObservationGPS& gps) {
  Message message;
  const Bytes block = take_block<Message>(cursor);
  std::memcpy(static_cast<void*>(&message.fields), block.begin, block.size());
  if constexpr (std::is_same_v<Message, gnss::Message_NMEA_GGA>) {
    message.fields.thereis_HDOP = is_set(message.fields.thereis_HDOP);
  }
  set_message(message, gps);
}

/// Messages that we do not use are skipped; most are a block with its length.
void read_message(RecordCursor& cursor, mrpt::obs::CObservationGPS& gps) {
  constexpr size_t kHeader = 28;
  constexpr size_t kShortHeader = 12;
  constexpr size_t kCompressedRange = 24;
  constexpr size_t kComponent = 108;
  switch (cursor.get<int32_t>()) {
    case gnss::NMEA_GGA:
      return read_block<gnss::Message_NMEA_GGA>(cursor, gps);
    case gnss::NMEA_RMC:
      return read_block<gnss::Message_NMEA_RMC>(cursor, gps);
    case gnss::NMEA_VTG:
      return read_block<gnss::Message_NMEA_VTG>(cursor, gps);
    case gnss::NV_OEM6_BESTPOS:
      return read_block<gnss::Message_NV_OEM6_BESTPOS>(cursor, gps);
    case gnss::NV_OEM6_INSPVAS:
      return read_block<gnss::Message_NV_OEM6_INSPVAS>(cursor, gps);
    case gnss::TOPCON_PZS: {
      gnss::Message_TOPCON_PZS pzs;
      read_pzs_position(cursor, pzs);
      read_pzs_extras(cursor, true, pzs);
      return set_message(pzs, gps);
    }
    case gnss::TOPCON_SATS:
      return skip_sats(cursor);
    case gnss::NV_OEM6_GENERIC_FRAME:
      return skip_frame(cursor, kHeader);
    case gnss::NV_OEM6_GENERIC_SHORT_FRAME:
      return skip_frame(cursor, kShortHeader);
    case gnss::NV_OEM6_RANGECMP:
      return skip_list(cursor, kCompressedRange);
    case gnss::NV_OEM6_VERSION:
      return skip_list(cursor, kComponent);
    default:
      cursor.skip(cursor.count(kLongestMessage));
  }
}

GpsExtras read_extras(RecordCursor& cursor, int version) {
  GpsExtras extras;
  if (version >= 12) extras.position_covariance_w = read_optional_covariance(cursor);
  if (version >= 13) {
    extras.kind_of_fix = cursor.get<uint8_t>();
    cursor.skip(sizeof(uint16_t));  // satellite systems
  }
  return extras;
}

void read_messages(RecordCursor& cursor, int version, GpsRecord& gps) {
  gps.timestamp = read_stamp(cursor);
  gps.originalReceivedTimestamp = read_stamp(cursor);
  gps.sensorLabel = cursor.text(kLongestLabel);
  gps.sensorPose = read_pose(cursor);
  gps.has_satellite_timestamp =
      version >= 11 ? cursor.flag() : gps.timestamp != gps.originalReceivedTimestamp;
  static_cast<GpsExtras&>(gps) = read_extras(cursor, version);
  const size_t messages = cursor.count(kMostMessages);
  for (size_t i = 0; i < messages; ++i) read_message(cursor, gps);
}

void read_utc(RecordCursor& cursor, gnss::UTC_time& time) {
  cursor.get(time.hour, time.minute);
  time.sec = cursor.get<double>();
}

void read_old_gga(RecordCursor& cursor, bool with_heights, mrpt::obs::CObservationGPS& gps) {
  gnss::Message_NMEA_GGA gga;
  auto& fields = gga.fields;  // packed: no references to what is in it
  read_utc(cursor, fields.UTCTime);
  fields.latitude_degrees = cursor.get<double>();
  fields.longitude_degrees = cursor.get<double>();
  fields.fix_quality = cursor.get<uint8_t>();
  fields.altitude_meters = cursor.get<double>();
  if (with_heights) {
    fields.geoidal_distance = cursor.get<double>();
    fields.orthometric_altitude = cursor.get<double>();
    fields.corrected_orthometric_altitude = cursor.get<double>();
  }
  fields.satellitesUsed = cursor.get<uint32_t>();
  fields.thereis_HDOP = cursor.flag();
  fields.HDOP = cursor.get<float>();
  set_message(gga, gps);
}

void read_old_rmc(RecordCursor& cursor, mrpt::obs::CObservationGPS& gps) {
  gnss::Message_NMEA_RMC rmc;
  auto& fields = rmc.fields;
  read_utc(cursor, fields.UTCTime);
  fields.validity_char = cursor.get<int8_t>();
  fields.latitude_degrees = cursor.get<double>();
  fields.longitude_degrees = cursor.get<double>();
  fields.speed_knots = cursor.get<double>();
  fields.direction_degrees = cursor.get<double>();
  set_message(rmc, gps);
}

void read_old_pzs(RecordCursor& cursor, int version, mrpt::obs::CObservationGPS& gps) {
  gnss::Message_TOPCON_PZS pzs;
  read_pzs_position(cursor, pzs);
  if (version >= 6) read_pzs_extras(cursor, version >= 8, pzs);
  set_message(pzs, gps);
}

/// Before MRPT 1.4: one field of each kind of message, if it is there. (MRPT 2.5.8 itself uses a
/// PZS of these versions after it has deleted it.)
void read_fields(RecordCursor& cursor, int version, mrpt::obs::CObservationGPS& gps) {
  gps.timestamp = read_stamp(cursor);
  gps.originalReceivedTimestamp = gps.timestamp;
  if (cursor.flag()) read_old_gga(cursor, version >= 9, gps);
  if (cursor.flag()) read_old_rmc(cursor, gps);
  gps.sensorLabel = cursor.text(kLongestLabel);
  gps.sensorPose = version >= 4 ? read_pose(cursor) : mrpt::poses::CPose3D(0, 0, 0, 0, 0, 0);
  if (version >= 5 && cursor.flag()) read_old_pzs(cursor, version, gps);
  if (version >= 7 && cursor.flag()) skip_sats(cursor);
}

}  // namespace

std::string_view without_namespace(std::string_view class_name) {
  const size_t colon = class_name.rfind(':');
  return colon == std::string_view::npos ? class_name : class_name.substr(colon + 1);
}

std::optional<ObjectHeader> read_header(Bytes bytes) {
  if (bytes.size() == 0) throw RecordTooShort();
  const size_t length = bytes.begin[0] & 0x7FU;
  if (bytes.begin[0] < 0x80 || length == 0 || length > kLongestName) return std::nullopt;
  const unsigned char* const name = bytes.begin + 1;
  const unsigned char* const name_end = name + std::min(length, bytes.size() - 1);
  if (!std::all_of(name, name_end, is_name_character)) return std::nullopt;
  if (bytes.size() < length + 2) throw RecordTooShort();
  return ObjectHeader{{reinterpret_cast<const char*>(name), length}, name_end[0], length + 2};
}

bool is_observation_class(std::string_view class_name) {
  constexpr std::string_view kObservation = "CObservation";
  return without_namespace(class_name).substr(0, kObservation.size()) == kObservation;
}

bool is_rawlog_class(std::string_view class_name) {
  const std::string_view name = without_namespace(class_name);
  return is_observation_class(name) || name == "CSensoryFrame" || name == "CActionCollection";
}

const unsigned char* find_end_of_object(const unsigned char* from, Bytes bytes) {
  while (from < bytes.end) {
    const void* const found =
        std::memchr(from, kEndOfObject, static_cast<size_t>(bytes.end - from));
    if (found == nullptr) break;
    const auto* const at = static_cast<const unsigned char*>(found);
    from = at + 1;
    if (begins_rawlog_object({from, bytes.end})) return at;
  }
  return bytes.end;
}

ImuRecord read_imu(RecordCursor& cursor, int version) {
  constexpr int kFixedArrays = 4;  // since version 4, before: vectors
  require_version(version, 0, kFixedArrays);
  ImuRecord record;
  record.pose = walk_pose(cursor);
  size_t count = mrpt::obs::COUNT_IMU_DATA_FIELDS;
  if (version < kFixedArrays) count = cursor.count(kMostImuFields);
  const unsigned char* const present = cursor.take(count);
  record.t_ns = from_mrpt(read_stamp(cursor));
  if (version < kFixedArrays && cursor.count(kMostImuFields) != count) {
    throw BadRecord("its two counts differ");
  }
  const size_t value_size = version == 0 ? sizeof(float) : sizeof(double);
  const unsigned char* const values = cursor.take(count * value_size);
  record.label = cursor.text(kLongestLabel);
  end_of_object(cursor);
  take_values(ImuValues(present, values, count, value_size), version < 2, record);
  return record;
}

mrpt::obs::CObservation::Ptr read_gps(RecordCursor& cursor, int version) {
  constexpr int kFirstWithStamp = 3;
  constexpr int kFirstWithMessages = 10;
  constexpr int kNewest = 13;
  require_version(version, kFirstWithStamp, kNewest);
  auto gps = std::make_shared<GpsRecord>();
  if (version >= kFirstWithMessages) {
    read_messages(cursor, version, *gps);
  } else {
    read_fields(cursor, version, *gps);
  }
  end_of_object(cursor);
  return gps;
}

mrpt::obs::CObservation::Ptr read_odometry(RecordCursor& cursor, int version) {
  require_version(version, 0, 2);
  auto odometry = std::make_shared<mrpt::obs::CObservationOdometry>();
  const int pose_version = nested(cursor, "mrpt::poses::CPose2D");
  require_version(pose_version, 0, 1);
  cursor.skip(3 * (pose_version == 0 ? sizeof(float) : sizeof(double)));
  end_of_object(cursor);
  odometry->sensorLabel = cursor.text(kLongestLabel);
  odometry->timestamp = read_stamp(cursor);
  if (version >= 1) {
    odometry->hasEncodersInfo = cursor.flag();
    if (odometry->hasEncodersInfo || version < 2) {
      cursor.get(odometry->encoderLeftTicks, odometry->encoderRightTicks);
    }
    odometry->hasVelocities = cursor.flag();
    if (version < 2) {
      odometry->velocityLocal.vx = cursor.get<float>();
      odometry->velocityLocal.omega = cursor.get<float>();
    } else if (odometry->hasVelocities) {
      cursor.get(odometry->velocityLocal.vx, odometry->velocityLocal.vy,
                 odometry->velocityLocal.omega);
    }
  }
  end_of_object(cursor);
  return odometry;
}

mrpt::obs::CObservation::Ptr read_robot_pose(RecordCursor& cursor, int version) {
  require_version(version, 0, 1);
  auto pose = std::make_shared<mrpt::obs::CObservationRobotPose>();
  require_version(nested(cursor, "mrpt::poses::CPose3DPDFGaussian"), 1, 1);
  pose->pose.mean = read_pose(cursor);
  read_symmetric(cursor, pose->pose.cov);
  end_of_object(cursor);
  pose->sensorLabel = cursor.text(kLongestLabel);
  pose->timestamp = read_stamp(cursor);
  if (version >= 1) pose->sensorPose = read_pose(cursor);
  end_of_object(cursor);
  return pose;
}

mrpt::obs::CObservation::Ptr read_comment(RecordCursor& cursor, int version) {
  constexpr size_t kLongestComment = size_t{1} << 20;
  require_version(version, 0, 1);
  auto comment = std::make_shared<mrpt::obs::CObservationComment>();
  comment->text = cursor.text(kLongestComment);
  comment->timestamp = read_stamp(cursor);
  if (version >= 1) comment->sensorLabel = cursor.text(kLongestLabel);
  end_of_object(cursor);
  return comment;
}

std::optional<InsRecord> read_ins(RecordCursor& cursor, int version, std::string_view label) {
  constexpr int kOldest = 10, kNewest = 13;  // with messages
  if (version < kOldest || version > kNewest) return std::nullopt;
  RecordCursor at = cursor;
  InsRecord record;
  record.t_ns = from_mrpt(read_stamp(at));
  read_stamp(at);
  record.label = at.text(kLongestLabel);
  if (record.label != label) return std::nullopt;
  record.pose = walk_pose(at);
  if (version >= 11) at.flag();
  read_extras(at, version);
  if (at.count(kMostMessages) != 1 || at.get<int32_t>() != gnss::NV_OEM6_INSPVAS) {
    return std::nullopt;
  }
  record.message = take_block<gnss::Message_NV_OEM6_INSPVAS>(at);
  end_of_object(at);
  cursor = at;
  return record;
}

mrpt::poses::CPose3D pose_of(Bytes pose) { return pose_of(RecordCursor(pose)); }

}  // namespace foucault::rawlog
