#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinate_text.h"
#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/rawlog/import_csv.h"
#include "foucault/rawlog/rawlog_source.h"
#include "scratch.h"
#include "shared_stamps.h"

/// Positions, units and rows of an IMU as tables have them: all give what the plain one gives.
namespace foucault::rawlog {
namespace {

using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int64_t kMs = kNanosecondsPerSecond / 1000;
constexpr const char* kClock = "time: {system: gps_sow, gps_week: 2200}";
constexpr const char* kDegrees = "latitude: lat, longitude: lon, height: h";

class UnitsOfTables : public ::testing::Test {
 protected:
  UnitsOfTables() {
    options_.mapping = scratch_.path("mapping.yaml");
    options_.out = scratch_.path("out.rawlog");
    std::string rows = "t,gx,gy,gz,ax,ay,az\n";
    for (int i = 0; i < 5; ++i) rows += fmt::format("{:.2f},1,2,3,0.5,0.25,-9.5\n", 100 + 0.01 * i);
    imu(rows);
  }

  void imu(const std::string& text) { scratch_.text_file("imu.csv", text); }

  ImportSummary run(const std::string& gnss, const std::string& columns = kDegrees,
                    const std::string& keys = "") {
    scratch_.text_file("gnss.csv", gnss);
    scratch_.text_file(
        "mapping.yaml",
        fmt::format("imu: {{file: imu.csv, columns: {{time: t, gyro_x: gx, gyro_y: gy, gyro_z: gz, "
                    "accel_x: ax, accel_y: ay, accel_z: az{}}}, {}{}}}\n"
                    "gnss: {{file: gnss.csv, columns: {{time: t, {}}}, {}{}{}}}\n",
                    imu_columns_, kClock, imu_keys_, columns, kClock, sigma_, keys));
    return import_csv(options_);
  }
  ImportSummary with_imu(const std::string& text, const std::string& keys = "") {
    imu(text);
    imu_keys_ = keys;
    return run("t,lat,lon,h\n100.01,47.5,-8.25,400.5\n");
  }
  std::string refusal(const std::string& gnss, const std::string& columns = kDegrees,
                      const std::string& keys = "") {
    return error_of<DataError>([&] { run(gnss, columns, keys); });
  }

  template <class Kind>
  std::vector<Kind> all() const {
    RawlogSource source(options_.out, imu::SampleKind::interval_mean);
    std::vector<Kind> found;
    while (const std::optional<Measurement> m = source.next()) {
      if (const Kind* one = std::get_if<Kind>(&*m)) found.push_back(*one);
    }
    return found;
  }

  void expect_place(double latitude = 47.5, double longitude = -8.25, double height = 400.5) {
    const GnssFix fix = all<GnssFix>().at(0);
    EXPECT_NEAR(fix.antenna.latitude / kDegree, latitude, 1e-10);
    EXPECT_NEAR(fix.antenna.longitude / kDegree, longitude, 1e-10);
    EXPECT_NEAR(fix.antenna.height, height, 1e-6);
  }

  std::string imu_columns_, imu_keys_;
  std::string sigma_ = ", sigma_m: [1, 2, 3]";
  Scratch scratch_;
  CsvImport options_;
};

// Angles ----------------------------------------------------------------------------------------

TEST(CoordinateText, OneCell) {
  for (const char* cell :
       {"-8.25", "-8 15 0", "-8:15:00.0",
        "8\xC2\xB0"
        "15'00\"W",
        "8\xC2\xB0 15' 0\" W", "W8 15", "8.25w", "8.25 West", "-8.25W", "8 15 W", "+8.25W",
        "-08\xC2\xB0"
        "15\xE2\x80\xB2"}) {
    const auto found = coordinate_of(cell);
    ASSERT_TRUE(found) << cell;
    EXPECT_DOUBLE_EQ(found->parts[0] + found->parts[1] / 60 + found->parts[2] / 3600, 8.25) << cell;
    EXPECT_TRUE(found->negative || found->hemisphere == Hemisphere::west) << cell;
  }
  EXPECT_TRUE(coordinate_of("-0 15 0")->negative);
  for (const char* cell : {"", "-", "N", "8 x 0", "1 2 3 4", "8.25Q", "nan", "8 -15 0", "0x10"}) {
    EXPECT_FALSE(coordinate_of(cell)) << cell;
  }
}

TEST_F(UnitsOfTables, AnglesInOneCell) {
  for (const char* cells : {"47 30 0,-8 15 00.0", "47:30:00,-8:15:00", "47.5N,8.25 W",
                            "47\xC2\xB0"
                            "30'0.0\"N,8\xC2\xB0"
                            "15'0\"W",
                            "N47.5,West 8.25"}) {
    EXPECT_THAT(run(fmt::format("t,lat,lon,h\n100.01,{},400.5\n", cells)).gnss.notices, IsEmpty());
    expect_place();
  }
  EXPECT_THAT(refusal("t,lat,lon,h\n100.01,47.5E,8.25W,400\n"), HasSubstr("none of N, S"));
  EXPECT_THAT(refusal("t,lat,lon,h\n100.01,47 61 0,8.25W,400\n"), HasSubstr("minutes 61"));
  EXPECT_THAT(refusal("t,lat,lon,h\n100.01,47 30 0,8.25W,400\n", kDegrees, ", angle_unit: e7"),
              HasSubstr("column 2 is '47 30 0', not a number"));
}

TEST_F(UnitsOfTables, MinusAndWestSayTheSame) {
  const std::string columns =
      std::string(kDegrees) + ", latitude_hemisphere: ns, longitude_hemisphere: ew";
  for (const char* cells :
       {"47.5,N,-8.25,W", "47.5,n,8.25,w", "47.5,North,8.25,WEST", "47.5,N,-8.25,E"}) {
    run(fmt::format("t,lat,ns,lon,ew,h\n100.01,{},400.5\n", cells), columns);
    expect_place();
  }
  EXPECT_THAT(refusal("t,lat,ns,lon,ew,h\n100.01,47.5,E,8.25,W,400\n", columns),
              HasSubstr("none of N, S"));
}

TEST_F(UnitsOfTables, UnitsOfAnglesAreFound) {
  const auto notice = [&](const std::string& cells) {
    const auto notices = run(fmt::format("t,lat,lon,h\n100.01,{},400.5\n", cells)).gnss.notices;
    return notices.empty() ? std::string() : notices[0];
  };
  EXPECT_EQ(notice("47.5,-8.25"), "");
  EXPECT_THAT(notice("4730.0000,-00815.0000"), HasSubstr("read in ddmm; if that is wrong"));
  expect_place();
  EXPECT_THAT(notice("473000.00,-81500.00"), HasSubstr("read in ddmmss"));
  expect_place();
  EXPECT_THAT(notice("475000000,-82500000"), HasSubstr("read in e7"));
  expect_place();
  EXPECT_THAT(notice("0.829031394697,-0.143989663289"), HasSubstr("read in rad"));
  expect_place();
  EXPECT_THAT(notice("0054.0000,00030.0000"), HasSubstr("read in ddmm"));
  expect_place(0.9, 0.5);
  EXPECT_EQ(notice("0.001,0.002"), "");  // a simulation at zero
  expect_place(0.001, 0.002);
  EXPECT_EQ(notice("1,3"), "");
}

TEST_F(UnitsOfTables, AGivenUnitIsTaken) {
  run("t,lat,lon,h\n100.01,0.829031394697,-0.143989663289,400.5\n", kDegrees, ", angle_unit: deg");
  expect_place(0.829031394697, -0.143989663289);
  EXPECT_THAT(refusal("t,lat,lon,h\n100.01,473000.0,-81500.0,400\n", kDegrees, ", angle_unit: deg"),
              HasSubstr("give gnss.angle_unit: ddmmss"));
  EXPECT_THAT(refusal("t,lat,lon,h\n100.01,4730.0,999.0,400\n"), HasSubstr("no place on Earth"));
}

TEST_F(UnitsOfTables, HeightsInMillimetres) {
  EXPECT_THAT(run("t,lat,lon,h\n100.01,47.5,-8.25,400500\n").gnss.notices,
              Contains(HasSubstr("heights are read in mm")));
  expect_place();
  EXPECT_THAT(run("t,lat,lon,h\n100.01,47.5,-8.25,40500.5\n").gnss.notices, IsEmpty());
  expect_place(47.5, -8.25, 40500.5);
  run("t,lat,lon,h\n100.01,47.5,-8.25,40500\n", kDegrees, ", height_unit: m");
  expect_place(47.5, -8.25, 40500);
}

TEST_F(UnitsOfTables, BearingsBeyondATurn) {
  const std::string columns = std::string(kDegrees) + ", speed: v, bearing: b";
  const std::string keys = ", velocity_sigma_m_s: [1, 1, 1]";
  EXPECT_THAT(
      run("t,lat,lon,h,v,b\n100.01,47.5,-8.25,400.5,10,9000000\n", columns, keys).gnss.notices,
      Contains(HasSubstr("bearings are read in e5")));
  EXPECT_LT((*all<GnssFix>().at(0).velocity_n - Eigen::Vector3d(0, 10, 0)).norm(), 1e-9);
  EXPECT_THAT(refusal("t,lat,lon,h,v,b\n100.01,47.5,-8.25,400.5,10,400.5\n", columns, keys),
              HasSubstr("no bearing; give gnss.bearing_unit"));
}

// Frames ----------------------------------------------------------------------------------------

TEST_F(UnitsOfTables, EarthFixedPositions) {
  const Geodetic place{47.5 * kDegree, -8.25 * kDegree, 400.5};
  const Eigen::Vector3d p = geodesy::wgs84::geodetic_to_ecef(place);
  const Eigen::Matrix3d R = geodesy::wgs84::R_e_n(place.latitude, place.longitude);
  const Eigen::Vector3d v = R * Eigen::Vector3d(1, 2, -3);
  const std::string rows = fmt::format(
      "t,x,y,z,vx,vy,vz,sx,sy,sz\n100.01,{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},"
      "0.1,0.2,0.3\n",
      p.x(), p.y(), p.z(), v.x(), v.y(), v.z());
  const std::string columns =
      "x: x, y: y, z: z, velocity_x: vx, velocity_y: vy, velocity_z: vz, sigma_x: sx, sigma_y: sy, "
      "sigma_z: sz";
  run(rows, columns, ", velocity_sigma_m_s: [1, 1, 1]");
  expect_place();
  const GnssFix fix = all<GnssFix>().at(0);
  EXPECT_LT((*fix.velocity_n - Eigen::Vector3d(1, 2, -3)).norm(), 1e-6);
  const Eigen::Vector3d variance(0.01, 0.04, 0.09);
  const Eigen::Matrix3d expected = R.transpose() * variance.asDiagonal() * R;
  EXPECT_LT((fix.position_covariance - expected).norm(), 1e-6);
  EXPECT_THAT(refusal("t,x,y,z\n100.01,10,20,30\n", "x: x, y: y, z: z"),
              AllOf(HasSubstr("no place on it"), HasSubstr("gnss.origin")));
}

TEST_F(UnitsOfTables, LocalPositionsUpAndDown) {
  const std::string origin = ", origin: {latitude_deg: 49, longitude_deg: 8, height_m: 100}";
  const geodesy::LocalFrame frame({49 * kDegree, 8 * kDegree, 100});
  for (const char* vertical : {"down: d", "up: u"}) {
    run("t,n,e,d,u\n100.01,40,30,-5,5\n", fmt::format("north: n, east: e, {}", vertical), origin);
    const GnssFix fix = all<GnssFix>().at(0);
    EXPECT_LT((frame.to_local(fix.antenna) - Eigen::Vector3d(40, 30, -5)).norm(), 1e-6);
  }
  EXPECT_THAT(
      refusal("t,n,e,u\n100.01,5762927.1,362706.1,80\n", "north: n, east: e, up: u", origin),
      AllOf(HasSubstr("5774 km from gnss.origin"), HasSubstr("UTM")));
}

// Sigmas ----------------------------------------------------------------------------------------

TEST_F(UnitsOfTables, UnknownSigmasAreTheConstants) {
  const std::string rows =
      "t,lat,lon,h,s,d\n100.01,47.5,-8.25,400.5,0.5,0.25\n100.02,47.5,-8.25,400.5,,0.000\n";
  const std::string columns = std::string(kDegrees) + ", sigma_horizontal: s, sigma_vertical: d";
  run(rows, columns);
  const auto sigma = [&](size_t i) {
    return Eigen::Vector3d(all<GnssFix>().at(i).position_covariance.diagonal().cwiseSqrt());
  };
  EXPECT_LT((sigma(0) - Eigen::Vector3d(0.5, 0.5, 0.25)).norm(), 1e-6);
  EXPECT_LT((sigma(1) - Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
  sigma_.clear();
  EXPECT_THAT(refusal(rows, columns), AllOf(HasSubstr("gnss.csv:3: the sigma in column 5 is ''"),
                                            HasSubstr("gnss.sigma_m")));
  EXPECT_THAT(refusal("t,lat,lon,h,s,d\n100.01,47.5,-8.25,400.5,-1,1\n", columns),
              HasSubstr("must be greater than zero"));
}

TEST_F(UnitsOfTables, HeadingOfTwoAntennas) {
  const std::string rows =
      "t,lat,lon,h,y,s\n100.01,47.5,-8.25,400.5,350,0.25\n100.02,47.5,-8.25,400.5,,0.25\n"
      "100.03,47.5,-8.25,400.5,20,0\n";
  const std::string columns = std::string(kDegrees) + ", heading: y, sigma_heading: s";
  run(rows, columns);
  ASSERT_EQ(all<GnssFix>().size(), 3U);
  EXPECT_NEAR(all<GnssFix>()[0].heading->azimuth, -10 * kDegree, 1e-12);
  EXPECT_NEAR(all<GnssFix>()[0].heading->sigma, 0.25 * kDegree, 1e-12);
  EXPECT_FALSE(all<GnssFix>()[1].heading);
  EXPECT_FALSE(all<GnssFix>()[2].heading);  // of no sigma
  run(rows, columns, ", heading_sigma_deg: 2");
  EXPECT_NEAR(all<GnssFix>()[2].heading->sigma, 2 * kDegree, 1e-12);
  run(rows, std::string(kDegrees) + ", heading: y", ", heading_unit: rad, heading_sigma_deg: 1");
  EXPECT_NEAR(all<GnssFix>()[2].heading->azimuth, so3::wrap(20), 1e-12);
  EXPECT_THAT(error_of<UsageError>([&] { run(rows, std::string(kDegrees) + ", heading: y"); }),
              HasSubstr("heading_sigma_deg"));
}

// IMU -------------------------------------------------------------------------------------------

TEST_F(UnitsOfTables, HexadecimalAndUnsignedCounts) {
  const std::string scales =
      ", gyro_scale: 0.01, accel_scale: 0.001, accel_unit: m_s2, gyro_unit: rad_s";
  const auto rows = [](const char* counts) {
    std::string text = "t,gx,gy,gz,ax,ay,az\n";
    for (int i = 0; i < 5; ++i) text += fmt::format("{:.2f},{}\n", 100 + 0.01 * i, counts);
    return text;
  };
  const auto expect_counts = [&] {
    const ImuIncrement one = all<ImuIncrement>().at(0);
    EXPECT_TRUE(one.dtheta_b.isApprox(0.01 * Eigen::Vector3d(-0.09, 0.25, 0), 1e-9));
    EXPECT_TRUE(one.dvel_b.isApprox(0.01 * Eigen::Vector3d(0.016, 0, -9.5), 1e-9));
  };
  for (const char* counts :
       {"0xFFF7,0x0019,0x0000,0x0010,0x0000,0xDAE4", "fff7,0019,0000,0010,0000,dae4"}) {
    EXPECT_THAT(with_imu(rows(counts), scales).imu.notices, Contains(HasSubstr("hexadecimal")));
    expect_counts();
  }
  with_imu(rows("65527,25,0,16,0,56036"), scales + ", counts: uint16");
  expect_counts();
  EXPECT_THAT(with_imu(rows("-9,25,0,16,0,-9500"), scales).imu.notices, IsEmpty());
  expect_counts();
  EXPECT_THAT(error_of<DataError>([&] { with_imu(rows("-9,1,1,1,1,1"), ", counts: uint16"); }),
              HasSubstr("no count of 0 to 65535"));
  EXPECT_THAT(error_of<DataError>([&] { with_imu(rows("0xG,1,1,1,1,1"), ", counts: hex"); }),
              HasSubstr("no hexadecimal count"));
}

/// Counts around zero jump by 2^16; those that only are large do not.
TEST_F(UnitsOfTables, UnsignedCountsAreFound) {
  const auto rows = [](int offset) {
    std::string text = "t,gx,gy,gz,ax,ay,az\n";
    for (int i = 0; i < 50; ++i) {
      const int count = (i * 7 % 11 - 5 + offset) & 0xFFFF;
      text += fmt::format("{:.2f},{},{},{},9800,40000,9800\n", 100 + 0.01 * i, count, count, count);
    }
    return text;
  };
  EXPECT_THAT(with_imu(rows(0), ", accel_unit: m_s2").imu.notices,
              Contains(HasSubstr("unsigned numbers of 16 bits")));
  EXPECT_THAT(with_imu(rows(1000), ", accel_unit: m_s2").imu.notices, IsEmpty());
}

TEST_F(UnitsOfTables, HalvesInRowsOfTheirOwn) {
  std::string text = "t,gx,gy,gz,ax,ay,az,w\n";
  for (int i = 0; i < 5; ++i) {
    const double t = 100 + 0.01 * i;
    text += fmt::format("{:.2f},1,2,{},,,,{}\n{:.2f},,,,0.5,0.25,-9.5,\n", t, i, 10 + i, t);
  }
  imu_columns_ = ", wheel_speed: w";
  const ImportSummary summary = with_imu(text);
  EXPECT_EQ(summary.imu.written, 5);
  EXPECT_EQ(summary.wheel_speeds, 5);
  EXPECT_THAT(summary.imu.notices, Contains(HasSubstr("rows of their own")));
  const auto increments = all<ImuIncrement>();
  ASSERT_EQ(increments.size(), 4U);
  EXPECT_TRUE(increments[2].dtheta_b.isApprox(0.01 * Eigen::Vector3d(1, 2, 3), 1e-9));
  EXPECT_TRUE(increments[2].dvel_b.isApprox(0.01 * Eigen::Vector3d(0.5, 0.25, -9.5), 1e-9));
  imu_columns_.clear();
  EXPECT_THAT(error_of<DataError>([&] { with_imu(text, ", gyro_unit: rad, accel_unit: m_s"); }),
              HasSubstr("increments cannot be joined"));
  // What stands alone is counted.
  EXPECT_EQ(with_imu(text + "100.50,1,2,3,,,,1\n").imu.without_fix, 1);
}

TEST(SharedStamps, SlowClocksAndBursts) {
  std::vector<int64_t> cut, together, even;
  for (int64_t i = 0; i < 500; ++i) {
    const int64_t t = 20 * kMs * i;
    cut.push_back(t - t % (500 * kMs));
    together.push_back((t / (40 * kMs) * 2 + 1) * 20 * kMs);
    even.push_back(t);
  }
  const auto clock = SharedStamps::of(cut, false);
  ASSERT_TRUE(clock);
  EXPECT_TRUE(clock->of_first);
  EXPECT_EQ(clock->interval_ns, 20 * kMs);
  const std::vector<int64_t> spread = clock->spread(500 * kMs, 25, 1000 * kMs);
  for (int64_t k = 0; k < 25; ++k)
    EXPECT_EQ(spread.at(static_cast<size_t>(k)), (500 + 20 * k) * kMs);
  EXPECT_EQ(clock->spread(500 * kMs, 3, 1000 * kMs).front(),
            940 * kMs);                                                  // those before are missing
  EXPECT_EQ(clock->spread(500 * kMs, 3, 3000 * kMs).back(), 540 * kMs);  // before a hole
  EXPECT_FALSE(SharedStamps::of(together, false));                       // left to runs
  const auto pairs = SharedStamps::of(together, true);
  ASSERT_TRUE(pairs);
  EXPECT_FALSE(pairs->of_first);
  EXPECT_EQ(pairs->spread(60 * kMs, 2, 20 * kMs), (std::vector<int64_t>{40 * kMs, 60 * kMs}));
  EXPECT_FALSE(SharedStamps::of(even, true));
}

TEST_F(UnitsOfTables, RowsThatShareAStamp) {
  std::string whole = "t,gx,gy,gz,ax,ay,az\n", pairs = whole;
  for (int i = 0; i < 400; ++i) {
    whole += fmt::format("{},1,2,{},0.5,0.25,-9.5\n", 100 + i / 50, i);
    pairs += fmt::format("{:.2f},0.02,0.04,{},0.01,0.005,-0.19\n", 100 + 0.04 * (i / 2), 0.001 * i);
  }
  const ImportSummary summary = with_imu(whole);
  EXPECT_EQ(summary.imu.written, 400);
  EXPECT_THAT(summary.imu.notices,
              Contains(AllOf(HasSubstr("share stamps, one each 1 s"), HasSubstr("offset_s: -1"))));
  auto increments = all<ImuIncrement>();
  ASSERT_EQ(increments.size(), 399U);
  EXPECT_EQ(increments[74].t_end_ns, gps_to_unix_ns(2200, 101.5));
  EXPECT_NEAR(increments[74].dtheta_b.z(), 0.02 * 75, 1e-7);
  EXPECT_EQ(with_imu(pairs, ", gyro_unit: rad, accel_unit: m_s").imu.written, 400);
  increments = all<ImuIncrement>();
  for (const ImuIncrement& one : increments) EXPECT_NEAR(one.dt(), 0.02, 1e-9);
  EXPECT_EQ(increments.back().t_end_ns, gps_to_unix_ns(2200, 100 + 0.04 * 199));
}

}  // namespace
}  // namespace foucault::rawlog
