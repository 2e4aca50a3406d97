#include <fmt/format.h>
#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/rawlog/import_bag.h"
#include "foucault/rawlog/import_csv.h"
#include "foucault/rawlog/import_i2nav.h"
#include "foucault/rawlog/import_rtklib.h"
#include "foucault/rawlog/rawlog_info.h"
#include "foucault/rawlog/rawlog_source.h"
#include "scratch.h"

/// The recordings, with the mappings that ship with the program. They lie in $FOUCAULT_DATA_DIR,
/// else beside the source in ../shared/data; without them these tests are skipped.
namespace foucault::rawlog {
namespace {

using test::data_dir;
using test::Scratch;

class Recordings : public ::testing::Test {
 protected:
  void SetUp() override {
    // Not in the repository for their size and licences; import_test.cpp proves the importers on
    // files it writes.
    if (std::filesystem::exists(data_dir())) return;
    GTEST_SKIP() << "no recordings in " << data_dir() << "; set FOUCAULT_DATA_DIR";
  }

  template <class Import>
  Import options(const std::string& mapping, const std::string& folder) {
    Import import;
    import.mapping = fmt::format("{}/rawlog/mappings/{}.yaml", FOUCAULT_SOURCE_DIR, mapping);
    import.data_dir = data_dir() + "/" + folder;
    import.out = scratch_.path(mapping + ".rawlog");
    return import;
  }
  CsvImport csv(const std::string& mapping, const std::string& folder) {
    return options<CsvImport>(mapping, folder);
  }

  Scratch scratch_;
};

std::vector<Measurement> read_all(const std::string& path, imu::SampleKind samples) {
  RawlogSource source(path, samples);
  std::vector<Measurement> all;
  while (const std::optional<Measurement> m = source.next()) all.push_back(*m);
  return all;
}

template <class Kind>
std::vector<Kind> only(const std::vector<Measurement>& all) {
  std::vector<Kind> found;
  for (const Measurement& m : all) {
    if (const Kind* one = std::get_if<Kind>(&m)) found.push_back(*one);
  }
  return found;
}

/// Mean specific force on the vehicle's axes over the first seconds [m/s^2].
Eigen::Vector3d specific_force_v(const std::string& path, double seconds) {
  RawlogSource source(path, imu::SampleKind::instantaneous);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double time = 0;
  while (const std::optional<Measurement> m = source.next()) {
    const auto* increment = std::get_if<ImuIncrement>(&*m);
    if (increment == nullptr) continue;
    sum += increment->dvel_b;
    time += increment->dt();
    if (time > seconds) break;
  }
  return source.mounting().q_v_b * (sum / time);
}

TEST_F(Recordings, RtkCar) {
  const CsvImport import = csv("rtk_car_drive0708_csv", "rtk_car_drive0708");
  const ImportSummary summary = import_csv(import);
  EXPECT_EQ(summary.imu.written, 54860);
  EXPECT_EQ(summary.gnss.written, 2197);
  EXPECT_EQ(summary.qualities.at(FixQuality::fixed_rtk), 2189);
  EXPECT_EQ(summary.qualities.at(FixQuality::float_rtk), 8);
  const std::vector<GnssFix> fixes =
      only<GnssFix>(read_all(import.out, imu::SampleKind::instantaneous));
  EXPECT_EQ(fixes.front().t_ns, gps_to_unix_ns(2374, 243258.499));
  EXPECT_NEAR(fixes.front().antenna.height, 1601.474 - 16.5, 1e-9);
  // At rest, with the small misalignment taken out: the car stands level to a degree.
  const Eigen::Vector3d force = specific_force_v(import.out, 30);
  EXPECT_NEAR(force.z(), -9.8, 0.15);
  EXPECT_LT(force.head<2>().norm(), 0.35);
}

TEST_F(Recordings, RtkCarThroughRtklibIsTheSame) {
  const CsvImport import = csv("rtk_car_drive0708_csv", "rtk_car_drive0708");
  import_csv(import);
  const auto rtklib = options<RtklibImport>("rtk_car_drive0708_rtklib", "rtk_car_drive0708");
  EXPECT_EQ(import_rtklib(rtklib).gnss.written, 2197);
  const auto a = only<GnssFix>(read_all(import.out, imu::SampleKind::instantaneous));
  const auto b = only<GnssFix>(read_all(rtklib.out, imu::SampleKind::instantaneous));
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].t_ns, b[i].t_ns);
    EXPECT_EQ(a[i].antenna.latitude, b[i].antenna.latitude);
    EXPECT_EQ(a[i].quality, b[i].quality);
    // The CSV rounds sigmas to 0.1 mm.
    EXPECT_NEAR(std::sqrt(a[i].position_covariance(0, 0)),
                std::sqrt(b[i].position_covariance(0, 0)), 6e-5);
  }
}

TEST_F(Recordings, SimulatedI2nav) {
  const std::string folder = data_dir() + "/sim_i2nav_adis16465/";
  I2navImport import;
  import.imu = folder + "imu.txt.gz";
  import.gnss = folder + "gnss.pos";
  import.reference = folder + "truth.nav";
  import.gps_week = 2200;
  import.lever_arm = {0.1, -0.3, -0.8};
  import.out = scratch_.path("sim.rawlog");
  const ImportSummary summary = import_i2nav(import);
  EXPECT_EQ(summary.imu.written, 323400);
  EXPECT_EQ(summary.gnss.written, 1618);
  EXPECT_EQ(summary.reference->written, 16171);
  RawlogSource source(import.out);
  EXPECT_LT((source.lever_arm() - import.lever_arm).norm(), 1e-12);
  EXPECT_LT(source.mounting().q_v_b.angularDistance(Eigen::Quaterniond::Identity()), 1e-12);
  Eigen::Vector3d dvel = Eigen::Vector3d::Zero();
  int64_t increments = 0;
  int64_t last_ns = 0;
  while (const std::optional<Measurement> m = source.next()) {
    const auto* increment = std::get_if<ImuIncrement>(&*m);
    if (increment == nullptr) continue;
    if (increments > 0) {
      EXPECT_EQ(increment->t_begin_ns, last_ns);
    }
    last_ns = increment->t_end_ns;
    dvel += increment->dvel_b;
    ++increments;
  }
  EXPECT_EQ(increments, 323400);
  EXPECT_NEAR(dvel.z() / 1617, -9.79, 0.02);
}

TEST_F(Recordings, Kitti) {
  const CsvImport import = csv("kitti_drive0027_oxts", "kitti_drive0027_oxts");
  const ImportSummary summary = import_csv(import);
  EXPECT_EQ(summary.imu.written, 46968);
  EXPECT_EQ(summary.gnss.written, 470);
  const auto all = read_all(import.out, imu::SampleKind::instantaneous);
  EXPECT_NEAR(only<GnssFix>(all).front().antenna.latitude / kDegree, 48.98, 0.01);
  EXPECT_NEAR(specific_force_v(import.out, 100).z(), -9.8, 0.2);
  // The hole of 1.92 s behind the first sample stays a hole.
  for (const ImuIncrement& increment : only<ImuIncrement>(all)) EXPECT_LT(increment.dt(), 0.021);
}

TEST_F(Recordings, Comma) {
  const CsvImport import = csv("comma2k19_highway60s", "comma2k19_highway60s");
  const ImportSummary summary = import_csv(import);
  EXPECT_EQ(summary.imu.written, 6256);
  EXPECT_EQ(summary.gnss.written, 579);
  EXPECT_EQ(summary.with_velocity, 579);
  EXPECT_EQ(summary.reference->written, 1200);
  EXPECT_NEAR(specific_force_v(import.out, 50).z(), -9.8, 0.4);
}

TEST_F(Recordings, FixedWing) {
  const CsvImport import = csv("apm_fixedwing_testlog2", "apm_fixedwing_testlog2");
  const ImportSummary summary = import_csv(import);
  EXPECT_EQ(summary.imu.written, 30650);
  EXPECT_EQ(summary.gnss.written, 3050);
  const RawlogInfo info = read_rawlog_info(import.out);
  EXPECT_EQ(info.receivers.at(0).qualities.at(FixQuality::single), 3050);
}

TEST_F(Recordings, StaticVn310) {
  for (const std::string kind : {"lckf", "tckf"}) {
    const CsvImport import = csv("vn310_static_" + kind, "vn310_static");
    const ImportSummary summary = import_csv(import);
    EXPECT_EQ(summary.imu.written, kind == "lckf" ? 1612 : 1638);
    EXPECT_NEAR(specific_force_v(import.out, 30).z(), -9.80, 0.03);
  }
}

TEST_F(Recordings, KittiWithoutOriginSaysWhatToGive) {
  CsvImport import = csv("kitti_drive0027_oxts", "kitti_drive0027_oxts");
  std::string yaml = test::contents(import.mapping);
  yaml.erase(yaml.find("  origin:"),
             yaml.find('\n', yaml.find("  origin:")) - yaml.find("  origin:"));
  import.mapping = scratch_.text_file("no_origin.yaml", yaml);
  EXPECT_NE(test::error_of<UsageError>([&] { import_csv(import); }).find("gnss.origin"),
            std::string::npos);
}

/// The same drive as a bag of ROS 1, and as it was converted to MCAP and rosbag 2 by mcap and
/// rosbags.
TEST_F(Recordings, RobotOfRos1And2) {
  const std::string drive = data_dir() + "/raw_fixtures/robot_localization_test1";
  BagImport import;
  import.bag = drive + ".bag";
  // Conversions of a recording are not everywhere; ros2_test.cpp writes each format itself.
  if (!std::filesystem::exists(import.bag)) GTEST_SKIP() << "no " << import.bag;
  import.out = scratch_.path("ros1.rawlog");
  import.imu_axes = {"x", "z", "-y"};  // on its side
  const ImportSummary summary = import_bag(import);
  EXPECT_EQ(summary.imu.written, 11865);
  EXPECT_EQ(summary.gnss.written, 989);
  EXPECT_EQ(summary.qualities.at(FixQuality::differential), 989);
  EXPECT_NEAR(specific_force_v(import.out, 30).z(), -9.8, 0.1);
  const std::string ros1 = test::contents(import.out);
  for (const char* ending : {"_ros2.mcap", "_ros2.db3.zstd"}) {
    import.bag = drive + ending;
    if (!std::filesystem::exists(import.bag)) GTEST_SKIP() << "no " << import.bag;  // as above
    import.out = scratch_.path("ros2.rawlog");
    import_bag(import);
    EXPECT_TRUE(test::contents(import.out) == ros1) << ending;
  }
}

}  // namespace
}  // namespace foucault::rawlog
