#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/rawlog/import_nmea.h"
#include "foucault/rawlog/rawlog_info.h"
#include "foucault/rawlog/rawlog_source.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A sentence with its checksum.
std::string sentence(const std::string& body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return fmt::format("${}*{:02X}\r\n", body, sum);
}

class Nmea : public ::testing::Test {
 protected:
  Nmea() {
    options_.gnss = scratch_.path("a.nmea");
    options_.out = scratch_.path("out.rawlog");
    mapping("");
  }

  ImportSummary import(const std::string& text) {
    scratch_.text_file("a.nmea", text);
    return import_nmea(options_);
  }

  std::vector<GnssFix> fixes(const std::string& text) {
    import(text);
    RawlogSource source(options_.out);
    std::vector<GnssFix> found;
    while (const std::optional<Measurement> m = source.next()) {
      if (const auto* fix = std::get_if<GnssFix>(&*m)) found.push_back(*fix);
    }
    return found;
  }

  template <class Error>
  std::string error(const std::string& text) {
    const std::string what = error_of<Error>([&] { import(text); });
    EXPECT_FALSE(std::filesystem::exists(options_.out));
    return what;
  }

  void mapping(const std::string& more) {
    options_.mapping = test::imu_at_all_times(scratch_, more);
  }

  static std::string gga(const std::string& time, int quality = 1) {
    return sentence(fmt::format("GPGGA,{},4730.0000,N,00815.0000,W,{},09,2.0,400.25,M,47.5,M,,",
                                time, quality));
  }
  static std::string rmc(const std::string& time, const std::string& date,
                         const std::string& velocity = "10.0,90.0") {
    return sentence(
        fmt::format("GPRMC,{},A,4730.0000,N,00815.0000,W,{},{},,,A", time, velocity, date));
  }

  Scratch scratch_;
  NmeaImport options_;
};

constexpr int64_t kNoon = 1'707'307'200'000'000'000;  ///< 2024-02-07T12:00:00Z
constexpr int64_t kSecond = kNanosecondsPerSecond;

TEST_F(Nmea, SentencesOfAnEpochAreJoined) {
  const auto found =
      fixes(gga("120000.50", 4) + rmc("120000.50", "070224") +
            sentence("GPGST,120000.50,0.9,0.9,0.9,45.0,0.02,0.03,0.05") + gga("120001.50", 5) +
            sentence("GPGST,120001.50,0.9,0.9,0.9,45.0,0.2,0.3,0.5"));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].t_ns, kNoon + kSecond / 2);
  EXPECT_EQ(found[0].quality, FixQuality::fixed_rtk);
  EXPECT_EQ(found[0].details.satellites, 9);
  EXPECT_EQ(found[0].details.hdop, 2);
  EXPECT_NEAR(found[0].antenna.latitude / kDegree, 47.5, 1e-12);
  EXPECT_NEAR(found[0].antenna.longitude / kDegree, -8.25, 1e-12);
  EXPECT_DOUBLE_EQ(found[0].antenna.height, 447.75);
  const Eigen::Vector3d sigma = found[0].position_covariance.diagonal().cwiseSqrt();
  EXPECT_LT((sigma - Eigen::Vector3d(0.02, 0.03, 0.05)).norm(), 1e-6);
  ASSERT_TRUE(found[0].velocity_n);
  EXPECT_LT((*found[0].velocity_n - Eigen::Vector3d(0, 18520.0 / 3600, 0)).norm(), 1e-12);
  EXPECT_EQ(found[1].t_ns, kNoon + 3 * kSecond / 2);
  EXPECT_EQ(found[1].quality, FixQuality::float_rtk);
  EXPECT_FALSE(found[1].velocity_n);
}

TEST_F(Nmea, TheOrderOfSentencesAndTalkersDoNotMatter) {
  const std::string gst = "120000.00,0.9,0.9,0.9,45.0,0.02,0.03,0.05";
  const std::vector<std::string> sentences{gga("120000.00"), rmc("120000.00", "070224"),
                                           sentence("GPGST," + gst)};
  const GnssFix expected = fixes(sentences[0] + sentences[1] + sentences[2]).at(0);
  for (const std::string& text :
       {sentences[1] + sentences[0] + sentences[2], sentences[2] + sentences[1] + sentences[0]}) {
    const GnssFix fix = fixes(text).at(0);
    EXPECT_EQ(fix.t_ns, expected.t_ns);
    EXPECT_EQ(fix.position_covariance, expected.position_covariance);
    EXPECT_EQ(*fix.velocity_n, *expected.velocity_n);
  }
  for (const char* talker : {"GN", "GL", "GA", "GB", "BD", "GQ", "GI"}) {
    const std::string text =
        sentence(std::string(talker) +
                 "GGA,120000.00,4730.0000,N,00815.0000,W,1,09,2.0,400.25,M,47.5,M,,") +
        sentence(std::string(talker) +
                 "RMC,120000.00,A,4730.0000,N,00815.0000,W,10.0,90.0,070224,,,A");
    EXPECT_EQ(fixes(text).at(0).t_ns, expected.t_ns) << talker;
  }
}

TEST_F(Nmea, DaysRollOverAtMidnight) {
  const auto found = fixes(gga("235958.00") + gga("235959.00") + rmc("235959.00", "311223") +
                           gga("000000.00") + gga("000001.00"));
  ASSERT_EQ(found.size(), 4U);
  constexpr int64_t kMidnight = 1'704'067'200'000'000'000;  // 2024-01-01
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(found[static_cast<size_t>(i)].t_ns, kMidnight + (i - 2) * kSecond);
}

TEST_F(Nmea, TheDateMayComeBehindMidnight) {
  const auto found =
      fixes(gga("235959.00") + gga("000000.00") + sentence("GPZDA,000000.00,01,01,2024,00,00"));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].t_ns, 1'704'067'199'000'000'000);
  EXPECT_EQ(found[1].t_ns, 1'704'067'200'000'000'000);
}

TEST_F(Nmea, ADateIsNeeded) {
  const std::string text = gga("120000.00") + gga("120001.00");
  EXPECT_THAT(error<UsageError>(text), AllOf(HasSubstr("no date"), HasSubstr("gnss.time.date")));
  mapping("gnss: {time: {date: 2024-02-07}}\n");
  EXPECT_EQ(fixes(text).at(1).t_ns, kNoon + kSecond);
}

TEST_F(Nmea, VelocityOfVtgWithoutRmc) {
  const std::string zda = sentence("GPZDA,120000.00,07,02,2024,00,00");
  const std::string vtg = sentence("GPVTG,180.0,T,,M,20.0,N,37.04,K,A");
  const GnssFix alone = fixes(zda + gga("120000.00") + vtg).at(0);
  EXPECT_NEAR(alone.velocity_n->x(), -37.04 / 3.6, 1e-9);
  EXPECT_NEAR(std::sqrt(alone.velocity_covariance(2, 2)), 10, 1e-5);
  EXPECT_NEAR(fixes(gga("120000.00") + rmc("120000.00", "070224") + vtg).at(0).velocity_n->x(), 0,
              1e-12);
  EXPECT_FALSE(
      fixes(zda + gga("120000.00") + sentence("GPVTG,,T,,M,0.0,N,0.0,K,A")).at(0).velocity_n);
  EXPECT_FALSE(
      fixes(zda + gga("120000.00") + sentence("GPVTG,9,T,,M,1.0,N,1.0,K,N")).at(0).velocity_n);
  mapping("gnss: {velocity: false}\n");
  EXPECT_FALSE(fixes(zda + gga("120000.00") + vtg).at(0).velocity_n);
}

TEST_F(Nmea, SigmasByHdopAreSaid) {
  const std::string text = gga("120000.00", 2) + rmc("120000.00", "070224", ",");
  EXPECT_THAT(
      import(text).gnss.notices,
      ElementsAre(AllOf(HasSubstr("HDOP times 0.7 m (differential)"), HasSubstr("gnss.sigma_m"))));
  const Eigen::Vector3d assumed = fixes(text).at(0).position_covariance.diagonal().cwiseSqrt();
  EXPECT_LT((assumed - Eigen::Vector3d(1.4, 1.4, 2.8)).norm(), 1e-5);  // stored as float
  mapping("gnss: {sigma_m: [0.5, 0.75, 1.5]}\n");
  EXPECT_TRUE(import(text).gnss.notices.empty());
  const Eigen::Vector3d given = fixes(text).at(0).position_covariance.diagonal().cwiseSqrt();
  EXPECT_LT((given - Eigen::Vector3d(1, 1.5, 3)).norm(), 1e-5);
}

TEST_F(Nmea, WrongChecksumsAreCounted) {
  std::string wrong = gga("120001.00");
  wrong[20] = '9';
  const std::string cut = gga("120002.00").substr(0, 40) + "\n";
  const ImportSummary summary = import("garbage\n" + gga("120000.00") + rmc("120000.00", "070224") +
                                       wrong + cut + "logged " + gga("120003.00"));
  EXPECT_EQ(summary.gnss.written, 2);
  EXPECT_THAT(summary.gnss.notices,
              Contains(AllOf(HasSubstr("left out 2 of 5 sentences"), HasSubstr("line 4"))));
}

/// One a line; one that is estimated or no number is none.
TEST_F(Nmea, HeadingsOfTwoAntennas) {
  const std::string first = gga("120000.00") + rmc("120000.00", "070224");
  const std::string log = first + sentence("GPHDT,274.07,T") + gga("120001.00") +
                          sentence("GPTHS,77.52,A") + gga("120002.00") + sentence("GPTHS,77.52,E") +
                          gga("120003.00") +
                          sentence("PASHR,120003.00,100.5,T,1.0,2.0,0.1,0.2,0.3,0.25,1,1") +
                          gga("120004.00") + sentence("GPHDT,,T");
  EXPECT_THAT(import(log).gnss.notices, Contains(HasSubstr("assumed sigma of 0.5 deg")));
  const std::vector<GnssFix> found = fixes(log);
  ASSERT_EQ(found.size(), 5U);
  EXPECT_NEAR(found[0].heading->azimuth, (274.07 - 360) * kDegree, 1e-12);
  EXPECT_NEAR(found[0].heading->sigma, 0.5 * kDegree, 1e-12);
  EXPECT_NEAR(found[1].heading->azimuth, 77.52 * kDegree, 1e-12);
  EXPECT_FALSE(found[2].heading);
  EXPECT_NEAR(found[3].heading->azimuth, 100.5 * kDegree, 1e-12);
  EXPECT_NEAR(found[3].heading->sigma, 0.25 * kDegree, 1e-12);
  EXPECT_FALSE(found[4].heading);
  mapping("gnss: {heading_sigma_deg: 2}\n");
  EXPECT_NEAR(fixes(log)[0].heading->sigma, 2 * kDegree, 1e-12);
}

TEST_F(Nmea, BinaryMessagesBetweenAndSentencesWithoutALineEach) {
  using namespace std::string_literals;
  const std::string binary = "\xB5\x62\x01\x07\0\0$\x10*9\0"s;
  std::string first = gga("120000.00");
  first.resize(first.size() - 2);
  const ImportSummary summary =
      import(binary + first + rmc("120000.00", "070224") + binary + gga("120001.00") + binary);
  EXPECT_EQ(summary.gnss.written, 2);
  EXPECT_EQ(summary.with_velocity, 1);
  EXPECT_THAT(summary.gnss.notices, ::testing::Each(::testing::Not(HasSubstr("left out"))));
}

TEST_F(Nmea, WithoutAFixThereIsNone) {
  const ImportSummary summary =
      import(sentence("GPGGA,,,,,,0,,,,M,,M,,") + sentence("GPGGA,115959.00,,,,,0,,,,M,,M,,") +
             sentence("GPRMC,115959.00,V,,,,,,,060180,,,N") + gga("120000.00") +
             rmc("120000.00", "070224") + gga("120001.00", 6));
  EXPECT_EQ(summary.gnss.written, 1);
  EXPECT_EQ(summary.gnss.first_ns, kNoon);
  EXPECT_EQ(summary.gnss.without_fix, 3);
}

TEST_F(Nmea, GnsCountsAsGga) {
  const std::string rest = ",12,0.5,400.25,47.5,1.0,0000";
  const auto gns = [&](const std::string& modes) {
    return sentence("GNGNS,120000.00,4730.0000,N,00815.0000,W," + modes + rest);
  };
  for (const auto& [modes, quality] :
       {std::pair{"RRNN", FixQuality::fixed_rtk}, std::pair{"ANF", FixQuality::float_rtk},
        std::pair{"AD", FixQuality::differential}, std::pair{"AA", FixQuality::single}}) {
    const GnssFix fix = fixes(gns(modes) + rmc("120000.00", "070224")).at(0);
    EXPECT_EQ(fix.quality, quality) << modes;
    EXPECT_DOUBLE_EQ(fix.antenna.height, 447.75);
    EXPECT_EQ(fix.details.satellites, 12);
    EXPECT_EQ(fix.details.correction_age, 1);
  }
  const ImportSummary summary = import(gns("NNE") + gga("120001.00") + rmc("120001.00", "070224"));
  EXPECT_EQ(summary.gnss.without_fix, 1);
  EXPECT_EQ(summary.gnss.written, 1);
}

/// u-blox's own: above the ellipsoid, hAcc of both axes together, km/h; its date comes apart.
TEST_F(Nmea, PubxAlone) {
  const auto pubx = [](const std::string& time, const std::string& status) {
    return sentence("PUBX,00," + time + ",4730.0000,N,00815.0000,W,447.75," + status +
                    ",1.5,2.5,36.0,90.0,0.0,,0.9,1.2,0.8,9,0,0");
  };
  EXPECT_THAT(error<UsageError>(pubx("120000.00", "G3")), HasSubstr("gnss.time.date"));
  const auto found = fixes(pubx("120000.00", "G3") +
                           sentence("PUBX,04,120000.00,070224,302400.00,2300,18,1,1.0,21") +
                           pubx("120001.00", "DR"));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].t_ns, kNoon);
  EXPECT_DOUBLE_EQ(found[0].antenna.height, 447.75);
  EXPECT_EQ(found[0].details.satellites, 9);
  const Eigen::Vector3d sigma = found[0].position_covariance.diagonal().cwiseSqrt();
  EXPECT_LT((sigma - Eigen::Vector3d(1.5 / std::sqrt(2.0), 1.5 / std::sqrt(2.0), 2.5)).norm(),
            1e-6);
  EXPECT_LT((*found[0].velocity_n - Eigen::Vector3d(0, 10, 0)).norm(), 1e-9);
}

TEST_F(Nmea, RmcAloneHasNoHeight) {
  const std::string text = rmc("120000.00", "070224") + rmc("120001.00", "070224");
  const ImportSummary summary = import(text);
  EXPECT_EQ(summary.gnss.written, 2);
  EXPECT_THAT(summary.gnss.notices, Contains(AllOf(HasSubstr("no heights"), HasSubstr("1000 m"),
                                                   HasSubstr("gnss.height_m"))));
  const GnssFix fix = fixes(text).at(0);
  EXPECT_EQ(fix.t_ns, kNoon);
  EXPECT_NEAR(fix.antenna.longitude / kDegree, -8.25, 1e-12);
  EXPECT_EQ(fix.antenna.height, 0);
  EXPECT_NEAR(std::sqrt(fix.position_covariance(2, 2)), 1000, 1e-3);
  mapping("gnss: {height_m: 450, sigma_m: [1, 2, 5]}\n");
  EXPECT_EQ(fixes(text).at(0).antenna.height, 450);
  EXPECT_NEAR(std::sqrt(fixes(text).at(0).position_covariance(2, 2)), 5, 1e-6);
  // One GGA, and RMC is no position.
  EXPECT_EQ(import(text + gga("120002.00")).gnss.written, 1);
}

TEST_F(Nmea, WithoutAnyChecksumAllAreTaken) {
  std::string text = gga("120000.00") + rmc("120000.00", "070224") + gga("120001.00");
  const std::string right = text;
  for (size_t at = text.find('*'); at != std::string::npos; at = text.find('*')) text.erase(at, 3);
  const ImportSummary summary = import(text);
  EXPECT_EQ(summary.gnss.written, 2);
  EXPECT_THAT(summary.gnss.notices, Contains(HasSubstr("no sentence has a checksum")));
  std::string one = right;
  one.erase(one.find('*'), 3);  // then it is damaged
  EXPECT_EQ(import(one).gnss.written, 1);
}

TEST_F(Nmea, TheSeparationMayComeFromTheMapping) {
  const std::string text =
      sentence("GPGGA,120000.00,4730.0000,N,00815.0000,W,1,09,2.0,400.25,M,,M,,") +
      rmc("120000.00", "070224");
  EXPECT_THAT(error<DataError>(text),
              AllOf(HasSubstr("a.nmea:1: "), HasSubstr("geoid_separation_m")));
  mapping("gnss: {geoid_separation_m: 10}\n");
  EXPECT_DOUBLE_EQ(fixes(text).at(0).antenna.height, 410.25);
}

TEST_F(Nmea, BadSentencesStopWithFileAndLine) {
  const std::string good = gga("120000.00") + rmc("120000.00", "070224");
  for (const char* body :
       {"GPGGA,120001.00,4760.0000,N,00815.0000,W,1,09,2.0,400,M,47,M,,",
        "GPGGA,120001.00,4730.0000,X,00815.0000,W,1,09,2.0,400,M,47,M,,",
        "GPGGA,120001.00,9130.0000,N,00815.0000,W,1,09,2.0,400,M,47,M,,",
        "GPGGA,120001.00,4730.0000,N,00815.0000,W,11,09,2.0,400,M,47,M,,",
        "GPGGA,250001.00,4730.0000,N,00815.0000,W,1,09,2.0,400,M,47,M,,",
        "GPGGA,120001.00,4730.0000,N,00815.0000,W,1,09,2.0,1e300,M,47,M,,",
        "GPGGA,120001.00,4730.0000,N,00815.0000,W,1,09,1e300,400,M,47,M,,",
        "GPGGA,115959.00,4730.0000,N,00815.0000,W,1,09,2.0,400,M,47,M,,",
        "GPGGA,120001.00,4730.0000,N,00815.0000,W,1", "GPZDA,120001.00,41,02,2024,00,00"}) {
    const std::string text = good + sentence(body) + gga("120002.00");
    EXPECT_THAT(error<DataError>(text),
                AllOf(HasSubstr("a.nmea:3: "), HasSubstr("--skip-bad-rows")))
        << body;
    options_.skip_bad_rows = true;
    const ImportSummary summary = import(text);
    EXPECT_EQ(summary.gnss.written, 2) << body;
    EXPECT_EQ(summary.gnss.skipped, 1) << body;
    std::filesystem::remove(options_.out);
    options_.skip_bad_rows = false;
  }
}

TEST_F(Nmea, WhatIsNoNmeaIsSaid) {
  EXPECT_THAT(error<DataError>("time,lat,lon\n1,2,3\n"), HasSubstr("no position in NMEA"));
  EXPECT_THAT(error<DataError>("$GPGGA,120000.00,4730.0,N,00815.0,W,1,09,2.0,400,M,47,M,,*00\n"),
              HasSubstr("of 1 sentences 1 have a wrong checksum or none"));
  options_.mapping.clear();
  options_.imu = scratch_.path("imu.csv");
  EXPECT_THAT(error<UsageError>(gga("120000.00")), HasSubstr("need --mapping"));
}

TEST_F(Nmea, WithAnImuTableOrWithout) {
  const std::string text = gga("120000.00") + rmc("120000.00", "070224");
  mapping("lever_arm_m: [1, 2, 3]\n");
  const ImportSummary both = import(text);
  EXPECT_EQ(both.imu.written, 4);
  EXPECT_EQ(both.gnss.first_ns, kNoon);
  EXPECT_EQ(both.lever_arm_v, Eigen::Vector3d(1, 2, 3));
  options_.mapping.clear();
  const ImportSummary alone = import(text);
  EXPECT_EQ(alone.imu.written, 0);
  EXPECT_EQ(alone.gnss.first_ns, kNoon);
  EXPECT_EQ(read_rawlog_info(options_.out).receivers.at(0).qualities.at(FixQuality::single), 1);
}

/// Sentences that RTKLIB's rnx2rtkp 2.4.3 b34 wrote (out-solformat=nmea), of an epoch of which its
/// .pos says 2023/01/08 10:00:01 GPST.
TEST_F(Nmea, WrittenByRtklib) {
  const GnssFix fix =
      fixes(
          "$GNRMC,095943.00,A,4846.8469693,N,00910.4010421,E,10.17,357.91,080123,0.0,E,R,V*7D\r\n"
          "$GNGGA,095943.00,4846.8469693,N,00910.4010421,E,4,06,1.0,271.720,M,48.280,M,0.0,"
          "0000*50\r\n")
          .at(0);
  EXPECT_EQ(fix.t_ns, gps_to_unix_ns(2244, 36001));
  EXPECT_NEAR(fix.antenna.latitude / kDegree, 48.78078282, 1e-8);
  EXPECT_NEAR(fix.antenna.height, 320.000, 1e-9);
  EXPECT_NEAR(fix.velocity_n->norm(), 5.232, 1e-3);
}

}  // namespace
}  // namespace foucault::rawlog
