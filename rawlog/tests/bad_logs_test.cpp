#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>

#include <random>

#include "foucault/core/error.h"
#include "foucault/rawlog/rawlog_info.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "mrpt_log.h"
#include "scratch.h"

namespace foucault {
namespace {

using test::error_of;
using test::gps_at;
using test::imu_at;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int64_t kBegin = 1'600'000'000'000'000'000;
constexpr int64_t kMs = 1'000'000;

int64_t read_through(const std::string& path) {
  RawlogSource source(path);
  int64_t count = 0;
  while (source.next()) ++count;
  return count;
}

/// Every test also checks that MRPT and we keep silent.
class BadLogs : public ::testing::Test {
 protected:
  void SetUp() override {
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
  }
  void TearDown() override {
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  }

  std::string error(const std::string& path) {
    return error_of<DataError>([&] { read_through(path); });
  }

  template <class Log>
  std::string good_log(const std::string& name, int64_t samples) {
    Log log(scratch_.path(name));
    for (int64_t i = 0; i < samples; ++i) {
      log.write(imu_at(kBegin + i * 10 * kMs));
      if (i % 10 == 0) log.write(gps_at(kBegin + i * 10 * kMs));
    }
    return scratch_.path(name);
  }

  Scratch scratch_;
};

TEST_F(BadLogs, Missing) {
  EXPECT_THAT(error(scratch_.path("none.rawlog")),
              AllOf(HasSubstr("none.rawlog"), HasSubstr("does not exist")));
}

TEST_F(BadLogs, Directory) { EXPECT_THAT(error(scratch_.path("")), HasSubstr("is a directory")); }

TEST_F(BadLogs, Empty) {
  EXPECT_THAT(error(scratch_.text_file("a.rawlog", "")), HasSubstr("is empty"));
}

TEST_F(BadLogs, NoRawlog) {
  for (const std::string& contents :
       {std::string("week,sow,lat\n2200,1,2\n"), std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16),
        std::string(1000, '\0'), std::string(1000, '\xFF'), std::string("x"),
        std::string("\x8F"
                    "abc")}) {
    EXPECT_THAT(error(scratch_.text_file("a.rawlog", contents)), HasSubstr("is no MRPT rawlog"))
        << contents;
  }
}

TEST_F(BadLogs, NoImu) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    auto imu = imu_at(kBegin);
    imu.dataIsPresent[mrpt::obs::IMU_WX] = false;
    log.write(imu);
    log.write(gps_at(kBegin));
  }
  EXPECT_THAT(error(scratch_.path("a.rawlog")),
              AllOf(HasSubstr("has no IMU"), HasSubstr("1 CObservationIMU")));
}

TEST_F(BadLogs, NoGnss) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    log.write(imu_at(kBegin));
    auto gps = gps_at(kBegin);
    gps.setMsg(test::gga(0));
    log.write(gps);
    log.write(gps);
  }
  EXPECT_THAT(error(scratch_.path("a.rawlog")),
              AllOf(HasSubstr("has no GNSS"), HasSubstr("2 CObservationGPS")));
}

TEST_F(BadLogs, UnknownLabel) {
  const std::string path = good_log<test::GzLog>("a.rawlog", 20);
  RawlogOptions options;
  options.imu_label = "other";
  EXPECT_THAT(
      error_of<DataError>([&] { RawlogSource source(path, SampleKind::interval_mean, options); }),
      HasSubstr("labelled 'other'"));
}

TEST_F(BadLogs, TruncatedGzipSaysWhereAndHowMany) {
  const std::string whole = test::contents(good_log<test::GzLog>("a.rawlog", 2000));
  ASSERT_GT(whole.size(), 4000U);
  for (const double part : {0.3, 0.7, 0.95}) {
    const std::string cut = whole.substr(0, static_cast<size_t>(part * whole.size()));
    const std::string what = error(scratch_.text_file("cut.rawlog", cut));
    EXPECT_THAT(what, AllOf(HasSubstr("is truncated"), HasSubstr("at byte"), HasSubstr("record")));
  }
  // Only the last byte of the checksum is missing: MRPT's own stream takes this for whole.
  EXPECT_THAT(error(scratch_.text_file("cut.rawlog", whole.substr(0, whole.size() - 1))),
              HasSubstr("is truncated"));
}

TEST_F(BadLogs, TruncatedAnywhere) {
  const std::string whole = test::contents(good_log<test::PlainLog>("a.rawlog", 3));
  const size_t two_records = test::contents(good_log<test::PlainLog>("b.rawlog", 1)).size();
  // A stride, because MRPT takes milliseconds for the stack trace in each of its exceptions.
  for (size_t size = two_records + 1; size + 1 < whole.size(); size += 3) {
    try {
      read_through(scratch_.text_file("cut.rawlog", whole.substr(0, size)));
      // At a record's end a plain log shows nothing: that one is three whole records.
      EXPECT_EQ(2 * (size - two_records), whole.size() - two_records);
    } catch (const DataError& problem) {
      EXPECT_THAT(problem.what(), HasSubstr("is truncated")) << size;
    }
  }
  const std::string early = scratch_.text_file("cut.rawlog", whole.substr(0, two_records / 2));
  EXPECT_THAT(error(early), HasSubstr("truncated"));
}

TEST_F(BadLogs, DamagedGzip) {
  std::string bytes = test::contents(good_log<test::GzLog>("a.rawlog", 2000));
  for (size_t i = bytes.size() / 2; i < bytes.size() / 2 + 40; ++i) bytes[i] ^= 0x5A;
  EXPECT_THAT(error(scratch_.text_file("bad.rawlog", bytes)),
              ::testing::AnyOf(HasSubstr("is damaged"), HasSubstr("is truncated")));
}

TEST_F(BadLogs, FlippedBytesNeverCrash) {
  const std::string whole = test::contents(good_log<test::PlainLog>("a.rawlog", 12));
  std::mt19937 rng{42};
  std::uniform_int_distribution<size_t> position(0, whole.size() - 1);
  // Higher bits can turn the length of a label into gigabytes, which MRPT allocates and gives back.
  std::uniform_int_distribution<int> bit(0, 2);
  int rejected = 0;
  for (int run = 0; run < 150; ++run) {
    std::string bytes = whole;
    bytes[position(rng)] ^= static_cast<char>(1 << bit(rng));
    try {
      read_through(scratch_.text_file("flipped.rawlog", bytes));
    } catch (const DataError& problem) {
      ++rejected;
      EXPECT_THAT(problem.what(), ::testing::Not(HasSubstr("\n")));
    }
  }
  EXPECT_GT(rejected, 10);
}

/// The version of a class stands behind its name in a record.
std::string with_version(std::string bytes, const std::string& name, char version) {
  const size_t at = bytes.find(name);
  EXPECT_NE(at, std::string::npos);
  bytes[at + name.size()] = version;
  return bytes;
}

TEST_F(BadLogs, GpsRecordsOfNewerMrptAreNamed) {
  const std::string whole = test::contents(good_log<test::PlainLog>("a.rawlog", 3));
  const std::string newer = with_version(whole, "CObservationGPS", 99);
  EXPECT_THAT(error(scratch_.text_file("new.rawlog", newer)),
              AllOf(HasSubstr("record 2"), HasSubstr("CObservationGPS"), HasSubstr("newer MRPT"),
                    HasSubstr("2.11.12")));
}

TEST_F(BadLogs, OtherRecordsOfNewerMrptToo) {
  const std::string whole = test::contents(good_log<test::PlainLog>("a.rawlog", 3));
  const std::string newer = with_version(whole, "CObservationIMU", 99);
  EXPECT_THAT(error(scratch_.text_file("new.rawlog", newer)),
              AllOf(HasSubstr("record 1 (CObservationIMU)"), HasSubstr("newer MRPT")));
}

TEST_F(BadLogs, UnknownClass) {
  std::string bytes = test::contents(good_log<test::PlainLog>("a.rawlog", 3));
  bytes.replace(bytes.find("CObservationGPS"), 15, "CObservationXYZ");
  EXPECT_THAT(error(scratch_.text_file("a.rawlog", bytes)),
              AllOf(HasSubstr("record 2"), HasSubstr("CObservationXYZ")));
}

TEST_F(BadLogs, ImuStampsThatGoBack) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    log.write(gps_at(kBegin));
    log.write(imu_at(kBegin + 20 * kMs));
    log.write(imu_at(kBegin + 10 * kMs));
  }
  EXPECT_THAT(error(scratch_.path("a.rawlog")),
              AllOf(HasSubstr("record 3 at 2020-09-13T12:26:40.010Z"), HasSubstr("sort the log")));
}

TEST_F(BadLogs, ImuValuesThatAreNotFinite) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    log.write(gps_at(kBegin));
    log.write(imu_at(kBegin));
    auto imu = imu_at(kBegin + 10 * kMs);
    imu.set(mrpt::obs::IMU_WY, std::nan(""));
    log.write(imu);
  }
  EXPECT_THAT(error(scratch_.path("a.rawlog")),
              AllOf(HasSubstr("record 3 at 2020-09-13T12:26:40.010Z"), HasSubstr("not finite")));
}

TEST_F(BadLogs, GnssValuesThatAreNotFinite) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    log.write(imu_at(kBegin));
    log.write(gps_at(kBegin));
    auto gps = gps_at(kBegin + 10 * kMs);
    auto message = test::gga();
    message.fields.altitude_meters = std::numeric_limits<double>::infinity();
    gps.setMsg(message);
    log.write(gps);
  }
  EXPECT_THAT(error(scratch_.path("a.rawlog")), AllOf(HasSubstr("record 3"), HasSubstr("finite")));
}

TEST_F(BadLogs, ImuAndGnssThatDoNotOverlap) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    log.write(gps_at(kBegin - 18'000 * kMs));
    for (int64_t i = 0; i < 5; ++i) log.write(imu_at(kBegin + i * 10 * kMs));
  }
  EXPECT_THAT(error(scratch_.path("a.rawlog")), HasSubstr("do not overlap"));
}

TEST_F(BadLogs, FixesThatAllComeLate) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    for (int64_t i = 0; i < 1000; ++i) log.write(imu_at(kBegin + i * 10 * kMs));
    for (int64_t i = 0; i < 5; ++i) log.write(gps_at(kBegin + i * 1000 * kMs));
  }
  EXPECT_THAT(error(scratch_.path("a.rawlog")),
              AllOf(HasSubstr("every fix comes more than 2 s late"), HasSubstr("sort the log")));
}

TEST_F(BadLogs, InfoTellsWhatIsThereUpToTheDamage) {
  const std::string whole = test::contents(good_log<test::PlainLog>("a.rawlog", 50));
  const std::string path = scratch_.text_file("cut.rawlog", whole.substr(0, whole.size() / 2));
  const RawlogInfo info = read_rawlog_info(path);
  ASSERT_TRUE(info.damage);
  EXPECT_THAT(*info.damage, HasSubstr("is truncated"));
  EXPECT_GT(info.records, 20);
  EXPECT_EQ(info.streams.size(), 2U);
  EXPECT_THAT(error_of<DataError>([&] { read_rawlog_info(scratch_.path("none")); }),
              HasSubstr("does not exist"));
  EXPECT_THAT(
      error_of<DataError>([&] { read_rawlog_info(scratch_.text_file("t.rawlog", "hello you")); }),
      HasSubstr("is no MRPT rawlog"));
}

}  // namespace
}  // namespace foucault
