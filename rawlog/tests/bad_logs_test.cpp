#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <limits>

#include "foucault/core/error.h"
#include "foucault/rawlog/rawlog_info.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "mrpt_log.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::error_of;
using test::gps_at;
using test::imu_at;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int64_t kBegin = 1'600'000'000'000'000'000;
constexpr int64_t kMs = 1'000'000;

/// What came out of a log, and how it ended.
struct Reading {
  SourceCounts counts;
  int64_t measurements = 0;
  std::string damage;  ///< empty: none
  std::vector<state::Notice> notices;
};

Reading read_through(const std::string& path) {
  RawlogSource source(path);
  Reading reading;
  while (source.next()) ++reading.measurements;
  reading.counts = source.counts();
  reading.damage = source.damage().value_or("");
  reading.notices = source.notices();
  EXPECT_THAT(reading.damage, ::testing::Not(HasSubstr("\n")));
  return reading;
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
  EXPECT_THAT(error_of<DataError>(
                  [&] { RawlogSource source(path, imu::SampleKind::interval_mean, options); }),
              HasSubstr("labelled 'other'"));
}

TEST_F(BadLogs, TruncatedGzipSaysWhereAndGivesWhatCameBefore) {
  const std::string whole = test::contents(good_log<test::GzLog>("a.rawlog", 2000));
  ASSERT_GT(whole.size(), 4000U);
  for (const double part : {0.3, 0.7, 0.95}) {
    const std::string cut = whole.substr(0, static_cast<size_t>(part * whole.size()));
    const Reading reading = read_through(scratch_.text_file("cut.rawlog", cut));
    EXPECT_THAT(reading.damage, AllOf(HasSubstr("is truncated"), HasSubstr("at byte"),
                                      HasSubstr("whole records"), HasSubstr("cut.rawlog")));
    EXPECT_NEAR(static_cast<double>(reading.counts.imu_samples), 2000 * part, 200);
  }
  // Only the last byte of the checksum is missing: MRPT's own stream takes this for whole.
  const Reading reading =
      read_through(scratch_.text_file("cut.rawlog", whole.substr(0, whole.size() - 1)));
  EXPECT_THAT(reading.damage, HasSubstr("is truncated"));
  EXPECT_EQ(reading.counts.imu_samples, 2000);
}

TEST_F(BadLogs, TruncatedAnywhere) {
  const std::string whole = test::contents(good_log<test::PlainLog>("a.rawlog", 3));
  const size_t two_records = test::contents(good_log<test::PlainLog>("b.rawlog", 1)).size();
  const size_t imu_record = (whole.size() - two_records) / 2;
  for (size_t size = two_records; size < whole.size(); ++size) {
    const Reading reading = read_through(scratch_.text_file("cut.rawlog", whole.substr(0, size)));
    const size_t beyond = size - two_records;
    EXPECT_EQ(reading.counts.imu_samples, static_cast<int64_t>(1 + beyond / imu_record));
    // At a record's end a plain log shows nothing.
    if (beyond % imu_record == 0) {
      EXPECT_EQ(reading.damage, "");
    } else {
      EXPECT_THAT(reading.damage, HasSubstr("truncated: it ends at byte " + std::to_string(size)));
    }
  }
  const std::string early = scratch_.text_file("cut.rawlog", whole.substr(0, two_records / 2));
  EXPECT_THAT(error(early), HasSubstr("truncated"));
}

TEST_F(BadLogs, DamagedGzipGivesEveryByteBefore) {
  const std::string whole = test::contents(good_log<test::GzLog>("a.rawlog", 2000));
  std::string bytes = whole;
  const size_t at = bytes.size() / 2;
  for (size_t i = at; i < at + 40; ++i) bytes[i] ^= 0x5A;
  const Reading reading = read_through(scratch_.text_file("bad.rawlog", bytes));
  EXPECT_THAT(reading.damage, AllOf(HasSubstr("is damaged"), HasSubstr("of the file")));
  EXPECT_NEAR(static_cast<double>(reading.counts.imu_samples), 1000, 150);
}

TEST_F(BadLogs, WrongChecksumOfAWholeGzip) {
  std::string bytes = test::contents(good_log<test::GzLog>("a.rawlog", 200));
  bytes[bytes.size() - 6] ^= 1;
  const Reading reading = read_through(scratch_.text_file("bad.rawlog", bytes));
  EXPECT_THAT(reading.damage, AllOf(HasSubstr("is damaged"), HasSubstr("220 whole records")));
  EXPECT_EQ(reading.counts.imu_samples, 200);
}

TEST_F(BadLogs, DamagedRecordIsNamedWithItsByte) {
  const std::string whole = test::contents(good_log<test::PlainLog>("a.rawlog", 12));
  const size_t last = whole.rfind("mrpt::obs::CObservationIMU") - 1;
  std::string bytes = whole;
  bytes[last + 40] ^= 0x04;  // within the name of the pose's class
  const Reading reading = read_through(scratch_.text_file("bad.rawlog", bytes));
  EXPECT_THAT(reading.damage, AllOf(HasSubstr("damaged at byte " + std::to_string(last) + " of"),
                                    HasSubstr("record 14 (CObservationIMU)")));
  EXPECT_EQ(reading.counts.imu_samples, 11);
}

/// Every bit of a log turned, one after another: what comes out is a reading or our error, and no
/// length that was read makes us take memory.
TEST_F(BadLogs, EveryFlippedBit) {
#ifdef __SANITIZE_ADDRESS__
  constexpr long kMostKilobytes = 512 << 10;  // the sanitizer keeps 256 MB of what is freed
#else
  constexpr long kMostKilobytes = 32 << 10;
#endif
  const std::string path = good_log<test::PlainLog>("a.rawlog", 2);
  const std::string whole = test::contents(path);
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  const auto put = [&file](size_t at, char byte) {
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte).flush();
  };
  rusage before{};
  getrusage(RUSAGE_SELF, &before);
  int noticed = 0;
  for (size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    const size_t at = bit / 8;
    put(at, static_cast<char>(whole[at] ^ (1 << (bit % 8))));
    try {
      if (!read_through(path).damage.empty()) ++noticed;
    } catch (const DataError& problem) {
      EXPECT_THAT(problem.what(), ::testing::Not(HasSubstr("\n")));
      ++noticed;
    }
    put(at, whole[at]);
  }
  EXPECT_GT(noticed, 500);  // of some 9000: the others turn values, labels or stamps
  rusage after{};
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, kMostKilobytes);
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

TEST_F(BadLogs, UnknownClassesAreSkipped) {
  std::string bytes = test::contents(good_log<test::PlainLog>("a.rawlog", 12));
  bytes.replace(bytes.rfind("CObservationGPS"), 15, "CObservationXYZ");
  const Reading reading = read_through(scratch_.text_file("a.rawlog", bytes));
  EXPECT_EQ(reading.damage, "");
  EXPECT_EQ(reading.counts.imu_samples, 12);
  EXPECT_EQ(reading.counts.fixes, 1);
  EXPECT_EQ(reading.counts.skipped.at("CObservationXYZ"), 1);
}

/// Samples of which every tenth comes after its successor, with rates that tell their places.
TEST_F(BadLogs, ImuSamplesOutOfOrderArePutInOrder) {
  const auto sample = [](int64_t i) {
    auto imu = imu_at(kBegin + i * 10 * kMs);
    imu.set(mrpt::obs::IMU_WZ, 0.001 * static_cast<double>(i));
    return imu;
  };
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    log.write(gps_at(kBegin));
    for (int64_t i = 0; i < 300; ++i) {
      const bool first = i % 10 == 4, second = i % 10 == 5;
      log.write(sample(first ? i + 1 : second ? i - 1 : i));
    }
  }
  RawlogSource source(scratch_.path("a.rawlog"));
  int64_t next = 1;
  while (const std::optional<Measurement> measurement = source.next()) {
    const auto* increment = std::get_if<ImuIncrement>(&*measurement);
    if (increment == nullptr) continue;
    EXPECT_EQ(increment->t_end_ns, kBegin + next * 10 * kMs);
    EXPECT_NEAR(increment->dtheta_b.z(), 0.01 * 0.001 * static_cast<double>(next), 1e-12);
    ++next;
  }
  EXPECT_EQ(next, 300);
  EXPECT_EQ(source.counts().imu_reordered, 30);
  ASSERT_EQ(source.notices().size(), 1U);
  EXPECT_THAT(source.notices()[0].text, HasSubstr("30 IMU samples came after later ones"));
}

TEST_F(BadLogs, ImuSamplesThatComeTooLateAreSkipped) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    log.write(gps_at(kBegin + 100 * kMs));
    for (int64_t i = 0; i < 600; ++i) {
      log.write(imu_at(kBegin + (i >= 400 && i < 450 ? i - 350 : i) * 10 * kMs + 5 * kMs));
    }
  }
  const Reading reading = read_through(scratch_.path("a.rawlog"));
  EXPECT_EQ(reading.counts.imu_samples, 550);
  EXPECT_EQ(reading.counts.skipped.at("CObservationIMU (comes too late)"), 50);
  EXPECT_EQ(reading.notices.at(0).t_ns, kBegin + 505 * kMs);
}

TEST_F(BadLogs, AStampFarAheadOfThoseThatFollowIsSkipped) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    log.write(gps_at(kBegin));
    for (int64_t i = 0; i < 300; ++i) {
      log.write(imu_at(kBegin + i * 10 * kMs + (i == 100 ? 3600'000 * kMs : 0)));
    }
    log.write(imu_at(kBegin + 9000 * kMs));  // after a hole, and confirmed by
    log.write(imu_at(kBegin + 9010 * kMs));
  }
  const Reading reading = read_through(scratch_.path("a.rawlog"));
  EXPECT_EQ(reading.counts.imu_samples, 301);
  EXPECT_EQ(reading.counts.skipped.at("CObservationIMU (stamp ahead of those that follow)"), 1);
}

TEST_F(BadLogs, ALogThatIsNotInOrder) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    log.write(gps_at(kBegin));
    for (int64_t i = 0; i < 1000; ++i) log.write(imu_at(kBegin + (i + 500) % 1000 * 10 * kMs));
  }
  EXPECT_THAT(error(scratch_.path("a.rawlog")),
              AllOf(HasSubstr("record 602 at 2020-09-13T12:26:41.000Z"),
                    HasSubstr("more than 2 s after later ones, the last before them of "
                              "2020-09-13T12:26:47.990Z"),
                    HasSubstr("sort the log")));
}

TEST_F(BadLogs, NothingFinite) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    auto imu = imu_at(kBegin);
    imu.set(mrpt::obs::IMU_WZ, std::nan(""));
    log.write(imu);
    log.write(gps_at(kBegin));
  }
  EXPECT_THAT(error(scratch_.path("a.rawlog")), HasSubstr("no IMU sample of it is finite"));
}

TEST_F(BadLogs, PositionsOfZeroAreNoFixes) {
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    for (int64_t i = 0; i < 40; ++i) {
      log.write(imu_at(kBegin + i * 10 * kMs));
      auto gps = gps_at(kBegin + i * 10 * kMs);
      auto message = test::gga();
      if (i < 10) message.fields.latitude_degrees = message.fields.longitude_degrees = 0;
      gps.setMsg(message);
      log.write(gps);
    }
  }
  const Reading reading = read_through(scratch_.path("a.rawlog"));
  EXPECT_EQ(reading.counts.fixes, 30);
  ASSERT_EQ(reading.notices.size(), 1U);
  EXPECT_THAT(reading.notices[0].text, HasSubstr("10 x CObservationGPS (latitude and longitude"));
  EXPECT_EQ(reading.notices[0].t_ns, kBegin);
}

TEST_F(BadLogs, ValuesThatAreNotFiniteAreSkippedCountedAndNamed) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  {
    test::GzLog log(scratch_.path("a.rawlog"));
    for (int64_t i = 0; i < 40; ++i) {
      auto imu = imu_at(kBegin + i * 10 * kMs);
      if (i == 20) imu.set(mrpt::obs::IMU_WY, std::nan(""));
      if (i == 25) imu.set(mrpt::obs::IMU_Z_ACC, -kInfinity);
      log.write(imu);
      auto gps = gps_at(kBegin + i * 10 * kMs);
      auto message = test::gga();
      if (i == 0 || i == 10) message.fields.altitude_meters = kInfinity;
      gps.setMsg(message);
      log.write(gps);
    }
  }
  const Reading reading = read_through(scratch_.path("a.rawlog"));
  EXPECT_EQ(reading.counts.imu_samples, 38);
  EXPECT_EQ(reading.counts.fixes, 38);
  ASSERT_EQ(reading.notices.size(), 2U);
  EXPECT_EQ(reading.notices[0].text, "2 x CObservationGPS (not finite) not used, the first here");
  EXPECT_EQ(reading.notices[0].t_ns, kBegin);
  EXPECT_EQ(reading.notices[1].text, "2 x CObservationIMU (not finite) not used, the first here");
  EXPECT_EQ(reading.notices[1].t_ns, kBegin + 200 * kMs);
  const RawlogInfo info = read_rawlog_info(scratch_.path("a.rawlog"));
  EXPECT_EQ(info.imu_not_finite, 2);
  EXPECT_EQ(info.first_imu_not_finite_ns, kBegin + 200 * kMs);
  ASSERT_EQ(info.receivers.size(), 1U);
  EXPECT_EQ(info.receivers[0].not_finite, 2);
  EXPECT_EQ(info.receivers[0].first_not_finite_ns, kBegin);
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
}  // namespace foucault::rawlog
