#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRawDAQ.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/obs/gnss_messages.h>
#include <zlib.h>

#include <functional>
#include <random>

#include "foucault/rawlog/mrpt_convert.h"
#include "foucault/rawlog/rawlog_source.h"
#include "inflated_file.h"
#include "mrpt_log.h"
#include "mrpt_records.h"
#include "rawlog_stream.h"
#include "scratch.h"

/// Our reading of MRPT's records against MRPT's own, for every version we read. Old versions are
/// written field by field here: MRPT writes only its newest.
namespace foucault::rawlog {
namespace {

using test::gps_at;
using test::imu_at;
using test::Scratch;

constexpr int64_t kBegin = 1'600'000'000'000'000'000;
constexpr int64_t kMs = 1'000'000;

Bytes view(const std::string& bytes) {
  const auto* begin = reinterpret_cast<const unsigned char*>(bytes.data());
  return {begin, begin + bytes.size()};
}

std::string serialized(const mrpt::serialization::CSerializable& object) {
  mrpt::io::CMemoryStream stream;
  mrpt::serialization::archiveFrom(stream).WriteObject(object);
  const auto* data = static_cast<const char*>(stream.getRawBufferData());
  return {data, static_cast<size_t>(stream.getTotalBytesCount())};
}

/// The object and how many bytes MRPT took for it.
template <class Object>
std::pair<std::shared_ptr<Object>, size_t> read_by_mrpt(const std::string& bytes) {
  mrpt::io::CMemoryStream stream;
  stream.Write(bytes.data(), bytes.size());
  stream.Seek(0);
  auto object = mrpt::serialization::archiveFrom(stream).ReadObject<Object>();
  return {object, static_cast<size_t>(stream.getPosition())};
}

/// Fields of an object, one after another.
class Fields {
 public:
  Fields(const std::string& name, int version) {
    add(static_cast<uint8_t>(0x80 | name.size()));
    bytes_ += name;
    add(static_cast<uint8_t>(version));
  }
  template <class T>
  Fields& add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  Fields& text(const std::string& value) {
    add(static_cast<uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  Fields& raw(const std::string& bytes) {
    bytes_ += bytes;
    return *this;
  }
  std::string end() const { return bytes_ + '\x88'; }

 private:
  std::string bytes_;
};

mrpt::poses::CPose3D some_pose() { return {0.1, -0.2, 0.3, 0.4, -0.5, 0.6}; }

std::string pose_object(int version, const std::string& name = "CPose3D") {
  if (version == 3) return serialized(some_pose());
  Fields fields(name, version);
  for (const double value : {0.1, -0.2, 0.3, 0.5, -0.5, 0.5, 0.5}) fields.add(value);
  return fields.end();
}

// IMU -------------------------------------------------------------------------------------------

void expect_as_mrpt_reads(const std::string& bytes) {
  using namespace mrpt::obs;
  const auto [imu, size] = read_by_mrpt<CObservationIMU>(bytes);
  const std::optional<ObjectHeader> header = read_header(view(bytes));
  ASSERT_TRUE(header);
  RecordCursor cursor(view(bytes));
  cursor.skip(header->size);
  const ImuRecord record = read_imu(cursor, header->version);
  EXPECT_EQ(cursor.position(), size);
  EXPECT_EQ(record.label, imu->sensorLabel);
  EXPECT_EQ(record.t_ns, from_mrpt(imu->timestamp));
  const mrpt::poses::CPose3D pose = pose_of(record.pose);
  EXPECT_EQ(pose.getRotationMatrix(), imu->sensorPose.getRotationMatrix());
  EXPECT_EQ(pose.translation(), imu->sensorPose.translation());
  bool complete = true;
  for (const TIMUDataIndex i : {IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC, IMU_WX, IMU_WY, IMU_WZ}) {
    complete = complete && imu->dataIsPresent[i];
  }
  ASSERT_EQ(record.sample.has_value(), complete);
  if (!complete) return;
  const auto& raw = imu->rawMeasurements;
  EXPECT_EQ(record.sample->gyro_b, Eigen::Vector3d(raw[IMU_WX], raw[IMU_WY], raw[IMU_WZ]));
  EXPECT_EQ(record.sample->accel_b,
            Eigen::Vector3d(raw[IMU_X_ACC], raw[IMU_Y_ACC], raw[IMU_Z_ACC]));
}

TEST(ImuRecords, AsMrptWritesThem) {
  std::mt19937 rng{42};
  std::normal_distribution<double> value;
  for (int i = 0; i < 200; ++i) {
    auto imu = imu_at(kBegin + i * kMs, std::string(static_cast<size_t>(i), 'x'));
    imu.sensorPose = mrpt::poses::CPose3D(value(rng), value(rng), value(rng), value(rng),
                                          value(rng), value(rng));
    for (size_t k = 0; k < mrpt::obs::COUNT_IMU_DATA_FIELDS; ++k) {
      imu.rawMeasurements[k] = value(rng);
      imu.dataIsPresent[k] = k < 6 ? i % 10 != static_cast<int>(k) : k % 3 == 0;
    }
    if (i == 7) imu.timestamp = mrpt::system::TTimeStamp();
    expect_as_mrpt_reads(serialized(imu));
  }
}

template <class Value>
std::string old_imu(int version, size_t count, int pose_version, bool with_name_space) {
  const std::string name = "CObservationIMU";
  Fields fields(with_name_space ? "mrpt::obs::" + name : name, version);
  fields.raw(pose_object(pose_version));
  fields.add(static_cast<uint32_t>(count));
  for (size_t i = 0; i < count; ++i) fields.add(static_cast<uint8_t>(i != 8));
  fields.add(test::mrpt_stamp(kBegin).time_since_epoch().count());
  fields.add(static_cast<uint32_t>(count));
  for (size_t i = 0; i < count; ++i) fields.add(static_cast<Value>(0.25 + static_cast<double>(i)));
  return fields.text("xsens").end();
}

TEST(ImuRecords, OfVersions0To3) {
  for (const int pose : {2, 3}) {
    for (const bool with_name_space : {false, true}) {
      for (const size_t count : {15, 21, 31}) {
        expect_as_mrpt_reads(old_imu<float>(0, count, pose, with_name_space));
        expect_as_mrpt_reads(old_imu<double>(1, count, pose, with_name_space));
        expect_as_mrpt_reads(old_imu<double>(2, count, pose, with_name_space));
        expect_as_mrpt_reads(old_imu<double>(3, count, pose, with_name_space));
      }
    }
  }
}

TEST(ImuRecords, RefusedWhereMrptWouldReadBeyond) {
  // MRPT swaps rates of version 1 that are not there.
  std::string few = old_imu<double>(1, 2, 3, true);
  RecordCursor cursor(view(few));
  cursor.skip(read_header(view(few))->size);
  EXPECT_FALSE(read_imu(cursor, 1).sample);
  std::string many = old_imu<double>(3, 21, 3, true);
  const size_t count_at = many.find('\x88') + 1;
  many[count_at + 3] = '\x7F';
  RecordCursor hostile(view(many));
  hostile.skip(read_header(view(many))->size);
  EXPECT_THROW(read_imu(hostile, 3), BadRecord);
  EXPECT_THROW(read_imu(hostile, 5), UnknownVersion);
}

// GNSS, odometry, poses -------------------------------------------------------------------------

using Reader = mrpt::obs::CObservation::Ptr (*)(RecordCursor&, int);

/// Without the messages that our reader skips.
std::string what_we_keep(mrpt::obs::CObservation& observation) {
  using namespace mrpt::obs::gnss;
  if (auto* gps = dynamic_cast<mrpt::obs::CObservationGPS*>(&observation)) {
    for (auto it = gps->messages.begin(); it != gps->messages.end();) {
      const bool kept = it->first == NMEA_GGA || it->first == NMEA_RMC || it->first == NMEA_VTG ||
                        it->first == NV_OEM6_BESTPOS || it->first == NV_OEM6_INSPVAS ||
                        it->first == TOPCON_PZS;
      it = kept ? std::next(it) : gps->messages.erase(it);
    }
  }
  if (auto* odometry = dynamic_cast<mrpt::obs::CObservationOdometry*>(&observation)) {
    odometry->odometry = {};
  }
  return serialized(observation);
}

mrpt::obs::CObservation::Ptr read_all(const std::string& bytes, Reader read) {
  const ObjectHeader header = read_header(view(bytes)).value();
  const std::string more = bytes + std::string(100, '\0');
  RecordCursor cursor(view(more));
  cursor.skip(header.size);
  auto object = read(cursor, header.version);
  EXPECT_EQ(cursor.position(), bytes.size());
  return object;
}

/// Whatever piece of the record is there, we say that it is too short.
void expect_pieces_too_short(const std::string& bytes, Reader read) {
  const ObjectHeader header = read_header(view(bytes)).value();
  for (size_t cut = header.size; cut < bytes.size(); ++cut) {
    const std::string piece = bytes.substr(0, cut);
    RecordCursor broken(view(piece));
    broken.skip(header.size);
    EXPECT_THROW(read(broken, header.version), RecordTooShort) << cut;
  }
}

void expect_as_mrpt_reads(const std::string& bytes, Reader read) {
  const auto [theirs, size] = read_by_mrpt<mrpt::obs::CObservation>(bytes);
  EXPECT_EQ(size, bytes.size());
  const auto ours = read_all(bytes, read);
  EXPECT_EQ(what_we_keep(*ours), what_we_keep(*theirs));
  expect_pieces_too_short(bytes, read);
}

mrpt::obs::CObservationGPS empty_gps() {
  auto gps = gps_at(kBegin);
  gps.messages.clear();
  gps.sensorPose = some_pose();
  return gps;
}

template <class Message>
Message message() {
  return Message();
}
template <>
mrpt::obs::gnss::Message_TOPCON_SATS message() {
  mrpt::obs::gnss::Message_TOPCON_SATS sats;
  sats.USIs = {1, 2, 3};
  sats.ELs = {4, 5, 6};
  sats.AZs = {7, 8, 9};
  return sats;
}
template <class Message>
void expect_message() {
  auto gps = empty_gps();
  gps.setMsg(message<Message>());
  gps.setMsg(test::gga());
  SCOPED_TRACE(static_cast<int>(Message::msg_type));
  expect_as_mrpt_reads(serialized(gps), read_gps);
}

/// Of messages that do not name their kind.
template <class Message>
void expect_message_of(mrpt::obs::gnss::gnss_message_type_t kind) {
  auto gps = empty_gps();
  gps.messages[kind].set(new Message(message<Message>()));
  gps.setMsg(test::gga());
  SCOPED_TRACE(kind);
  expect_as_mrpt_reads(serialized(gps), read_gps);
}

TEST(GpsRecords, EveryKindOfMessage) {
  using namespace mrpt::obs::gnss;
  expect_message<Message_NMEA_GGA>();
  expect_message<Message_NMEA_GSA>();
  expect_message<Message_NMEA_RMC>();
  expect_message<Message_NMEA_ZDA>();
  expect_message<Message_NMEA_VTG>();
  expect_message<Message_NMEA_GLL>();
  expect_message<Message_TOPCON_PZS>();
  expect_message<Message_TOPCON_SATS>();
  expect_message<Message_NV_OEM6_BESTPOS>();
  expect_message<Message_NV_OEM6_INSPVAS>();
  expect_message<Message_NV_OEM6_RXSTATUS>();
  expect_message<Message_NV_OEM6_RAWEPHEM>();
  expect_message<Message_NV_OEM6_RAWIMUS>();
  expect_message<Message_NV_OEM6_MARKPOS>();
  expect_message<Message_NV_OEM6_MARKTIME>();
  expect_message<Message_NV_OEM6_MARK2TIME>();
  expect_message<Message_NV_OEM6_IONUTC>();
  expect_message_of<Message_NV_OEM6_GENERIC_FRAME>(NV_OEM6_GENERIC_FRAME);
  expect_message_of<Message_NV_OEM6_GENERIC_SHORT_FRAME>(NV_OEM6_GENERIC_SHORT_FRAME);
}

/// NovAtel logs of a variable length. By hand: MRPT keeps them in packed structs with a misaligned
/// vector in it.
TEST(GpsRecords, NovatelLists) {
  using namespace mrpt::obs::gnss;
  for (const auto& [kind, element] :
       {std::pair(NV_OEM6_RANGECMP, 24), std::pair(NV_OEM6_VERSION, 108)}) {
    Fields fields("mrpt::obs::CObservationGPS", 11);
    fields.add(int64_t{1}).add(int64_t{1}).text("gps").raw(pose_object(3)).add(uint8_t{0});
    fields.add(uint32_t{1}).add(static_cast<int32_t>(kind)).add(uint32_t{32});
    fields.raw(std::string(28, 'h')).add(uint32_t{3}).raw(std::string(3 * element, 'e'));
    EXPECT_TRUE(read_all(fields.end(), read_gps));
    expect_pieces_too_short(fields.end(), read_gps);
  }
}

TEST(GpsRecords, Version10) {
  const std::string newest = serialized(gps_at(kBegin));
  const size_t pose_end = newest.find('\x88', newest.find("CPose3D")) + 1;
  std::string bytes = newest.substr(0, pose_end) + newest.substr(pose_end + 1);
  bytes[bytes.find("CObservationGPS") + 15] = 10;
  expect_as_mrpt_reads(bytes, read_gps);
}

/// As MRPT from 2.11.12 (version 12) and 2.15 (version 13) on writes them: github.com/MRPT/mrpt,
/// CObservationGPS.cpp, optional_serialization.h, CMatrixD.cpp.
std::string new_gps(int version, bool with_covariance, int fix_type) {
  const std::string of_11 = serialized(gps_at(kBegin));
  const size_t pose_end = of_11.find('\x88', of_11.find("CPose3D")) + 1;
  Fields more("x", 0);
  more.text("std::optional").text("CMatrixFixed<double,3,3>").add(uint8_t{with_covariance});
  if (with_covariance) {
    Fields matrix("mrpt::math::CMatrixD", 0);
    matrix.add(uint32_t{3}).add(uint32_t{3});
    for (const double value : {4.0, 0.5, 0.25, 0.5, 9.0, -0.75, 0.25, -0.75, 16.0}) {
      matrix.add(value);
    }
    more.raw(matrix.end());
  }
  if (version >= 13) more.add(static_cast<uint8_t>(fix_type)).add(uint16_t{9});
  const std::string fields = more.end().substr(3);  // without its header
  std::string bytes = of_11.substr(0, pose_end + 1) + fields.substr(0, fields.size() - 1) +
                      of_11.substr(pose_end + 1);
  bytes[bytes.find("CObservationGPS") + 15] = static_cast<char>(version);
  return bytes;
}

TEST(GpsRecords, Versions12And13) {
  for (const int version : {12, 13}) {
    for (const bool with_covariance : {false, true}) {
      const std::string bytes = new_gps(version, with_covariance, GpsRecord::kRtkFloat);
      const auto read = std::dynamic_pointer_cast<GpsRecord>(read_all(bytes, read_gps));
      ASSERT_TRUE(read);
      EXPECT_EQ(read->kind_of_fix, version == 13 ? GpsRecord::kRtkFloat : GpsRecord::kUnknown);
      EXPECT_EQ(read->position_covariance_w.has_value(), with_covariance);
      EXPECT_EQ(read->messages.size(), 1U);
      const GnssFix fix = decode_fix(*read, kBegin).value();
      EXPECT_EQ(fix.quality, version == 13 ? FixQuality::float_rtk : FixQuality::fixed_rtk);
      if (with_covariance) {  // east, north, up to north, east, down
        const Eigen::Matrix3d expected =
            (Eigen::Matrix3d() << 9, 0.5, 0.75, 0.5, 4, -0.25, 0.75, -0.25, 16).finished();
        EXPECT_EQ(fix.position_covariance, expected);
      } else {
        EXPECT_LT(fix.position_covariance(0, 0), 1);
      }
      expect_pieces_too_short(bytes, read_gps);
    }
  }
  const std::string no_fix = new_gps(13, false, GpsRecord::kNoFix);
  const auto read = std::dynamic_pointer_cast<GpsRecord>(read_all(no_fix, read_gps));
  EXPECT_FALSE(decode_fix(*read, kBegin));
  EXPECT_THROW(read_all(new_gps(14, false, 0), read_gps), UnknownVersion);
}

std::string float_matrix() {
  Fields matrix("CMatrixF", 0);
  matrix.add(uint32_t{4}).add(uint32_t{4});
  for (int i = 0; i < 16; ++i) matrix.add(0.5F);
  return matrix.end();
}

void add_pzs(int version, Fields& fields) {
  for (int i = 0; i < 4; ++i) fields.add(1.5);
  fields.add(0.5F).add(0.25);
  for (int i = 0; i < 5; ++i) fields.add(uint8_t{1});
  if (version < 6) return;
  fields.add(uint8_t{1});
  for (int i = 0; i < 6; ++i) fields.add(2.5);
  fields.add(uint8_t{1}).raw(float_matrix()).add(uint8_t{1}).raw(float_matrix());
  fields.add(uint8_t{1}).add(uint8_t{7}).add(uint8_t{8});
  if (version >= 8) fields.add(uint8_t{9});
}

/// Before the messages of version 10.
std::string old_gps(int version, bool with_nmea, bool with_topcon) {
  const auto there = static_cast<uint8_t>(with_nmea);
  const auto topcon = static_cast<uint8_t>(with_topcon);
  Fields fields("CObservationGPS", version);
  fields.add(test::mrpt_stamp(kBegin).time_since_epoch().count());
  fields.add(there);
  if (with_nmea) {
    fields.add(uint8_t{10}).add(uint8_t{11}).add(12.5).add(47.5).add(8.25).add(uint8_t{4});
    for (int i = 0; i < (version >= 9 ? 4 : 1); ++i) fields.add(400.0 + i);
    fields.add(uint32_t{9}).add(uint8_t{1}).add(0.75F);
  }
  fields.add(there);
  if (with_nmea) {
    fields.add(uint8_t{10}).add(uint8_t{11}).add(12.5).add('A');
    for (int i = 0; i < 4; ++i) fields.add(3.5 + i);
  }
  fields.text("gps");
  if (version >= 4) fields.raw(pose_object(2));
  if (version >= 5) fields.add(topcon);
  if (version >= 5 && with_topcon) add_pzs(version, fields);
  if (version >= 7) fields.add(topcon);
  if (version >= 7 && with_topcon) {
    fields.text("usi").text("elv").add(uint32_t{2}).add(int16_t{1}).add(int16_t{2});
  }
  return fields.end();
}

TEST(GpsRecords, OfVersions3To9) {
  for (int version = 3; version <= 9; ++version) {
    SCOPED_TRACE(version);
    // Of these MRPT makes an empty message of satellites, which we do not keep.
    expect_as_mrpt_reads(old_gps(version, true, false), read_gps);
    expect_as_mrpt_reads(old_gps(version, false, false), read_gps);
  }
}

/// MRPT 2.5.8 reads them into memory it has freed; so against what was written.
TEST(GpsRecords, TopconOfVersions5To9) {
  for (int version = 5; version <= 9; ++version) {
    SCOPED_TRACE(version);
    const std::string bytes = old_gps(version, true, true);
    const auto read =
        std::dynamic_pointer_cast<mrpt::obs::CObservationGPS>(read_all(bytes, read_gps));
    const auto& pzs = read->getMsgByClass<mrpt::obs::gnss::Message_TOPCON_PZS>();
    EXPECT_EQ(pzs.latitude_degrees, 1.5);
    EXPECT_EQ(pzs.PSigma, 0.5F);
    EXPECT_EQ(pzs.hasPosCov, version >= 6);
    EXPECT_EQ(pzs.vel_covariance(3, 3), version >= 6 ? 0.5F : 0.0F);
    EXPECT_EQ(pzs.stats_rtk_fix_progress, version >= 8 ? 9 : 0);
    expect_pieces_too_short(bytes, read_gps);
  }
}

/// MRPT 2.5.8 writes what it cannot read again.
TEST(GpsRecords, NovatelFramesWithABody) {
  mrpt::obs::gnss::Message_NV_OEM6_GENERIC_FRAME frame;
  frame.msg_body = {1, 2, 3, 4, 5};
  auto gps = empty_gps();
  gps.messages[frame.message_type].set(new mrpt::obs::gnss::Message_NV_OEM6_GENERIC_FRAME(frame));
  gps.setMsg(test::gga());
  const std::string bytes = serialized(gps);
  EXPECT_TRUE(read_all(bytes, read_gps));
  expect_pieces_too_short(bytes, read_gps);
}

TEST(CommentRecords, AsMrptWritesThem) {
  mrpt::obs::CObservationComment comment;
  comment.text = "a text";
  comment.sensorLabel = "label";
  comment.timestamp = test::mrpt_stamp(kBegin);
  expect_as_mrpt_reads(serialized(comment), read_comment);
}

TEST(OdometryRecords, OfEveryVersion) {
  for (const bool encoders : {false, true}) {
    for (const bool velocities : {false, true}) {
      mrpt::obs::CObservationOdometry odometry;
      odometry.sensorLabel = "wheels";
      odometry.hasEncodersInfo = encoders;
      odometry.hasVelocities = velocities;
      expect_as_mrpt_reads(serialized(odometry), read_odometry);
    }
  }
  const auto old = [](int version, int pose_version) {
    Fields pose("CPose2D", pose_version);
    for (int i = 0; i < 3; ++i) {
      if (pose_version == 0) pose.add(0.5F);
      if (pose_version == 1) pose.add(0.5);
    }
    Fields fields("CObservationOdometry", version);
    fields.raw(pose.end()).text("wheels").add(int64_t{1});
    if (version == 1) {
      fields.add(uint8_t{1}).add(int32_t{1}).add(int32_t{2}).add(uint8_t{1}).add(1.0F).add(2.0F);
    }
    return fields.end();
  };
  for (const int version : {0, 1}) {
    for (const int pose_version : {0, 1}) {
      expect_as_mrpt_reads(old(version, pose_version), read_odometry);
    }
  }
}

TEST(RobotPoseRecords, OfEveryVersion) {
  mrpt::obs::CObservationRobotPose pose;
  pose.sensorLabel = "REFERENCE";
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column <= row; ++column)
      pose.pose.cov(row, column) = pose.pose.cov(column, row) = 10 * row + column;
  }
  const std::string newest = serialized(pose);
  expect_as_mrpt_reads(newest, read_robot_pose);
  std::string old = newest.substr(0, newest.size() - 1 - pose_object(3).size()) + '\x88';
  old[old.find("CObservationRobotPose") + 21] = 0;
  expect_as_mrpt_reads(old, read_robot_pose);
}

// Records that nobody needs ---------------------------------------------------------------------

/// Objects of other classes, whose contents are full of what looks like ends.
std::vector<mrpt::serialization::CSerializable::Ptr> foreign_objects() {
  auto comment = std::make_shared<mrpt::obs::CObservationComment>();
  comment->text = std::string(300, '\x88') + "\x88\x8EmrptCObservation";
  auto daq = std::make_shared<mrpt::obs::CObservationRawDAQ>();  // larger than the reader's window
  daq->AIN_8bits.assign(500'000, 0x88);
  auto scan = std::make_shared<mrpt::obs::CObservation2DRangeScan>();
  scan->resizeScanAndAssign(361, 5.0F, true);
  auto image = std::make_shared<mrpt::obs::CObservationImage>();
  image->image.resize(64, 48, mrpt::img::CH_GRAY);
  return {comment, daq, scan, image};
}

TEST(ForeignRecords, AreSteppedOverByTheirEnd) {
  const Scratch scratch;
  mrpt::obs::CActionCollection actions;
  actions.insert(mrpt::obs::CActionRobotMovement2D());
  {
    test::PlainLog log(scratch.path("a.rawlog"));
    for (const auto& object : foreign_objects()) {
      log.write(*object);
      log.write(imu_at(kBegin));
      log.write(*object);
      log.write(*object);
      log.write(actions);
      log.write(gps_at(kBegin));
    }
    log.write(actions);
  }
  RawlogStream stream(scratch.path("a.rawlog"));
  std::map<std::string, int> found;
  while (const std::optional<LoggedObservation> logged = stream.next()) {
    ++found[std::string(logged->type)];
  }
  EXPECT_EQ(stream.damage(), std::nullopt);
  EXPECT_EQ(stream.records(), 25);
  EXPECT_EQ(stream.other_records().at("CActionCollection"), 5);
  const std::map<std::string, int> expected{
      {"CObservationIMU", 4},    {"CObservationGPS", 4},         {"CObservationComment", 3},
      {"CObservationRawDAQ", 3}, {"CObservation2DRangeScan", 3}, {"CObservationImage", 3}};
  EXPECT_EQ(found, expected);
}

TEST(ForeignRecords, InSensoryFramesToo) {
  const Scratch scratch;
  const auto objects = foreign_objects();
  {
    test::PlainLog log(scratch.path("a.rawlog"));
    for (size_t i = 0; i < 3 * objects.size(); ++i) {
      const auto object =
          std::dynamic_pointer_cast<mrpt::obs::CObservation>(objects[i % objects.size()]);
      mrpt::obs::CSensoryFrame frame;
      if (i < objects.size()) frame.insert(object);
      frame.insert(std::make_shared<mrpt::obs::CObservationIMU>(imu_at(kBegin)));
      if (i % 2 == 0) frame.insert(object);
      frame.insert(std::make_shared<mrpt::obs::CObservationGPS>(gps_at(kBegin)));
      if (i >= 2 * objects.size()) frame.insert(object);
      log.write(frame);
    }
  }
  RawlogStream stream(scratch.path("a.rawlog"));
  int imu = 0;
  int gps = 0;
  int foreign = 0;
  while (const std::optional<LoggedObservation> logged = stream.next()) {
    EXPECT_TRUE(logged->in_frame);
    EXPECT_EQ(logged->record, stream.records() + (logged->record > stream.records() ? 1 : 0));
    if (logged->imu) {
      ++imu;
    } else if (logged->observation) {
      ++gps;
    } else {
      ++foreign;
    }
  }
  EXPECT_EQ(stream.damage(), std::nullopt);
  EXPECT_EQ(stream.records(), 12);
  EXPECT_EQ(imu, 12);
  EXPECT_EQ(gps, 12);
  EXPECT_EQ(foreign, 14);
}

TEST(ForeignRecords, CutOffAreTruncated) {
  const Scratch scratch;
  const std::string begin = serialized(imu_at(kBegin));
  const std::string foreign = Fields("CObservationOther", 3).text(std::string(200'000, 'x')).end();
  for (const size_t cut : {size_t{19}, foreign.size() / 2, foreign.size() - 1}) {
    const std::string path = scratch.text_file("cut.rawlog", begin + foreign.substr(0, cut));
    RawlogStream stream(path);
    EXPECT_TRUE(stream.next());
    EXPECT_FALSE(stream.next());
    ASSERT_TRUE(stream.damage());
    EXPECT_THAT(*stream.damage(), ::testing::HasSubstr("is truncated"));
  }
}

// The file --------------------------------------------------------------------------------------

std::string all_of(const std::string& path) {
  InflatedFile file(path);
  std::string contents;
  while (true) {
    const Bytes window = file.window();
    if (window.size() == 0) return contents;
    const size_t count = std::min<size_t>(window.size(), 12'345);
    contents.append(reinterpret_cast<const char*>(window.begin), count);
    file.advance(count);
    EXPECT_EQ(file.offset(), contents.size());
  }
}

std::string some_bytes(size_t size) {
  std::mt19937 rng{42};
  std::string bytes(size, ' ');
  for (char& c : bytes) c = static_cast<char>(rng() & 0xF);
  return bytes;
}

std::string gzipped(const Scratch& scratch, const std::string& contents) {
  const std::string path = scratch.path("part.gz");
  const gzFile file = gzopen(path.c_str(), "wb");
  gzwrite(file, contents.data(), static_cast<unsigned>(contents.size()));
  gzclose(file);
  return test::contents(path);
}

TEST(InflatedFiles, PlainCompressedAndInPieces) {
  const Scratch scratch;
  const std::string bytes = some_bytes(1'000'000);
  EXPECT_EQ(all_of(scratch.text_file("plain", bytes)), bytes);
  EXPECT_EQ(all_of(scratch.text_file("whole", gzipped(scratch, bytes))), bytes);
  const std::string pieces =
      gzipped(scratch, bytes.substr(0, 300'000)) + gzipped(scratch, bytes.substr(300'000));
  EXPECT_EQ(all_of(scratch.text_file("pieces", pieces)), bytes);
  EXPECT_EQ(all_of(scratch.text_file("padded", pieces + std::string(512, '\0'))), bytes);
}

TEST(InflatedFiles, TellTheirEnd) {
  const Scratch scratch;
  const std::string packed = gzipped(scratch, some_bytes(200'000));
  const auto end = [&](const std::string& bytes) {
    InflatedFile file(scratch.text_file("f", bytes));
    while (const size_t size = file.window().size()) file.advance(size);
    return file.end();
  };
  EXPECT_EQ(end(packed), InflatedFile::End::clean);
  EXPECT_EQ(end(packed.substr(0, packed.size() - 3)), InflatedFile::End::truncated);
  std::string wrong = packed;
  wrong[wrong.size() - 7] ^= 1;
  EXPECT_EQ(end(wrong), InflatedFile::End::damaged);
}

/// What zlib gives out of a gzip file of one member, whole or not.
std::string by_zlib(std::string packed) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 16 + MAX_WBITS), Z_OK);
  stream.next_in = reinterpret_cast<unsigned char*>(packed.data());
  stream.avail_in = static_cast<unsigned>(packed.size());
  std::string bytes;
  std::string piece(1000, ' ');
  int result = Z_OK;
  while (result == Z_OK) {
    stream.next_out = reinterpret_cast<unsigned char*>(piece.data());
    stream.avail_out = static_cast<unsigned>(piece.size());
    result = inflate(&stream, Z_NO_FLUSH);
    bytes.append(piece, 0, piece.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return bytes;
}

TEST(InflatedFiles, GiveOutWhatIsBeforeABreakToTheLastByte) {
  const Scratch scratch;
  const std::string packed = gzipped(scratch, some_bytes(400'000));
  for (const size_t at : {100, 5'000, 70'000, 150'000}) {
    const std::string cut = packed.substr(0, at);
    EXPECT_EQ(all_of(scratch.text_file("f", cut)), by_zlib(cut)) << at;
    std::string wrong = packed;
    for (size_t i = at; i < at + 64; ++i) wrong[i] = '\xFF';
    EXPECT_EQ(all_of(scratch.text_file("f", wrong)), by_zlib(wrong)) << at;
  }
}

}  // namespace
}  // namespace foucault::rawlog
