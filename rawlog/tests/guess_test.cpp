#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "foucault/core/config.h"
#include "foucault/core/constants.h"
#include "foucault/rawlog/guess_mapping.h"
#include "foucault/rawlog/import_csv.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "foucault/rawlog/recognize.h"
#include "guess_names.h"
#include "scratch.h"

namespace foucault::rawlog {
namespace {

using Axes = std::vector<std::string>;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::error_of;
using test::Scratch;

constexpr double kGravity = 9.81;
constexpr double kStart = 1'700'000'000;  // UNIX

/// How the tables of a drive are written.
struct Writing {
  Matrix3d to_sensor = Matrix3d::Identity();  ///< from forward-right-down
  double accel = 1, gyro = 1;                 ///< what a m/s^2 and a rad/s are written as
  bool whole = false;                         ///< counts
  double imu_ahead = 0;                       ///< stamps of the IMU less those of fixes [s]
  double fix_origin = kStart, imu_origin = kStart;
  double speed = 10;  ///< about which it varies; 0: rest
  bool exchanged = false;
  std::string imu_header = "time,gx,gy,gz,ax,ay,az";
  std::string fix_header = "time,lat,lon,h,vn,ve,vd";
};

/// A level drive with turns and changes of speed, 100 s: IMU 50 Hz, fixes 5 Hz.
class Drive {
 public:
  explicit Drive(const Writing& writing) : w_(writing) {
    imu_ = w_.imu_header + "\n";
    fixes_ = w_.fix_header + "\n";
    constexpr double kStep = 0.02;
    Vector3d p = Vector3d::Zero();
    for (int i = 0; i < 5000; ++i) {
      const double t = i * kStep;
      const double heading = 1 + 0.8 * std::sin(0.23 * t) + 0.01 * t;
      const double speed = w_.speed * (1 + 0.3 * std::sin(0.41 * t));
      const Vector3d v(speed * std::cos(heading), speed * std::sin(heading), 0);
      if (i % 10 == 0) add_fix(t, p, v);
      add_sample(t, speed);
      p += v * kStep;
    }
  }
  const std::string& imu() const { return imu_; }
  const std::string& fixes() const { return fixes_; }

 private:
  void add_sample(double t, double speed) {
    const bool rests = w_.speed == 0;
    const double turn = rests ? 0 : 0.8 * 0.23 * std::cos(0.23 * t) + 0.01;
    const double change = w_.speed * 0.3 * 0.41 * std::cos(0.41 * t);
    const double shake = 1e-3 * std::sin(1.7e3 * t);  // no two rows are the same
    Vector3d f = w_.to_sensor * Vector3d(change + shake, speed * turn, -kGravity) * w_.accel;
    Vector3d rate = w_.to_sensor.determinant() * w_.to_sensor * Vector3d(shake, 0, turn) * w_.gyro;
    if (w_.whole) {
      f = f.array().round();
      rate = rate.array().round();
    }
    imu_ += fmt::format("{:.4f},{:.7f},{:.7f},{:.7f},{:.6f},{:.6f},{:.6f}\n",
                        w_.imu_origin + t + w_.imu_ahead, rate.x(), rate.y(), rate.z(), f.x(),
                        f.y(), f.z());
  }
  void add_fix(double t, const Vector3d& p, const Vector3d& v) {
    constexpr double kRadius = 6'371'000;
    const double lat = 50 + p.x() / kRadius / kDegree;
    const double lon = 8 + p.y() / kRadius / kDegree / std::cos(50 * kDegree);
    fixes_ += fmt::format("{:.4f},{:.9f},{:.9f},100.0,{:.4f},{:.4f},{:.4f}\n", w_.fix_origin + t,
                          w_.exchanged ? lon : lat, w_.exchanged ? lat : lon, v.x(), v.y(), v.z());
  }

  Writing w_;
  std::string imu_, fixes_;
};

Matrix3d rows(const Vector3d& x, const Vector3d& y, const Vector3d& z) {
  return (Matrix3d() << x.transpose(), y.transpose(), z.transpose()).finished();
}

bool is_sure(const MappingGuess& guess, const std::string& key) {
  return guess.comments.at(key).rfind("not sure", 0) != 0;
}

class Guess : public ::testing::Test {
 protected:
  MappingGuess of(const Writing& writing) {
    const Drive drive(writing);
    return guess_mapping(
        {scratch_.text_file("imu.csv", drive.imu()), scratch_.text_file("gnss.csv", drive.fixes())},
        scratch_.path(""));
  }
  MappingGuess of_one(const std::string& text) {
    return guess_mapping({scratch_.text_file("log.csv", text)}, scratch_.path(""));
  }

  Scratch scratch_;
};

TEST_F(Guess, FindsPlainTablesWhichThenImport) {
  const MappingGuess guess = of({});
  const ImportMapping& m = guess.mapping;
  EXPECT_EQ(m.imu.axes, (Axes{"x", "y", "z"}));
  EXPECT_EQ(m.imu.gyro_unit, "rad_s");
  EXPECT_EQ(m.imu.accel_unit, "m_s2");
  EXPECT_EQ(m.imu.accel_sign, "1");
  EXPECT_EQ(m.imu.time.system, "unix");
  EXPECT_EQ(m.gnss.velocity_unit, "m_s");
  EXPECT_EQ(m.imu.file, "imu.csv");
  for (const char* key : {"imu.axes", "imu.gyro_unit", "imu.accel_unit", "imu.accel_sign",
                          "imu.time", "gnss.velocity_unit"}) {
    EXPECT_TRUE(is_sure(guess, key)) << key << ": " << guess.comments.at(key);
  }
  EXPECT_FALSE(is_sure(guess, "gnss.height"));
  CsvImport import;
  import.mapping = scratch_.text_file("map.yaml", mapping_text(guess));
  import.out = scratch_.path("trip.rawlog");
  const ImportSummary summary = import_csv(import);
  EXPECT_EQ(summary.imu.written, 5000);
  EXPECT_EQ(summary.with_velocity, 500);
}

TEST_F(Guess, ItsTextIsItsMapping) {
  Writing writing;
  writing.gyro = 131 / kDegree;
  writing.accel = 16384 / kStandardGravity;
  writing.whole = true;
  writing.imu_header = "time,\"gyro x\",gyro_y,gyro_z,acc [x],acc_y,acc_z";
  MappingGuess guess = of(writing);
  ImportMapping read;
  load_config_text(mapping_text(guess), "guess", read);
  EXPECT_EQ(dump_config(read), dump_config(guess.mapping));
}

TEST_F(Guess, UnitsOfTurnsAndGravity) {
  Writing writing;
  writing.gyro = 1 / kDegree;
  writing.accel = 1000 / kStandardGravity;
  const MappingGuess degrees = of(writing);
  EXPECT_EQ(degrees.mapping.imu.gyro_unit, "deg_s");
  EXPECT_EQ(degrees.mapping.imu.accel_unit, "mg");
  writing.gyro = 131 / kDegree;
  writing.accel = 16384 / kStandardGravity;
  writing.whole = true;
  const MappingGuess counts = of(writing);
  EXPECT_EQ(counts.mapping.imu.gyro_unit, "deg_s");
  EXPECT_DOUBLE_EQ(counts.mapping.imu.gyro_scale, 1 / 131.0);
  EXPECT_EQ(counts.mapping.imu.accel_unit, "g");
  EXPECT_DOUBLE_EQ(counts.mapping.imu.accel_scale, 1 / 16384.0);
  EXPECT_TRUE(is_sure(counts, "imu.gyro_unit")) << counts.comments.at("imu.gyro_unit");
  writing = {};
  writing.gyro = writing.accel = 0.02;  // increments
  const MappingGuess increments = of(writing);
  EXPECT_EQ(increments.mapping.imu.gyro_unit, "rad");
  EXPECT_EQ(increments.mapping.imu.accel_unit, "m_s");
}

TEST_F(Guess, SaysThatAScaleIsWrong) {
  Writing writing;
  writing.accel = writing.gyro = 0.5;
  const MappingGuess guess = of(writing);
  EXPECT_FALSE(is_sure(guess, "imu.accel_unit"));
  EXPECT_FALSE(is_sure(guess, "imu.gyro_unit"));
  EXPECT_NE(guess.comments.at("imu.accel_unit").find("wrong scale"), std::string::npos);
}

TEST_F(Guess, AxesOfAnySensor) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const std::vector<std::pair<Matrix3d, Axes>> sensors{{rows(-x, y, -z), {"-x", "y", "-z"}},
                                                       {rows(y, x, -z), {"y", "x", "-z"}},
                                                       {rows(-z, x, -y), {"y", "-z", "-x"}},
                                                       {rows(-y, x, z), {"y", "-x", "z"}}};
  for (const auto& [to_sensor, axes] : sensors) {
    Writing writing;
    writing.to_sensor = to_sensor;
    const MappingGuess guess = of(writing);
    EXPECT_EQ(guess.mapping.imu.axes, axes);
    EXPECT_TRUE(is_sure(guess, "imu.axes")) << guess.comments.at("imu.axes");
  }
}

TEST_F(Guess, AnAccelerometerThatIsReversed) {
  Writing writing;
  writing.accel = -1;
  const MappingGuess guess = of(writing);
  EXPECT_EQ(guess.mapping.imu.accel_sign, "-1");
  EXPECT_EQ(guess.mapping.imu.axes, (Axes{"x", "y", "z"}));
  EXPECT_TRUE(is_sure(guess, "imu.accel_sign"));
}

TEST_F(Guess, AtRestForwardIsNotKnown) {
  Writing writing;
  writing.speed = 0;
  const MappingGuess guess = of(writing);
  EXPECT_EQ(guess.mapping.imu.axes, (Axes{"x", "y", "z"}));
  for (const char* key : {"imu.axes", "imu.gyro_unit", "imu.accel_sign"}) {
    EXPECT_FALSE(is_sure(guess, key)) << guess.comments.at(key);
  }
  EXPECT_TRUE(is_sure(guess, "imu.accel_unit"));
}

TEST_F(Guess, LatitudeAndLongitudeThatAreExchanged) {
  Writing writing;
  writing.exchanged = true;
  const MappingGuess guess = of(writing);
  EXPECT_EQ(guess.mapping.gnss.columns.at("latitude"), "lon");
  EXPECT_EQ(guess.mapping.gnss.columns.at("longitude"), "lat");
  EXPECT_NE(guess.comments.at("gnss.columns").find("exchanged"), std::string::npos);
  EXPECT_EQ(guess.mapping.imu.accel_sign, "1");
}

TEST_F(Guess, ClocksThatAreApart) {
  Writing writing;
  writing.imu_ahead = 0.4;
  const MappingGuess late = of(writing);
  EXPECT_NE(late.comments.at("gnss.time").find("+0.40 s"), std::string::npos)
      << late.comments.at("gnss.time");
  EXPECT_EQ(late.mapping.gnss.time.offset_s, 0);
  writing.imu_ahead = 18;
  const MappingGuess leap = of(writing);
  EXPECT_EQ(leap.mapping.gnss.time.offset_s, 18);
  EXPECT_NE(leap.comments.at("gnss.time").find("UTC"), std::string::npos);
  writing.imu_ahead = 3600;
  const MappingGuess zone = of(writing);
  EXPECT_NE(mapping_text(zone).find("do not overlap"), std::string::npos);
}

TEST_F(Guess, AClockSincePowerUpHasItsDateFromTheOther) {
  Writing writing;
  writing.imu_origin = writing.fix_origin = 50;
  writing.fix_header = "t_boot_s,lat,lon,h,vn,ve,vd,gps_week,gps_tow_s";
  writing.imu_header = "t_boot_s,gx,gy,gz,ax,ay,az";
  const Drive drive(writing);
  std::string fixes;
  int row = -1;
  std::istringstream lines(drive.fixes());
  for (std::string line; std::getline(lines, line); ++row) {
    fixes += line + (row < 0 ? "" : fmt::format(",2300,{:.3f}", 1050 + 0.2 * row)) + "\n";
  }
  const MappingGuess guess = guess_mapping(
      {scratch_.text_file("imu.csv", drive.imu()), scratch_.text_file("gnss.csv", fixes)},
      scratch_.path(""));
  for (const TimeMapping* time : {&guess.mapping.imu.time, &guess.mapping.gnss.time}) {
    EXPECT_EQ(time->system, "boot");
    EXPECT_EQ(time->gps_week, 2300);
    EXPECT_NEAR(*time->boot_sow, 1000, 1e-6);
  }
  EXPECT_EQ(guess.mapping.gnss.columns.at("time"), "t_boot_s");
}

TEST_F(Guess, TimesWithoutADateAreMarked) {
  Writing writing;
  writing.imu_origin = writing.fix_origin = 0;
  const MappingGuess guess = of(writing);
  EXPECT_EQ(guess.mapping.imu.time.system, "seconds_of_day");
  EXPECT_FALSE(is_sure(guess, "imu.time"));
  writing.imu_origin = writing.fix_origin = 300'000;
  const MappingGuess week = of(writing);
  EXPECT_EQ(week.mapping.imu.time.system, "gps_sow");
  EXPECT_FALSE(is_sure(week, "imu.time"));
}

TEST_F(Guess, OneStampFarAheadIsNoOtherClock) {
  const Drive drive({});
  std::string imu = drive.imu();
  const std::string stamp = fmt::format("{:.4f}", kStart + 50);
  imu.replace(imu.find(stamp), stamp.size(), fmt::format("{:.4f}", kStart + 1e7));
  const MappingGuess guess = guess_mapping(
      {scratch_.text_file("imu.csv", imu), scratch_.text_file("gnss.csv", drive.fixes())},
      scratch_.path(""));
  EXPECT_EQ(guess.mapping.imu.time.system, "unix");
  EXPECT_TRUE(is_sure(guess, "imu.axes"));
}

TEST_F(Guess, TablesWithoutNamesAreKnownByTheirData) {
  Writing writing;
  writing.imu_header = writing.fix_header = "# made by nobody";
  writing.imu_origin = writing.fix_origin = 300'000;
  const MappingGuess guess = of(writing);
  const ImportMapping& m = guess.mapping;
  EXPECT_FALSE(m.imu.header);
  EXPECT_EQ(m.imu.columns.at("time"), "1");
  EXPECT_EQ(m.imu.columns.at("gyro_x"), "2");
  EXPECT_EQ(m.imu.columns.at("accel_x"), "5");
  EXPECT_EQ(m.gnss.columns.at("latitude"), "2");
  EXPECT_EQ(m.gnss.columns.at("longitude"), "3");
  EXPECT_FALSE(is_sure(guess, "gnss.columns"));
}

TEST_F(Guess, AMergedTableWithBlanks) {
  const Drive drive({});
  std::istringstream imu(drive.imu()), fixes(drive.fixes());
  std::string table, a, b;
  for (int row = -1; std::getline(imu, a); ++row) {
    const bool with_fix = row < 0 || row % 10 == 0;
    if (with_fix) std::getline(fixes, b);
    table += a + (with_fix ? b.substr(b.find(',')) : ",,,,,,") + "\n";
  }
  const MappingGuess guess = of_one(table);
  EXPECT_EQ(guess.mapping.imu.file, guess.mapping.gnss.file);
  EXPECT_EQ(guess.mapping.gnss.columns.at("time"), "time");
  EXPECT_EQ(guess.mapping.imu.axes, (Axes{"x", "y", "z"}));
  EXPECT_TRUE(is_sure(guess, "imu.axes"));
}

TEST_F(Guess, AccelerationsWithoutGravityAreOfNoUse) {
  std::string table = "time,gx,gy,gz,ax,ay,az\n";
  for (int i = 0; i < 500; ++i) {
    table += fmt::format("{:.2f},0.001,{:.4f},0.002,{:.3f},0.1,0.05\n", kStart + 0.02 * i,
                         0.01 * std::sin(0.3 * i), 0.6 * std::sin(0.01 * i));
  }
  const MappingGuess guess = of_one(table);
  EXPECT_FALSE(is_sure(guess, "imu.accel_unit"));
  EXPECT_NE(guess.comments.at("imu.accel_unit").find("without gravity"), std::string::npos);
  EXPECT_TRUE(guess.mapping.gnss.file.empty());
}

TEST_F(Guess, RefusesWhatIsNoRecording) {
  const std::string words = scratch_.text_file("words.csv", "a,b\nred,green\nblue,white\n");
  EXPECT_NE(error_of<DataError>([&] { guess_mapping({words}, ""); }).find("no table"),
            std::string::npos);
  const Drive drive({});
  const std::string fixes = scratch_.text_file("gnss.csv", drive.fixes());
  EXPECT_NE(error_of<UsageError>([&] { guess_mapping({fixes}, ""); }).find("gyroscopes"),
            std::string::npos);
  error_of<DataError>([&] { guess_mapping({scratch_.path("none.csv")}, ""); });
}

// Names -----------------------------------------------------------------------------------------

TEST(GuessNames, SensorsAxesAndUnits) {
  struct Name {
    const char* text;
    Sensor sensor;
    int axis;
    const char* unit;
  };
  const Name names[] = {{"gyro_x_rad_s", Sensor::gyro, 0, "rad_s"},
                        {"gyro_rad[2]", Sensor::gyro, 2, "rad"},
                        {"accelerometer_m_s2[1]", Sensor::accelerometer, 1, "m_s2"},
                        {"gyroRotationX(rad/s)", Sensor::gyro, 0, "rad_s"},
                        {"accelerometerAccelerationZ(G)", Sensor::accelerometer, 2, "g"},
                        {"w_RS_S_y [rad s^-1]", Sensor::gyro, 1, "rad_s"},
                        {"a_RS_S_z [m s^-2]", Sensor::accelerometer, 2, "m_s2"},
                        {"field.angular_velocity.x", Sensor::gyro, 0, ""},
                        {"linear_acceleration.y", Sensor::accelerometer, 1, ""},
                        {"Acceleration x (m/s\xC2\xB2)", Sensor::accelerometer, 0, "m_s2"},
                        {"GyrZ_dps", Sensor::gyro, 2, "deg_s"},
                        {"AccX", Sensor::accelerometer, 0, ""},
                        {"wz", Sensor::gyro, 2, ""},
                        {"ax", Sensor::accelerometer, 0, ""},
                        {"yawrate", Sensor::gyro, 2, ""}};
  for (const Name& name : names) {
    const ColumnName parsed = column_name(name.text);
    EXPECT_EQ(sensor_of(parsed), name.sensor) << name.text;
    EXPECT_EQ(parsed.axis, name.axis) << name.text;
    EXPECT_EQ(parsed.unit, name.unit) << name.text;
  }
  for (const char* other : {"fix", "velocity", "mag_x", "motionUserAccelerationX(G)", "gravity_x",
                            "horizontal_accuracy", "gyro_bias_x", "index"}) {
    EXPECT_FALSE(sensor_of(column_name(other))) << other;
  }
}

TEST(GuessNames, Roles) {
  const std::pair<const char*, const char*> roles[] = {
      {"lat_deg", "latitude"},
      {"locationLatitude(WGS84)", "latitude"},
      {"LatitudeDegrees", "latitude"},
      {"lng", "longitude"},
      {"gps_lon", "longitude"},
      {"hMSL", "height_msl"},
      {"H-Ell", "height_ellipsoidal"},
      {"altitude_ellipsoid_m", "height_ellipsoidal"},
      {"altitude", "height"},
      {"velN", "velocity_north"},
      {"VEast", "velocity_east"},
      {"vd_m_s", "velocity_down"},
      {"vel_d_m_s", "velocity_down"},
      {"gSpeed", "speed"},
      {"speed_km_h", "speed"},
      {"headMot", "bearing"},
      {"locationCourse(\xC2\xB0)", "bearing"},
      {"hAcc", "sigma_horizontal"},
      {"epv", "sigma_vertical"},
      {"sAcc", "sigma_velocity"},
      {"sd_n_m", "sigma_north"},
      {"SDEast", "sigma_east"},
      {"fix_type", "quality"},
      {"Q", "quality"},
      {"GPSWeek", "week"},
      {"yaw_deg", "heading"}};
  for (const auto& [name, role] : roles) {
    EXPECT_EQ(role_of(column_name(name)).value_or("none"), role) << name;
  }
  for (const char* other : {"latency", "temperature", "nsat", "hdop", "lateral", "pressure"}) {
    EXPECT_FALSE(role_of(column_name(other))) << other;
  }
}

// Recordings ------------------------------------------------------------------------------------

/// What their READMEs say of sensors and clocks.
TEST(GuessRecordings, AxesUnitsAndClocks) {
  const std::string data = test::data_dir();
  // Not in the repository for their size and licences; the tests above guess simulated tables.
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no recordings in " << data;
  struct Recording {
    const char *folder, *imu, *gnss;
    Axes axes;
    const char *sign, *clock;
  };
  const std::vector<Recording> recordings{
      {"rtk_car_drive0708", "imu", "gnss", {"-x", "y", "-z"}, "1", "gps_week_sow"},
      {"comma2k19_highway60s", "imu", "gnss_ublox", {"x", "y", "z"}, "1", "gps_week_sow"},
      {"apm_fixedwing_testlog2", "imu", "gnss", {"x", "y", "z"}, "1", "boot"},
      {"kitti_drive0027_oxts", "imu", "gnss_local_enu", {"x", "-y", "-z"}, "1", "seconds_of_day"},
      {"car_dresden_2014", "imu", "gnss", {"x", "-y", "-z"}, "-1", "unix"},
      {"car_circles_vn100_rosbag", "imu", "gnss", {"x", "y", "z"}, "1", "unix"},
      {"wid_car_trial02", "imu_mru", "gnss_5hz", {"x", "-y", "-z"}, "1", "seconds_of_day"},
      {"wid_car_trial02", "imu_xsensdot", "gnss_5hz", {"y", "x", "-z"}, "1", "seconds_of_day"}};
  for (const Recording& r : recordings) {
    const std::string folder = data + "/" + r.folder + "/";
    if (!std::filesystem::exists(folder)) continue;
    const MappingGuess guess =
        guess_mapping({folder + r.imu + ".csv", folder + r.gnss + ".csv"}, folder);
    EXPECT_EQ(guess.mapping.imu.axes, r.axes) << r.folder << r.imu;
    EXPECT_TRUE(is_sure(guess, "imu.axes")) << r.folder << r.imu;
    EXPECT_EQ(guess.mapping.imu.accel_sign, r.sign) << r.folder << r.imu;
    EXPECT_EQ(guess.mapping.imu.gyro_unit, "rad_s") << r.folder << r.imu;
    EXPECT_EQ(guess.mapping.imu.accel_unit, "m_s2") << r.folder << r.imu;
    EXPECT_EQ(guess.mapping.imu.time.system, r.clock) << r.folder << r.imu;
  }
}

// Formats ---------------------------------------------------------------------------------------

class Recognize : public ::testing::Test {
 protected:
  std::string command_of(const std::string& contents) {
    const std::optional<FileFormat> format = recognize(scratch_.text_file("file", contents));
    return format ? format->command : "unknown";
  }

  Scratch scratch_;
};

TEST_F(Recognize, EachFormatByItsContent) {
  using std::string;
  const std::pair<string, const char*> files[] = {
      {string("ULog\x01\x12\x35\x01", 8), "ulog"},
      {"#ROSBAG V2.0\n", "bag"},
      {"\x89MCAP0\r\n", "bag"},
      {string("SQLite format 3\0", 16), "bag"},
      {string("\xA3\x95\x80\x80\x59", 5), "dataflash"},
      {"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n", "dataflash"},
      {string("\xB5\x62\x05\x01\x02\x00\x06\x01\x0F\x38", 10), "ubx"},
      {string("$GNTXT,01*00\r\n") + string("\xB5\x62\x05\x01\x02\x00\x06\x01\x0F\x38", 10), "ubx"},
      {string("\xAA\x44\x12\x1C\x2A\x00", 6), "novatel"},
      {"#BESTPOSA,COM1,0,83.5,FINESTEERING,2163,329760.000;SOL_COMPUTED*ab\n", "novatel"},
      {"     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE\n",
       "rinex"},
      {"% program   : RTKPOST ver.2.4.3\n", "rtklib"},
      {"%  GPST   latitude(deg) longitude(deg)\n", "rtklib"},
      {"$GPGGA,120000.00,5000.0,N,00800.0,E,1,10,1.0,100,M,47,M,,*5B\r\n", "nmea"},
      {"time,lat,lon\n1,50,8\n2,50,8\n", "csv"}};
  for (const auto& [contents, command] : files) {
    EXPECT_EQ(command_of(contents), command) << contents;
  }
}

TEST_F(Recognize, NothingInWhatIsNothing) {
  EXPECT_EQ(command_of("a letter to a friend\n"), "unknown");
  EXPECT_EQ(command_of(std::string("\xB5\x62\x05\x01\x02\x00\x06\x01\x0F\x39", 10)), "unknown");
  EXPECT_EQ(command_of(std::string(5000, '\xFF')), "unknown");
  EXPECT_FALSE(recognize(scratch_.path("")));
  error_of<DataError>([&] { recognize(scratch_.path("none")); });
}

TEST_F(Recognize, OwnRawlogs) {
  RawlogWriter writer(scratch_.path("own.rawlog"));
  GnssFix fix;
  fix.t_ns = 1'700'000'000'000'000'000;
  fix.position_covariance.setIdentity();
  writer.write(fix);
  writer.finish();
  const std::optional<FileFormat> format = recognize(scratch_.path("own.rawlog"));
  ASSERT_TRUE(format);
  EXPECT_STREQ(format->command, "");
}

}  // namespace
}  // namespace foucault::rawlog
