#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "foucault/rawlog/import_csv.h"
#include "foucault/rawlog/rawlog_source.h"
#include "scratch.h"

/// The mapping that ships for exports of GrafNav. Their shape is that of
/// luftkode/plotinator3000 test_data/csv/20250909_05_GP1_PPP.txt (GrafNav 9.00).
namespace foucault::rawlog {
namespace {

using test::error_of;
using test::Scratch;

constexpr const char* kHead =
    "Project:     Trip\r\n"
    "\r\n"
    "Program:     GrafNav Version 9.00.2207\r\n"
    "Source:      GNSS Epochs(PPP Combined)\r\n"
    "Datum:       WGS84 (2025.690)\r\n"
    "UTC Offset:  18 s\r\n"
    "Column/Variable Contents, Units and Description:\r\n"
    "  01: SeqNum                                      Sequence number, user defined value\r\n"
    "  02: UTCDate      Year/Month/Day                 Date of epoch or feature (UTC time)\r\n"
    "  12: H-Ell        Metres                         Height above the current ellipsoid\r\n"
    "\r\n"
    "SeqNum    UTCDate     UTCTime       Latitude      Longitude        H-MSL Q   Undulation"
    "        H-Ell NS     VUp\r\n"
    "            (YMD)       (HMS)          (deg)          (deg)          (m)            (m)"
    "          (m)     (km/h)\r\n";

TEST(GrafNav, TheShippedMapping) {
  const Scratch scratch;
  std::string imu = "time,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n";
  constexpr int64_t kBegin = 1'757'435'840;  // 2025-09-09 16:37:20
  for (int i = 0; i < 500; ++i) {
    imu += fmt::format("{}.{:02},0.001,0,0,0,0,-9.81\n", kBegin + i / 100, i % 100);
  }
  scratch.text_file("imu.csv", imu);
  std::string fixes = kHead;
  for (int i = 1; i < 5; ++i) {
    fixes += fmt::format(
        "{}      2025/09/09 16:37:2{}.50  56.1609498630  10.0376824505       34.200 {}       39.195"
        "       73.394 15   0.024\r\n",
        i, i, i);
  }
  scratch.text_file("grafnav.txt", fixes);
  CsvImport import;
  import.mapping = std::string(FOUCAULT_SOURCE_DIR) + "/rawlog/mappings/grafnav.yaml";
  import.data_dir = scratch.path("");
  import.out = scratch.path("out.rawlog");
  EXPECT_EQ(import_csv(import).gnss.written, 4);
  RawlogSource source(import.out);
  std::vector<GnssFix> found;
  while (const std::optional<Measurement> m = source.next()) {
    if (const GnssFix* fix = std::get_if<GnssFix>(&*m)) found.push_back(*fix);
  }
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].t_ns, (kBegin + 1) * 1'000'000'000 + 500'000'000);
  EXPECT_NEAR(found[0].antenna.latitude, 56.1609498630 * kDegree, 1e-15);
  EXPECT_NEAR(found[0].antenna.height, 73.394, 1e-9);
  // A row that is cut off, as the real file's last one.
  scratch.text_file("grafnav.txt", fixes + "5      2025/09/09 16:37:25.50  56.16094\r\n");
  EXPECT_THAT(error_of<DataError>([&] { import_csv(import); }),
              ::testing::HasSubstr("grafnav.txt:18: 4 columns, 11 expected"));
}

}  // namespace
}  // namespace foucault::rawlog
