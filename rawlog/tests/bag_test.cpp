#include <bzlib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lz4frame.h>

#include <array>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/rawlog/import_bag.h"
#include "foucault/rawlog/rawlog_source.h"
#include "ros_bytes.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::error_of;
using test::packed;
using test::part;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

using Header = std::vector<std::pair<std::string, std::string>>;

std::string fields(const Header& header) {
  std::string bytes;
  for (const auto& [name, value] : header) bytes += part(name + "=" + value);
  return bytes;
}

std::string record(const Header& header, const std::string& data) {
  return part(fields(header)) + part(data);
}

const std::string kHeaderType =
    "================\nMSG: std_msgs/Header\n# more\nuint32 seq\ntime stamp\nstring frame_id\n";
const std::string kVectorType =
    "================\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
const std::string kImuType =
    "Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "Vector3 angular_velocity # rad/s\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n" +
    kHeaderType + kVectorType +
    "================\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
const std::string kFixType =
    "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
    "float64 altitude\nfloat64[9] position_covariance\nuint8 COVARIANCE_TYPE_UNKNOWN = 0\n"
    "uint8 position_covariance_type\n" +
    kHeaderType +
    "================\nMSG: sensor_msgs/NavSatStatus\nint8 STATUS_NO_FIX = -1\nint8 status\n"
    "uint16 service\n";
const std::string kTwistType =
    "Header header\nTwist twist\n" + kHeaderType + kVectorType +
    "================\nMSG: geometry_msgs/Twist\nVector3 linear\nVector3 angular\n";

constexpr uint32_t kSecond = 1'650'000'000;

std::string stamp_header(double t, const std::string& frame = "imu_link") {
  const auto nanoseconds = static_cast<uint32_t>(std::llround(t * 1e9) % 1'000'000'000);
  return packed(uint32_t{7}, kSecond + static_cast<uint32_t>(t), nanoseconds) + part(frame);
}

/// A bag of 100 Hz and 4 Hz over a second; its records are changed by the tests.
class Bag : public ::testing::Test {
 protected:
  Bag() {
    options_.bag = scratch_.path("drive.bag");
    options_.out = scratch_.path("out.rawlog");
    options_.lever_arm = {0.1, -0.2, -0.3};
  }

  void connect(uint32_t id, const std::string& topic, const std::string& type,
               const std::string& definition) {
    records_ += record({{"op", "\x07"}, {"conn", packed(id)}, {"topic", topic}},
                       fields({{"topic", topic},
                               {"type", type},
                               {"md5sum", "*"},
                               {"message_definition", definition}}));
  }
  void message(uint32_t id, double t, const std::string& data) {
    const auto nanoseconds = static_cast<uint32_t>(std::llround((t + 0.002) * 1e9) % 1'000'000'000);
    records_ += record({{"op", "\x02"},
                        {"conn", packed(id)},
                        {"time", packed(kSecond + static_cast<uint32_t>(t + 0.002), nanoseconds)}},
                       data);
  }

  void connect() {
    connect(0, "/imu/data", "sensor_msgs/Imu", kImuType);
    connect(1, "/fix", "sensor_msgs/NavSatFix", kFixType);
    connect(2, "/vel", "geometry_msgs/TwistStamped", kTwistType);
  }
  void imu(double t, double accel_covariance = 0) {
    const std::array<double, 9> none{};
    message(0, t,
            stamp_header(t) + packed(0.0, 0.0, 0.0, 1.0, none, 0.1, 0.2, 0.3, none, 1.0, 2.0, 9.8,
                                     std::array<double, 9>{accel_covariance}));
  }
  void fix(double t, int8_t status = 0, uint8_t covariance_type = 3) {
    // east, north, up
    const std::array<double, 9> covariance{4.0, 0.5, 0.25, 0.5, 9.0, 0.75, 0.25, 0.75, 16.0};
    message(1, t,
            stamp_header(t, "gps") +
                packed(status, uint16_t{1}, 48.5, 9.25, 321.5, covariance, covariance_type));
  }
  void velocity(double t) {
    message(2, t, stamp_header(t, "gps") + packed(3.0, 5.0, -0.5, 0.0, 0.0, 0.0));
  }
  void drive() {
    connect();
    for (int i = 0; i < 100; ++i) {
      imu(0.01 * i);
      if (i % 25 == 5) {
        if (i == 5) velocity(0.01 * i);
        fix(0.01 * i, i == 80 ? int8_t{-1} : int8_t{0});
        if (i == 30) velocity(0.01 * i + 0.001);
      }
    }
  }

  static std::string compressed(const std::string& compression, std::string plain) {
    if (compression == "none") return plain;
    std::string bytes(2 * plain.size() + 1000, '\0');
    if (compression == "bz2") {
      auto size = static_cast<unsigned>(bytes.size());
      BZ2_bzBuffToBuffCompress(bytes.data(), &size, plain.data(),
                               static_cast<unsigned>(plain.size()), 9, 0, 0);
      bytes.resize(size);
    } else {
      bytes.resize(
          LZ4F_compressFrame(bytes.data(), bytes.size(), plain.data(), plain.size(), nullptr));
    }
    return bytes;
  }

  std::string chunk(const std::string& compression, size_t more = 0) const {
    return record({{"op", "\x05"},
                   {"compression", compression},
                   {"size", packed(static_cast<uint32_t>(records_.size() + more))}},
                  compressed(compression, records_));
  }
  void write(const std::string& chunks) {
    const std::string header = record(
        {{"op", "\x03"}, {"index_pos", std::string(8, '\0')}, {"chunk_count", packed(1U)}}, "   ");
    scratch_.text_file("drive.bag", "#ROSBAG V2.0\n" + header + chunks);
  }

  std::string data_error() {
    const std::string what = error_of<DataError>([&] { import_bag(options_); });
    EXPECT_FALSE(std::filesystem::exists(options_.out));
    return what;
  }
  std::string usage_error() {
    return error_of<UsageError>([&] { import_bag(options_); });
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
  std::string records_;
  BagImport options_;
  state::Mounting mounting_;
};

TEST_F(Bag, ChunksOfEachCompression) {
  drive();
  for (const char* compression : {"none", "bz2", "lz4"}) {
    write(chunk(compression));
    const ImportSummary summary = import_bag(options_);
    EXPECT_EQ(summary.imu.written, 100) << compression;
    EXPECT_EQ(summary.gnss.written, 3);
    EXPECT_EQ(summary.gnss.without_fix, 1);
  }
}

TEST_F(Bag, FrontLeftUpAndEastNorthUp) {
  drive();
  write(chunk("none"));
  import_bag(options_);
  const auto increments = all<ImuIncrement>();
  const Eigen::Vector3d gyro_v = mounting_.q_v_b * increments.at(9).dtheta_b / 0.01;
  const Eigen::Vector3d accel_v = mounting_.q_v_b * increments.at(9).dvel_b / 0.01;
  EXPECT_LT((gyro_v - Eigen::Vector3d(0.1, -0.2, -0.3)).norm(), 1e-9);
  EXPECT_LT((accel_v - Eigen::Vector3d(1, -2, -9.8)).norm(), 1e-9);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_EQ(fix.t_ns,
            kSecond * int64_t{1'000'000'000} + 50'000'000);  // the header's, not 2 ms more
  EXPECT_NEAR(fix.antenna.latitude, 48.5 * kDegree, 1e-15);
  EXPECT_NEAR(fix.antenna.longitude, 9.25 * kDegree, 1e-15);
  EXPECT_EQ(fix.antenna.height, 321.5);
  Eigen::Matrix3d ned;
  ned << 9, 0.5, -0.75, 0.5, 4, -0.25, -0.75, -0.25, 16;
  EXPECT_LT((fix.position_covariance - ned).norm(), 1e-5) << fix.position_covariance;
  EXPECT_LT((mounting_.q_v_b * fix.p_b_a - options_.lever_arm).norm(), 1e-9);
}

TEST_F(Bag, AnImuOnItsSide) {
  options_.imu_axes = {"x", "z", "-y"};
  drive();
  write(chunk("none"));
  import_bag(options_);
  const auto increments = all<ImuIncrement>();
  const Eigen::Vector3d accel_v = mounting_.q_v_b * increments.at(9).dvel_b / 0.01;
  EXPECT_LT((accel_v - Eigen::Vector3d(1, 9.8, -2)).norm(), 1e-9);
  options_.imu_axes = {"x", "y", "-z"};
  EXPECT_THAT(usage_error(), AllOf(HasSubstr("--imu-axes"), HasSubstr("left-handed")));
}

TEST_F(Bag, VelocitiesOfTheStampsOfTheFixes) {
  options_.velocity_topic = "/vel";
  drive();
  write(chunk("none"));
  EXPECT_THAT(usage_error(), HasSubstr("give --velocity-sigma"));
  options_.velocity_sigma = Eigen::Vector3d(0.1, 0.2, 0.3);
  EXPECT_EQ(import_bag(options_).with_velocity, 2);
  const auto fixes = all<GnssFix>();
  ASSERT_EQ(fixes.size(), 3U);
  for (const size_t i : {0U, 1U}) {
    EXPECT_LT((*fixes[i].velocity_n - Eigen::Vector3d(5, 3, 0.5)).norm(), 1e-6);
    EXPECT_NEAR(fixes[i].velocity_covariance(1, 1), 0.04, 1e-6);
  }
  EXPECT_FALSE(fixes[2].velocity_n);
}

TEST_F(Bag, ACovarianceThatIsNotKnown) {
  connect();
  for (int i = 0; i < 20; ++i) imu(0.01 * i);
  fix(0.1, 2, 0);
  write(chunk("none"));
  EXPECT_THAT(usage_error(), HasSubstr("give --gnss-sigma NORTH,EAST,DOWN"));
  options_.gnss_sigma = Eigen::Vector3d(1, 1, 2);
  EXPECT_EQ(import_bag(options_).qualities.at(FixQuality::differential), 1);
  EXPECT_NEAR(all<GnssFix>().at(0).position_covariance(2, 2), 4, 1e-6);
  options_.gnss_sigma = Eigen::Vector3d(1, 0, 2);
  EXPECT_THAT(usage_error(), HasSubstr("greater than zero"));
}

/// Types of one's own, with wrapped numbers, an array of messages and no stamp.
TEST_F(Bag, OtherTypesByTheirDefinition) {
  connect(0, "/imu", "sensor_msgs/Imu", kImuType);
  connect(4, "/gps", "my_driver/Place",
          "Header header\nstring[] names\nPair[] pairs\nstd_msgs/Float64 latitude\n"
          "std_msgs/Float64 longitude\nstd_msgs/Float64 altitude\n" +
              kHeaderType + "===\nMSG: std_msgs/Float64\nfloat64 data\n" +
              "===\nMSG: my_driver/Pair\nint8 a\nfloat32[2] b\n");
  for (int i = 0; i < 20; ++i) imu(0.01 * i);
  message(4, 0.1,
          std::string(12, '\0') + part("f") + packed(2U) + part("one") + part("") + packed(2U) +
              std::string(18, 'x') + packed(48.5, 9.25, 321.5));
  write(chunk("none"));
  options_.gnss_sigma = Eigen::Vector3d(1, 1, 2);
  EXPECT_EQ(import_bag(options_).gnss.written, 1);
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_NEAR(fix.antenna.longitude, 9.25 * kDegree, 1e-15);
  EXPECT_EQ(fix.t_ns, kSecond * int64_t{1'000'000'000} + 102'000'000);  // of the recording
}

TEST_F(Bag, TopicsAreChosen) {
  drive();
  connect(3, "/imu/raw", "sensor_msgs/Imu", kImuType);
  write(chunk("none"));
  EXPECT_THAT(usage_error(), AllOf(HasSubstr("2 topics"), HasSubstr("choose one by --imu-topic"),
                                   HasSubstr("/imu/raw (sensor_msgs/Imu)")));
  options_.imu_topic = "/imu/data";
  EXPECT_EQ(import_bag(options_).imu.written, 100);
  options_.imu_topic = "/fix";
  EXPECT_THAT(usage_error(), HasSubstr("--imu-topic /fix"));
  records_.clear();
  connect(0, "/imu/data", "sensor_msgs/Imu", kImuType);
  write(chunk("none"));
  options_.imu_topic.reset();
  std::filesystem::remove(options_.out);
  EXPECT_THAT(data_error(), HasSubstr("no topic with latitude, longitude and altitude"));
}

TEST_F(Bag, AnImuWithoutAccelerometer) {
  connect();
  for (int i = 0; i < 20; ++i) imu(0.01 * i, -1);
  fix(0.1);
  write(chunk("none"));
  EXPECT_THAT(data_error(), HasSubstr("says it has no rates or accelerations"));
}

TEST_F(Bag, DamageNamesTheByte) {
  drive();
  const std::string good = chunk("none");
  write(good.substr(0, good.size() - 5));
  const size_t byte = test::contents(options_.bag).size() + 5 - good.size();
  EXPECT_THAT(data_error(), HasSubstr("no topic"));  // it has nothing but the broken chunk
  write(good + good.substr(0, good.size() - 5));
  EXPECT_THAT(data_error(),
              AllOf(HasSubstr("drive.bag: byte " + std::to_string(byte + good.size())),
                    HasSubstr("ends within a record")));
  options_.skip_bad_rows = true;
  EXPECT_EQ(import_bag(options_).imu.written, 100);
  options_.skip_bad_rows = false;
  std::filesystem::remove(options_.out);
  write(good + chunk("bz2", 1));
  EXPECT_THAT(data_error(), HasSubstr("cannot be inflated by bz2"));
  write(good + chunk("lz4", 1));
  EXPECT_THAT(data_error(), HasSubstr("cannot be inflated by lz4"));
  write(good + record({{"op", "\x05"}, {"compression", "zip"}, {"size", packed(5U)}}, "12345"));
  EXPECT_THAT(data_error(), HasSubstr("something else than bz2 and lz4"));
  records_.clear();
  message(0, 1, "short");
  write(good + chunk("none"));
  EXPECT_THAT(data_error(), HasSubstr("shorter than its definition"));
  scratch_.text_file("drive.bag", "#ROSBAG V1.2\n and more");
  EXPECT_THAT(data_error(), HasSubstr("format 2.0"));
}

}  // namespace
}  // namespace foucault::rawlog
