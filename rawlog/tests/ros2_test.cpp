#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "foucault/core/constants.h"
#include "foucault/rawlog/import_bag.h"
#include "foucault/rawlog/rawlog_source.h"
#include "ros_bytes.h"
#include "ros_layout.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::Cdr;
using test::error_of;
using test::packed;
using test::part;
using test::Scratch;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Bytes bytes_of(const std::string& text) {
  const auto* const begin = reinterpret_cast<const unsigned char*>(text.data());
  return {begin, begin + text.size()};
}

// Layouts of CDR ---------------------------------------------------------------------------------

RosType cdr_type(const std::string& definition) {
  return {"my/msg/Type", definition, RosEncoding::cdr};
}

TEST(CdrLayout, NumbersStandAtMultiplesOfTheirSize) {
  RosLayout layout(cdr_type("bool a\nfloat64 b\nuint8 c\nint16 d\nstring e\nint64 f\nfloat32 g\n"));
  for (const char* name : {"a", "b", "c", "d", "f", "g"}) ASSERT_TRUE(layout.want(name));
  for (const bool big_endian : {false, true}) {
    const std::string message = Cdr(big_endian)
                                    .put(uint8_t{1}, 2.5, uint8_t{3}, int16_t{-4})
                                    .put("abcd")
                                    .put(int64_t{-5}, 6.5F)
                                    .bytes();
    EXPECT_THAT(layout.read(bytes_of(message)), ElementsAre(1, 2.5, 3, -4, -5, 6.5));
    EXPECT_THROW(layout.read(bytes_of(message.substr(0, message.size() - 1))), RecordTooShort);
  }
}

/// Bounds, defaults, constants, sequences, types of the same package and empty ones.
TEST(CdrLayout, WhatDefinitionsOfRos2Say) {
  RosLayout layout(cdr_type(
      "uint8 KIND=3\nstring NAME = \"a b\"\nstring<=10 text \"x=y\" # why\nint32[<=3] few\n"
      "int32 count 5\nEmpty nothing\nOther[2] pairs\nother_pkg/Other foreign\nfloat64 last\n"
      "===\nMSG: my/Empty\n===\nMSG: my/Other\nint8 a\nint32 b\n===\nMSG: other_pkg/Other\n"
      "float64[] many\nbuiltin_interfaces/Time t\n"));
  EXPECT_FALSE(layout.want("few"));
  EXPECT_FALSE(layout.want("KIND"));
  EXPECT_TRUE(layout.has("text"));
  ASSERT_TRUE(layout.want("count"));
  ASSERT_TRUE(layout.want("foreign.t.nanosec"));
  ASSERT_TRUE(layout.want("last"));
  Cdr message;
  message.put("hello").put(uint32_t{2}, 7, 8, 5, uint8_t{0});
  message.put(int8_t{1}, 10, int8_t{2}, 20);     // pairs
  message.put(uint32_t{0}, 100, uint32_t{200});  // no numbers, so no gap before the time
  EXPECT_THAT(layout.read(bytes_of(message.put(0.5).bytes())), ElementsAre(5, 200, 0.5));
}

TEST(CdrLayout, WhatCannotBeReadIsRefused) {
  EXPECT_THROW(RosLayout({"my/msg/Type", "", RosEncoding::cdr}), BadRecord);
  EXPECT_THROW(RosLayout({"sensor_msgs/Imu", "", RosEncoding::ros1}), BadRecord);
  EXPECT_THROW(RosLayout({"sensor_msgs/msg/Imu", "", RosEncoding::unknown}), BadRecord);
  EXPECT_THROW(RosLayout(cdr_type("wstring a\n")), BadRecord);
  EXPECT_THROW(RosLayout(cdr_type("Type again\n")), BadRecord);
  EXPECT_THROW(RosLayout(cdr_type("int8[x] a\n")), BadRecord);
  const RosLayout layout(cdr_type("int32[] a\n"));
  EXPECT_THROW(layout.read(bytes_of("\0\7\0\0")), RecordTooShort);
  EXPECT_THROW(layout.read(bytes_of(packed(0x0300U, 0U))), BadRecord);  // a list of parameters
  EXPECT_THROW(layout.read(bytes_of(Cdr().put(uint32_t{1000}).bytes())), BadRecord);
}

/// A message as a DDS of ROS 2 Crystal wrote it, by the definition that is built in.
/// From examples/sample.db3 of github.com/klintan/rosbag2.js, topic /imu.
TEST(CdrLayout, ARealMessage) {
  const std::string hex =
      "00010000452F975C00FB58040E000000626173655F696D755F6C696E6B00000000000000665866BBEDE068BF"
      "1B605F20F04BEABFE0A27750313BE23F9892B834164384BF7B14AE47E17A643F000000000000000000000000"
      "0000000000000000000000007B14AE47E17A643F000000000000000000000000000000000000000000000000"
      "7B14AE47E17A643F0000000000000000000000000000000000000000000000007B14AE47E17A943F00000000"
      "00000000000000000000000000000000000000007B14AE47E17A943F00000000000000000000000000000000"
      "00000000000000007B14AE47E17A943F0000000000000000000000000000000000000000000000007B14AE47"
      "E17AA43F0000000000000000000000000000000000000000000000007B14AE47E17AA43F0000000000000000"
      "000000000000000000000000000000007B14AE47E17AA43F";
  std::string message;
  for (size_t i = 0; i < hex.size(); i += 2) {
    message += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  }
  RosLayout layout({"sensor_msgs/Imu", "", RosEncoding::cdr});
  layout.want("header.stamp.sec");
  const size_t y = *layout.want("orientation.y");
  const size_t gyro = *layout.want("angular_velocity_covariance", 9);
  const size_t accel = *layout.want("linear_acceleration_covariance", 9);
  const std::vector<double> values = layout.read(bytes_of(message));
  EXPECT_EQ(values[0], 1553411909);
  EXPECT_NEAR(values[y], -0.8217698, 1e-7);
  EXPECT_EQ(values[gyro + 8], 0.02);
  EXPECT_EQ(values[accel + 4], 0.04);
  EXPECT_EQ(values[accel + 8], 0.04);
}

// Recordings -------------------------------------------------------------------------------------

const std::string kHeaderType =
    "================\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const std::string kImuType =
    "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
    "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
    "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
    "float64[9] linear_acceleration_covariance\n" +
    kHeaderType +
    "================\nMSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\n"
    "float64 w 1\n================\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
const std::string kFixType =
    "std_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
    "float64 altitude\nfloat64[9] position_covariance\nuint8 COVARIANCE_TYPE_UNKNOWN=0\n"
    "uint8 position_covariance_type\n" +
    kHeaderType +
    "================\nMSG: sensor_msgs/NavSatStatus\nint8 STATUS_UNKNOWN = -2\nint8 status -2\n"
    "uint16 service\n";

constexpr int64_t kStart = 1'650'000'000'000'000'000;
constexpr std::array<double, 9> kNone{};

Cdr header(int64_t t_ns, const std::string& frame = "imu", bool big_endian = false) {
  Cdr cdr(big_endian);
  cdr.put(static_cast<int32_t>(t_ns / 1'000'000'000), static_cast<uint32_t>(t_ns % 1'000'000'000));
  return cdr.put(frame);
}

std::string imu_message(int64_t t_ns, bool big_endian = false) {
  return header(t_ns, "imu", big_endian)
      .put(0.0, 0.0, 0.0, 1.0)
      .put(kNone)
      .put(0.1, 0.2, 0.3)
      .put(kNone)
      .put(1.0, 2.0, 9.8)
      .put(kNone)
      .bytes();
}

std::string fix_message(int64_t t_ns, int8_t status = 0, uint8_t covariance_type = 3) {
  // east, north, up
  const std::array<double, 9> covariance{4.0, 0.5, 0.25, 0.5, 9.0, 0.75, 0.25, 0.75, 16.0};
  return header(t_ns, "gps")
      .put(status, uint16_t{1}, 48.5, 9.25, 321.5)
      .put(covariance)
      .put(covariance_type)
      .bytes();
}

std::string zstd(const std::string& plain) {
  std::string bytes(ZSTD_compressBound(plain.size()), '\0');
  bytes.resize(ZSTD_compress(bytes.data(), bytes.size(), plain.data(), plain.size(), 3));
  return bytes;
}

struct Topic {
  uint16_t id;
  std::string name, type, definition;
  std::string encoding = "cdr";
};
struct Message {
  uint16_t topic;
  int64_t recorded_ns;
  std::string bytes;
};

std::vector<Topic> topics() {
  return {{1, "/imu", "sensor_msgs/msg/Imu", kImuType},
          {2, "/fix", "sensor_msgs/msg/NavSatFix", kFixType}};
}

/// 100 Hz and 4 Hz over a second.
std::vector<Message> drive(int64_t from_ns = kStart) {
  std::vector<Message> messages;
  for (int i = 0; i < 100; ++i) {
    const int64_t t_ns = from_ns + 10'000'000 * i;
    messages.push_back({1, t_ns + 2'000'000, imu_message(t_ns)});
    if (i % 25 == 5) {
      messages.push_back(
          {2, t_ns + 2'000'000, fix_message(t_ns, i == 80 ? int8_t{-1} : int8_t{0})});
    }
  }
  return messages;
}

class Ros2 : public ::testing::Test {
 protected:
  Ros2() {
    options_.bag = scratch_.path("drive");
    options_.out = scratch_.path("out.rawlog");
  }

  void expect_drive() {
    const ImportSummary summary = import_bag(options_);
    EXPECT_EQ(summary.imu.written, 100);
    EXPECT_EQ(summary.gnss.written, 3);
    EXPECT_EQ(summary.gnss.without_fix, 1);
    EXPECT_THAT(summary.imu.notices, IsEmpty());
    EXPECT_THAT(summary.gnss.notices, IsEmpty());
  }
  std::string data_error() {
    std::filesystem::remove(options_.out);
    const std::string what = error_of<DataError>([&] { import_bag(options_); });
    EXPECT_FALSE(std::filesystem::exists(options_.out));
    return what;
  }
  std::string usage_error() {
    return error_of<UsageError>([&] { import_bag(options_); });
  }
  /// Skipping what is damaged.
  ImportSummary rest() {
    options_.skip_bad_rows = true;
    const ImportSummary summary = import_bag(options_);
    options_.skip_bad_rows = false;
    return summary;
  }
  template <class Kind>
  std::vector<Kind> all() {
    RawlogSource source(options_.out);
    mounting_ = source.mounting();
    std::vector<Kind> found;
    while (const std::optional<Measurement> m = source.next()) {
      if (const Kind* one = std::get_if<Kind>(&*m)) found.push_back(*one);
    }
    return found;
  }

  Scratch scratch_;
  BagImport options_;
  state::Mounting mounting_;
};

// MCAP -------------------------------------------------------------------------------------------

const std::string kMcapMagic("\x89MCAP0\r\n", 8);

std::string mcap_record(uint8_t op, const std::string& content) {
  return packed(op, static_cast<uint64_t>(content.size())) + content;
}
std::string mcap_schema(const Topic& topic) {
  return mcap_record(
      3, packed(topic.id) + part(topic.type) + part("ros2msg") + part(topic.definition));
}
std::string mcap_channel(const Topic& topic) {
  return mcap_record(4, packed(topic.id, topic.id) + part(topic.name) + part(topic.encoding) +
                            part(part("key") + part("value")));
}
std::string mcap_message(const Message& m) {
  const auto logged = static_cast<uint64_t>(m.recorded_ns);
  return mcap_record(5, packed(m.topic, 1U, logged, uint64_t{77}) + m.bytes);
}
std::string mcap_records(const std::vector<Topic>& topics, const std::vector<Message>& messages) {
  std::string records;
  for (const Topic& topic : topics) records += mcap_schema(topic) + mcap_channel(topic);
  for (const Message& message : messages) records += mcap_message(message);
  return records;
}

uint32_t crc(const std::string& bytes) {
  return static_cast<uint32_t>(crc32(0, reinterpret_cast<const unsigned char*>(bytes.data()),
                                     static_cast<uInt>(bytes.size())));
}

std::string lz4(const std::string& plain) {
  std::string bytes(LZ4F_compressFrameBound(plain.size(), nullptr), '\0');
  bytes.resize(LZ4F_compressFrame(bytes.data(), bytes.size(), plain.data(), plain.size(), nullptr));
  return bytes;
}

std::string mcap_chunk(const std::string& compression, const std::string& records, int wrong = 0) {
  const std::string packed_records = compression == "lz4"    ? lz4(records)
                                     : compression == "zstd" ? zstd(records)
                                                             : records;
  return mcap_record(6, packed(uint64_t{0}, uint64_t{0}, static_cast<uint64_t>(records.size()),
                               crc(records) + static_cast<uint32_t>(wrong)) +
                            part(compression) +
                            packed(static_cast<uint64_t>(packed_records.size())) + packed_records);
}

/// Messages of channels, as a summary counts them.
using Counts = std::map<uint16_t, uint64_t>;

/// Behind the data.
std::string mcap_end(size_t before, const std::vector<Topic>& topics, const Counts& counts,
                     uint32_t data_crc = 0) {
  const std::string data_end = mcap_record(15, packed(data_crc));
  std::string summary;
  for (const Topic& topic : topics) summary += mcap_schema(topic) + mcap_channel(topic);
  std::string counted;
  for (const auto& [id, count] : counts) counted += packed(id, count);
  const auto channels = static_cast<uint32_t>(topics.size());
  summary += mcap_record(11, packed(uint64_t{104}, static_cast<uint16_t>(channels), channels, 0U,
                                    0U, 0U, uint64_t{0}, uint64_t{0}) +
                                 part(counted));
  const uint64_t start = topics.empty() ? 0 : before + data_end.size();
  return data_end + (topics.empty() ? "" : summary) +
         mcap_record(2, packed(start, uint64_t{0}, 0U)) + kMcapMagic;
}

class Mcap : public Ros2 {
 protected:
  void write(const std::string& data, const std::vector<Topic>& in_summary = topics(),
             const Counts& counts = {{1, 100}, {2, 4}}) {
    const std::string before = kMcapMagic + mcap_record(1, part("ros2") + part("me")) + data;
    scratch_.text_file("drive", before + mcap_end(before.size(), in_summary, counts));
  }
  size_t start_of_data() const {
    return kMcapMagic.size() + mcap_record(1, part("ros2") + part("me")).size();
  }
};

TEST_F(Mcap, ChunksOfEachCompressionAndNone) {
  const std::string records = mcap_records(topics(), drive());
  for (const char* compression : {"", "lz4", "zstd"}) {
    write(mcap_chunk(compression, records) + mcap_record(7, packed(uint16_t{1}, 0U)) +
          mcap_record(9, "an attachment") + mcap_record(200, "of somebody's own"));
    expect_drive();
  }
  write(records);
  expect_drive();
}

TEST_F(Mcap, ValuesAreThoseOfTheMessages) {
  write(mcap_records(topics(), drive()));
  import_bag(options_);
  const auto increments = all<ImuIncrement>();
  const Eigen::Vector3d gyro_v = mounting_.q_v_b * increments.at(9).dtheta_b / 0.01;
  const Eigen::Vector3d accel_v = mounting_.q_v_b * increments.at(9).dvel_b / 0.01;
  EXPECT_LT((gyro_v - Eigen::Vector3d(0.1, -0.2, -0.3)).norm(), 1e-9);
  EXPECT_LT((accel_v - Eigen::Vector3d(1, -2, -9.8)).norm(), 1e-9);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns, kStart + 50'000'000);  // the header's
  EXPECT_NEAR(fix.antenna.latitude, 48.5 * kDegree, 1e-15);
  EXPECT_EQ(fix.antenna.height, 321.5);
  EXPECT_EQ(fix.quality, FixQuality::single);
  Eigen::Matrix3d ned;
  ned << 9, 0.5, -0.75, 0.5, 4, -0.25, -0.75, -0.25, 16;
  EXPECT_LT((fix.position_covariance - ned).norm(), 1e-5);
}

TEST_F(Mcap, BigEndianAndMessagesByZstd) {
  std::vector<Message> messages = drive();
  for (size_t i = 0; i < messages.size(); i += 2) {
    if (messages[i].topic == 1) {
      messages[i].bytes = imu_message(messages[i].recorded_ns - 2'000'000, true);
    }
  }
  for (size_t i = 0; i < messages.size(); i += 3) messages[i].bytes = zstd(messages[i].bytes);
  write(mcap_records(topics(), messages));
  expect_drive();
  messages[3].bytes.resize(40);
  write(mcap_records(topics(), messages));
  EXPECT_THAT(data_error(), HasSubstr("cannot be inflated by zstd"));
}

/// As ROS 1 recordings are converted: the same bytes and definitions as in a bag.
TEST_F(Mcap, ChannelsOfRos1) {
  const std::string place = "time stamp\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n";
  std::vector<Topic> both = topics();
  both[1] = {2, "/fix", "my/Place", place, "ros1"};
  std::vector<Message> messages = drive();
  for (Message& m : messages) {
    if (m.topic == 2) m.bytes = packed(5U, 6U, 48.5, 9.25, 321.5);
  }
  write(mcap_records(both, messages), both);
  options_.gnss_sigma = Eigen::Vector3d(1, 2, 3);
  const ImportSummary summary = import_bag(options_);
  EXPECT_EQ(summary.gnss.written, 4);
  EXPECT_THAT(summary.gnss.notices, ElementsAre(HasSubstr("4 messages of /fix have no stamp")));
  EXPECT_EQ(all<GnssFix>().at(0).t_ns, kStart + 52'000'000);  // of the recording
}

/// What the summary says is taken if it is all; without one the file is gone through.
TEST_F(Mcap, TopicsOfTheSummary) {
  std::vector<Topic> more = topics();
  more.push_back({3, "/imu/raw", "sensor_msgs/msg/Imu", kImuType});
  more.push_back({4, "/text", "text", "", "json"});
  const std::string records = mcap_records(more, drive());
  write(mcap_chunk("zstd", records), {});
  EXPECT_THAT(usage_error(), AllOf(HasSubstr("2 topics"), HasSubstr("/text (text)")));
  write(mcap_chunk("zstd", records), more, {});  // it counts no messages
  EXPECT_THAT(usage_error(), HasSubstr("2 topics"));
  write(mcap_chunk("zstd", records), more);
  expect_drive();  // /imu/raw has none
}

TEST_F(Mcap, AChunkWithAWrongChecksumIsLeftOut) {
  const std::string first = mcap_chunk("lz4", mcap_records(topics(), drive()));
  const std::string second = mcap_chunk("lz4", mcap_records({}, drive(kStart + 1'000'000'000)), 1);
  const std::string third = mcap_chunk("lz4", mcap_records({}, drive(kStart + 2'000'000'000)));
  write(first + second + third);
  EXPECT_THAT(data_error(),
              AllOf(HasSubstr("drive: byte " + std::to_string(start_of_data() + first.size())),
                    HasSubstr("wrong checksum"), HasSubstr("--skip-bad-rows")));
  const ImportSummary summary = rest();
  EXPECT_EQ(summary.imu.written, 200);
  EXPECT_EQ(summary.imu.skipped, 1);
}

TEST_F(Mcap, AWrongChecksumOfPlainData) {
  const std::string before = kMcapMagic + mcap_record(1, part("ros2") + part("me")) +
                             mcap_records(topics(), drive()) +
                             mcap_record(9, std::string(3'000'000, 'a'));
  scratch_.text_file("drive",
                     before + mcap_end(before.size(), topics(), {{1, 100}, {2, 4}}, crc(before)));
  expect_drive();
  scratch_.text_file(
      "drive", before + mcap_end(before.size(), topics(), {{1, 100}, {2, 4}}, crc(before) + 1));
  EXPECT_THAT(data_error(), HasSubstr("the checksum of all that stands before is wrong"));
  EXPECT_EQ(rest().imu.written, 100);
}

TEST_F(Mcap, CutOff) {
  const std::string first = mcap_chunk("zstd", mcap_records(topics(), drive()));
  write(first + mcap_chunk("zstd", mcap_records({}, drive(kStart + 1'000'000'000))));
  const std::string whole = test::contents(options_.bag);
  const size_t end = start_of_data() + first.size();
  scratch_.text_file("drive", whole.substr(0, end));  // between records
  const ImportSummary summary = import_bag(options_);
  EXPECT_EQ(summary.imu.written, 100);
  EXPECT_THAT(summary.imu.notices, ElementsAre(HasSubstr("has no end, the recording was cut off")));
  for (const size_t more : {4U, 9U, 100U}) {
    scratch_.text_file("drive", whole.substr(0, end + more));
    EXPECT_THAT(data_error(),
                AllOf(HasSubstr("drive: byte " + std::to_string(end)), HasSubstr("cut off")));
    EXPECT_EQ(rest().imu.written, 100);
  }
}

TEST_F(Mcap, DamageNamesTheByte) {
  const std::string good = mcap_chunk("zstd", mcap_records(topics(), drive()));
  const std::string at = "drive: byte " + std::to_string(start_of_data() + good.size());
  const auto error_behind = [&](const std::string& bad) {
    write(good + bad);
    EXPECT_THAT(data_error(), HasSubstr(at));
    return data_error();
  };
  EXPECT_THAT(error_behind(mcap_chunk("gzip", "abc")),
              HasSubstr("something else than lz4 and zstd"));
  EXPECT_THAT(error_behind(mcap_record(6, packed(uint64_t{0}, uint64_t{0}, uint64_t{9}, 0U) +
                                              part("zstd") + packed(uint64_t{3}) + "abc")),
              HasSubstr("cannot be inflated (zstd)"));
  EXPECT_THAT(error_behind(mcap_chunk("", mcap_chunk("", "abc"))), HasSubstr("within a chunk"));
  EXPECT_THAT(error_behind(mcap_record(5, "abc")), HasSubstr("shorter than"));
  EXPECT_THAT(error_behind(mcap_message({77, kStart, "abc"})), HasSubstr("topic 77"));
  EXPECT_THAT(error_behind(mcap_message({1, kStart, "abcd"})), HasSubstr("plain CDR"));
  EXPECT_THAT(error_behind(mcap_message({1, kStart, imu_message(kStart).substr(0, 100)})),
              HasSubstr("shorter than its definition"));
  EXPECT_THAT(error_behind(packed(uint8_t{5}, ~uint64_t{0})), HasSubstr("cut off or damaged"));
  scratch_.text_file("drive", "\x89MCAP1\r\n and more of another version");
  EXPECT_THAT(data_error(), HasSubstr("begins neither as a bag of ROS 1 nor as MCAP"));
}

// rosbag 2 in sqlite3 ----------------------------------------------------------------------------

class Rosbag2 : public Ros2 {
 protected:
  /// With definitions since Iron.
  void write(const std::string& name, const std::vector<Message>& messages,
             bool definitions = false, const std::vector<Topic>& all = topics()) {
    const std::string path = scratch_.path(name);
    std::filesystem::remove(path);
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    run(database,
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
        " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
        " timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN;");
    for (const Topic& t : all) {
      insert(database, "INSERT INTO topics VALUES(?, ?, ?, ?, '')", t.id,
             {t.name, t.type, t.encoding});
    }
    if (definitions) {
      run(database,
          "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL,"
          " encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL,"
          " type_description_hash TEXT NOT NULL)");
      for (const Topic& t : all) {
        insert(database, "INSERT INTO message_definitions VALUES(?, ?, ?, ?, '')", t.id,
               {t.type, "ros2msg", t.definition});
      }
    }
    for (const Message& m : messages) {
      insert(database,
             "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, " +
                 std::to_string(m.recorded_ns) + ", ?)",
             m.topic, {}, m.bytes);
    }
    run(database, "COMMIT");
    sqlite3_close(database);
  }

  void write_folder(const std::vector<std::string>& files) {
    std::string yaml = "rosbag2_bagfile_information:\n  version: 4\n  relative_file_paths:\n";
    for (const std::string& file : files) yaml += "    - " + file + "\n";
    scratch_.text_file("trip/metadata.yaml", yaml);
    options_.bag = scratch_.path("trip");
  }

 private:
  static void run(sqlite3* database, const char* sql) {
    ASSERT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
  }
  static void insert(sqlite3* database, const std::string& sql, int number,
                     const std::vector<std::string>& texts, const std::string& blob = "") {
    sqlite3_stmt* statement = nullptr;
    ASSERT_EQ(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr), SQLITE_OK);
    sqlite3_bind_int(statement, 1, number);
    int at = 2;
    for (const std::string& text : texts) {
      sqlite3_bind_text(statement, at++, text.c_str(), -1, SQLITE_TRANSIENT);
    }
    sqlite3_bind_blob(statement, at, blob.data(), static_cast<int>(blob.size()), SQLITE_TRANSIENT);
    ASSERT_EQ(sqlite3_step(statement), SQLITE_DONE);
    sqlite3_finalize(statement);
  }
};

TEST_F(Rosbag2, ADatabaseWithAndWithoutDefinitions) {
  for (const bool definitions : {false, true}) {
    write("drive", drive(), definitions);
    expect_drive();
    EXPECT_EQ(all<GnssFix>().at(0).t_ns, kStart + 50'000'000);
    EXPECT_EQ(all<GnssFix>().at(2).antenna.height, 321.5);
  }
  const std::vector<std::string> left = scratch_.names();
  EXPECT_THAT(left, ElementsAre("drive", "out.rawlog"));  // nothing beside the recording
}

TEST_F(Rosbag2, TypesOfOnesOwnNeedTheirDefinition) {
  std::vector<Topic> own = topics();
  own[1] = {2, "/fix", "my/msg/Fix", kFixType};
  write("drive", drive(), true, own);
  expect_drive();
  write("drive", drive(), false, own);
  EXPECT_THAT(data_error(), AllOf(HasSubstr("no topic with latitude, longitude and altitude"),
                                  HasSubstr("/fix (my/msg/Fix)")));
  own[1] = {2, "/fix", "sensor_msgs/msg/NavSatFix", kFixType, "protobuf"};
  write("drive", drive(), true, own);
  EXPECT_THAT(data_error(), HasSubstr("no topic with latitude"));
}

TEST_F(Rosbag2, FoldersOfSeveralFiles) {
  std::filesystem::create_directory(scratch_.path("trip"));
  std::vector<Topic> turned = topics();  // numbers are of a file
  turned[0].id = 2;
  turned[1].id = 1;
  std::vector<Message> second = drive(kStart + 1'000'000'000);
  for (Message& m : second) m.topic = static_cast<uint16_t>(3 - m.topic);
  write("trip/trip_9.db3", drive());
  write("trip/trip_10.db3", second, false, turned);
  write_folder({"trip_9.db3", "trip/trip_10.db3"});
  ImportSummary summary = import_bag(options_);
  EXPECT_EQ(summary.imu.written, 200);
  EXPECT_EQ(summary.gnss.written, 6);
  EXPECT_THAT(summary.imu.notices, IsEmpty());

  std::filesystem::remove(scratch_.path("trip/metadata.yaml"));
  summary = import_bag(options_);
  EXPECT_EQ(summary.imu.written, 200);
  EXPECT_THAT(summary.imu.notices, ElementsAre(HasSubstr("no metadata.yaml")));

  write_folder({"trip_9.db3", "trip_10.db3", "trip_11.db3"});
  EXPECT_THAT(data_error(), HasSubstr("trip_11.db3"));
  EXPECT_EQ(rest().imu.written, 200);
  scratch_.text_file("trip/metadata.yaml", "a: [");
  EXPECT_THAT(data_error(), HasSubstr("metadata.yaml' cannot be read"));
}

TEST_F(Rosbag2, AFolderWithoutFiles) {
  std::filesystem::create_directory(scratch_.path("trip"));
  options_.bag = scratch_.path("trip");
  EXPECT_THAT(data_error(), HasSubstr("folder without files of rosbag 2"));
}

TEST_F(Rosbag2, FilesAndMessagesByZstd) {
  std::vector<Message> messages = drive();
  for (Message& m : messages) m.bytes = zstd(m.bytes);
  write("drive", messages);
  expect_drive();
  std::filesystem::create_directory(scratch_.path("trip"));
  write("plain", drive());
  const std::string packed_file = zstd(test::contents(scratch_.path("plain")));
  scratch_.text_file("trip/trip_0.db3.zstd", packed_file);
  write_folder({"trip_0.db3.zstd"});
  expect_drive();
  scratch_.text_file("trip/trip_0.db3.zstd", packed_file.substr(0, packed_file.size() - 9));
  EXPECT_THAT(data_error(), HasSubstr("no topic"));
  options_.bag = scratch_.path("trip/trip_0.db3.zstd");
  EXPECT_THAT(data_error(), AllOf(HasSubstr("trip_0.db3.zstd"), HasSubstr("cut off")));
}

TEST_F(Rosbag2, DamageNamesTheMessage) {
  std::vector<Message> messages = drive();
  messages[50].bytes = "\0\1\0\0";
  messages[50].topic = 1;
  write("drive", messages);
  EXPECT_THAT(data_error(), HasSubstr("drive: message 51: a message that is"));
  EXPECT_EQ(rest().imu.skipped, 1);

  write("drive", drive());
  std::string bytes = test::contents(options_.bag);
  const size_t pages = bytes.size() / 4096;
  std::fill(bytes.begin() + static_cast<ptrdiff_t>(pages / 2 * 4096),
            bytes.begin() + static_cast<ptrdiff_t>((pages / 2 + 1) * 4096), '\x7F');
  scratch_.text_file("drive", bytes);
  EXPECT_THAT(data_error(), AllOf(HasSubstr("drive: message "), HasSubstr("cannot be read")));
  const ImportSummary summary = rest();
  EXPECT_GT(summary.imu.written, 10);
  EXPECT_LT(summary.imu.written, 100);
  EXPECT_EQ(summary.imu.skipped, 1);

  scratch_.text_file("drive", bytes.substr(0, 100));
  EXPECT_THAT(data_error(), HasSubstr("cannot be read as a recording of rosbag 2"));
}

TEST_F(Rosbag2, OtherDatabasesAreRefused) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(options_.bag.c_str(), &database), SQLITE_OK);
  sqlite3_exec(database,
               "CREATE TABLE topics(a); CREATE VIEW messages AS SELECT 1 AS id, 1 AS topic_id",
               nullptr, nullptr, nullptr);
  sqlite3_close(database);
  EXPECT_THAT(data_error(), HasSubstr("without the tables of rosbag 2"));
  scratch_.text_file("drive", "something else");
  EXPECT_THAT(data_error(), HasSubstr("begins neither as a bag of ROS 1"));
}

// What messages say ------------------------------------------------------------------------------

TEST_F(Rosbag2, StatusAndCovarianceOfFixes) {
  std::vector<Message> messages = drive();
  messages.erase(std::remove_if(messages.begin(), messages.end(),
                                [](const Message& m) { return m.topic == 2; }),
                 messages.end());
  int64_t t_ns = kStart + 60'000'000;
  // A status that is not known (-2) is a position; 1 and 2: with corrections.
  for (const int status : {-2, -1, 0, 1, 2}) {
    messages.push_back({2, t_ns, fix_message(t_ns, static_cast<int8_t>(status), 2)});
    t_ns += 10'000'000;
  }
  write("drive", messages);
  const ImportSummary summary = import_bag(options_);
  EXPECT_EQ(summary.gnss.without_fix, 1);
  EXPECT_EQ(summary.qualities.at(FixQuality::unknown), 1);
  EXPECT_EQ(summary.qualities.at(FixQuality::single), 1);
  EXPECT_EQ(summary.qualities.at(FixQuality::differential), 2);
  const Eigen::Matrix3d diagonal = Eigen::Vector3d(9, 4, 16).asDiagonal();
  EXPECT_LT((all<GnssFix>().at(0).position_covariance - diagonal).norm(), 1e-5);
}

/// The twist of an Odometry is along the axes of the vehicle.
TEST_F(Rosbag2, VelocitiesEastNorthUp) {
  std::vector<Topic> more = topics();
  more.push_back({3, "/odom", "nav_msgs/msg/Odometry", ""});
  more.push_back({4, "/vel", "geometry_msgs/msg/TwistWithCovarianceStamped", ""});
  std::vector<Message> messages = drive();
  std::array<double, 36> covariance{};
  covariance[0] = 0.04;
  covariance[7] = 0.09;
  covariance[14] = 0.16;
  const int64_t t_ns = kStart + 50'000'000;
  messages.insert(
      messages.begin() + 6,
      {4, t_ns, header(t_ns).put(3.0, 5.0, -0.5, 0.0, 0.0, 0.0).put(covariance).bytes()});
  write("drive", messages, false, more);
  options_.velocity_topic = "/odom";
  EXPECT_THAT(usage_error(),
              AllOf(HasSubstr("--velocity-topic /odom"), HasSubstr("no such topic")));
  options_.velocity_topic = "/vel";
  EXPECT_EQ(import_bag(options_).with_velocity, 1);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_LT((*fix.velocity_n - Eigen::Vector3d(5, 3, 0.5)).norm(), 1e-6);
  EXPECT_NEAR(fix.velocity_covariance(0, 0), 0.09, 1e-6);
}

/// With its checksum.
std::string sentence(const std::string& text) {
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  std::array<char, 8> end{};
  std::snprintf(end.data(), end.size(), "*%02X\r\n", sum);
  return "$" + text + end.data();
}

class Sentences : public Rosbag2 {
 protected:
  static std::vector<Topic> with_nmea() {
    return {topics()[0], {3, "/nmea", "nmea_msgs/msg/Sentence", ""}};
  }
  /// `recorded_ns` behind the start, at which it is 05:20:00.
  static Message nmea(int64_t recorded_ns, const std::string& text) {
    const int64_t t_ns = kStart + recorded_ns;
    return {3, t_ns, header(t_ns, "gps").put(sentence(text)).bytes()};
  }
  static std::vector<Message> imu_alone() {
    std::vector<Message> messages = drive();
    messages.erase(std::remove_if(messages.begin(), messages.end(),
                                  [](const Message& m) { return m.topic == 2; }),
                   messages.end());
    return messages;
  }
};

TEST_F(Sentences, FixesByTheirOwnTime) {
  std::vector<Message> messages = imu_alone();
  for (const int tenths : {1, 3, 5}) {
    const std::string time = "052000." + std::to_string(tenths) + "0";
    messages.push_back(nmea(100'000'000 * tenths + 60'000'000,
                            "GNGGA," + time + ",4830.00,N,00915.00,E,4,12,0.5,300.0,M,48.0,M,,"));
    messages.push_back(nmea(100'000'000 * tenths + 61'000'000,
                            "GNRMC," + time + ",A,4830.00,N,00915.00,E,10.0,90.0,150422,,,A"));
  }
  write("drive", messages, false, with_nmea());
  const ImportSummary summary = import_bag(options_);
  EXPECT_EQ(summary.gnss.written, 3);
  EXPECT_EQ(summary.qualities.at(FixQuality::fixed_rtk), 3);
  EXPECT_THAT(summary.gnss.notices, Contains(HasSubstr("stamps are the receiver's")));
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns, kStart + 100'000'000);
  EXPECT_NEAR(fix.antenna.longitude, 9.25 * kDegree, 1e-15);
  EXPECT_EQ(fix.antenna.height, 348);
  EXPECT_NEAR(fix.velocity_n->y(), 10 * 1852.0 / 3600, 1e-9);
  EXPECT_THAT(scratch_.names(), ElementsAre("drive", "out.rawlog"));
}

/// The day is that of the recording, unless the sentence is of the evening before.
TEST_F(Sentences, WithoutADate) {
  std::vector<Message> messages = imu_alone();
  const int64_t to_midnight_ns = (18 * 3600 + 40 * 60) * int64_t{1'000'000'000};
  for (Message& m : messages) {
    m.recorded_ns += to_midnight_ns - 500'000'000;
    m.bytes = imu_message(m.recorded_ns);
  }
  messages.push_back(nmea(to_midnight_ns + 10'000'000,
                          "GPGGA,235959.90,4830.00,N,00915.00,E,1,12,0.5,300.0,M,48.0,M,,"));
  write("drive", messages, false, with_nmea());
  import_bag(options_);
  EXPECT_EQ(all<GnssFix>().at(0).t_ns, kStart + to_midnight_ns - 100'000'000);
}

TEST_F(Sentences, FixesComeFirstUnlessTheTopicIsGiven) {
  std::vector<Topic> more = topics();
  more.push_back(with_nmea()[1]);
  std::vector<Message> messages = drive();
  messages.push_back(
      nmea(600'000'000, "GPGGA,052000.50,4830.00,N,00915.00,E,5,12,0.5,300.0,M,48.0,M,,"));
  messages.push_back({3, kStart, "\0\1\0\0 cut"});
  write("drive", messages, false, more);
  EXPECT_EQ(import_bag(options_).gnss.written, 3);
  options_.gnss_topic = "/nmea";
  EXPECT_THAT(data_error(), AllOf(HasSubstr("drive: message "), HasSubstr("--skip-bad-rows")));
  const ImportSummary summary = rest();
  EXPECT_EQ(summary.qualities.at(FixQuality::float_rtk), 1);
  EXPECT_THAT(summary.gnss.notices, Contains(HasSubstr("1 damaged messages left out")));
  options_.gnss_topic = "/imu";
  EXPECT_THAT(usage_error(), HasSubstr("--gnss-topic /imu"));
}

}  // namespace
}  // namespace foucault::rawlog
