#include "foucault/export/solution_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/units.h"
#include "foucault/export/solution_csv.h"
#include "foucault/export/solution_tum.h"
#include "support/test_folder.h"

namespace foucault::exports {
namespace {

using test::TestFolder;

std::vector<std::string> cells(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> result;
  for (std::string cell; std::getline(stream, cell, ',');) result.push_back(cell);
  return result;
}

double column(const state::Epoch& epoch, const state::Mounting& mounting, const std::string& name) {
  const std::vector<std::string> names = cells(csv_header().substr(0, csv_header().size() - 1));
  const auto found = std::find(names.begin(), names.end(), name);
  EXPECT_NE(found, names.end()) << name;
  return std::stod(cells(csv_row(epoch, mounting)).at(found - names.begin()));
}

state::Epoch some_epoch() {
  state::Epoch epoch;
  epoch.t_ns = 1'700'000'000'123'456'789;
  epoch.position = {0.531234567890123, 1.998765432101234, 23.45678};
  epoch.velocity_n = {1, -2, 0.5};
  epoch.q_n_b = so3::from_euler({0.1, -0.2, 5.0});
  epoch.bias.gyro = {1e-5, -2e-5, 3e-5};
  epoch.bias.accel = {1e-3, -2e-3, 3e-3};
  for (int i = 0; i < state::kNodeSize; ++i) epoch.covariance(i, i) = (i + 1) * (i + 1) * 1e-8;
  return epoch;
}

/// Position and rotation of a line in TUM's format.
struct Pose {
  std::string stamp;
  Eigen::Vector3d p;
  Eigen::Quaterniond q;
};

Pose parse_tum(const std::string& line) {
  Pose pose;
  std::istringstream stream(line);
  stream >> pose.stamp >> pose.p.x() >> pose.p.y() >> pose.p.z() >> pose.q.x() >> pose.q.y() >>
      pose.q.z() >> pose.q.w();
  EXPECT_FALSE(stream.fail()) << line;
  return pose;
}

TEST(SolutionCsv, BeginsWithTheContractsColumns) {
  EXPECT_EQ(
      csv_header().rfind("t_unix_s,lat_deg,lon_deg,height_m,v_north_m_s,v_east_m_s,v_down_m_s,"
                         "roll_deg,pitch_deg,heading_deg,",
                         0),
      0u);
  EXPECT_EQ(cells(csv_header()).size(), cells(csv_row(some_epoch(), {})).size());
}

TEST(SolutionCsv, KeepsStampAndPosition) {
  const state::Epoch epoch = some_epoch();
  EXPECT_EQ(cells(csv_row(epoch, {})).front(), "1700000000.123456789");
  // Half of the last digit written, 1e-11 deg = 1 um.
  EXPECT_NEAR(column(epoch, {}, "lat_deg"), epoch.position.latitude * units::kDegrees, 5.1e-12);
  EXPECT_NEAR(column(epoch, {}, "lon_deg"), epoch.position.longitude * units::kDegrees, 2e-11);
  EXPECT_NEAR(column(epoch, {}, "height_m"), 23.45678, 5.1e-6);
}

TEST(SolutionCsv, GivesTheVehiclesAttitudeNotTheImus) {
  const so3::Euler truth{0.05, -0.1, 4.0};
  state::Mounting mounting;
  mounting.q_v_b = so3::from_euler({3.0, -0.1, 1.5});
  state::Epoch epoch = some_epoch();
  epoch.q_n_b = so3::from_euler(truth) * mounting.q_v_b;
  EXPECT_NEAR(column(epoch, mounting, "roll_deg"), truth.roll * units::kDegrees, 1e-6);
  EXPECT_NEAR(column(epoch, mounting, "pitch_deg"), truth.pitch * units::kDegrees, 1e-6);
  EXPECT_NEAR(column(epoch, mounting, "heading_deg"), truth.heading * units::kDegrees, 1e-6);
}

TEST(SolutionCsv, TurnsSigmasAndBiasesIntoTheUnitsOfTheirNames) {
  const state::Epoch epoch = some_epoch();
  EXPECT_NEAR(column(epoch, {}, "sd_down_m"), 3e-4, 1e-9);
  EXPECT_NEAR(column(epoch, {}, "sd_v_north_m_s"), 4e-4, 1e-9);
  EXPECT_NEAR(column(epoch, {}, "gyro_bias_y_deg_h"), -2e-5 * 180 / M_PI * 3600, 1e-5);
  EXPECT_NEAR(column(epoch, {}, "accel_bias_z_mgal"), 300, 1e-4);
  EXPECT_NEAR(column(epoch, {}, "sd_gyro_bias_x_deg_h"), 1e-3 * 180 / M_PI * 3600, 1e-3);
  EXPECT_NEAR(column(epoch, {}, "sd_accel_bias_x_mgal"), 130, 1e-3);
}

TEST(SolutionTum, IsEastNorthUpAndForwardLeftUp) {
  state::Epoch epoch = some_epoch();
  const geodesy::LocalFrame frame(epoch.position);
  const Eigen::Vector3d ned(120, -30, -7);
  epoch.position = frame.to_geodetic(ned);
  epoch.q_n_b = so3::from_euler({0, 0, M_PI / 2});  // nose to the east
  const Pose pose = parse_tum(tum_row(epoch, {}, frame));
  EXPECT_EQ(pose.stamp, "1700000000.123456789");
  EXPECT_LT((pose.p - Eigen::Vector3d(-30, 120, 7)).norm(), 2e-5);
  // Over 124 m the local vertical turns by 0.02 mrad.
  EXPECT_LT(pose.q.angularDistance(Eigen::Quaterniond::Identity()), 3e-5);

  epoch.q_n_b = so3::from_euler({0, 0, 0});  // nose to the north, left side to the west
  const Pose north = parse_tum(tum_row(epoch, {}, frame));
  EXPECT_LT((north.q * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 3e-5);
  EXPECT_LT((north.q * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitX()).norm(), 3e-5);
}

TEST(SolutionWriter, WritesARowForEveryEpochAndAWholeKml) {
  const TestFolder folder;
  SolutionWriter writer(folder.path(), {});
  state::Epoch epoch = some_epoch();
  constexpr int kEpochs = 300;
  for (int i = 0; i < kEpochs; ++i) {
    epoch.t_ns += 1'000'000'000;
    epoch.position.latitude += 1e-7;
    epoch.covariance(0, 0) = i < 100 ? 1e-4 : 1.0;  // one change of the accuracy class
    writer.epoch(epoch);
  }
  writer.finish();
  EXPECT_EQ(folder.lines("solution.csv").size(), kEpochs + 1u);
  EXPECT_EQ(folder.lines("solution.tum").size(), 0u + kEpochs);
  const std::string kml = folder.text("solution.kml");
  EXPECT_NE(kml.find("#below-0.1m"), std::string::npos);
  EXPECT_NE(kml.find("#below-2m"), std::string::npos);
  EXPECT_NE(kml.find("</kml>"), std::string::npos);
  const auto count = [&kml](const std::string& tag) {
    int n = 0;
    for (std::size_t at = kml.find(tag); at != std::string::npos; at = kml.find(tag, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("<Placemark>"), count("</Placemark>"));
  EXPECT_EQ(count("<LineString>"), count("</LineString>"));
  EXPECT_EQ(count("<Point>"), 5);  // one a minute
}

/// Longitudes of each line of a KML file.
std::vector<std::vector<double>> line_longitudes(const TestFolder& folder) {
  std::vector<std::vector<double>> lines;
  bool inside = false;
  for (const std::string& row : folder.lines("solution.kml")) {
    const bool begins = row.find("<LineString>") != std::string::npos;
    if (begins) lines.emplace_back();
    inside = begins || (inside && row.find("</coordinates>") == std::string::npos);
    if (inside && !begins) lines.back().push_back(std::stod(row));
  }
  return lines;
}

TEST(SolutionWriter, TheTrackIsCutAtTheAntimeridian) {
  for (const double side : {1.0, -1.0}) {
    const TestFolder folder;
    SolutionWriter writer(folder.path(), {});
    state::Epoch epoch = some_epoch();
    for (int i = 0; i <= 10; ++i) {
      epoch.t_ns += 1'000'000'000;
      epoch.position.longitude = so3::wrap(side * (179.9 + 0.03 * i) / units::kDegrees);
      writer.epoch(epoch);
    }
    writer.finish();
    const std::vector<std::vector<double>> lines = line_longitudes(folder);
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0].size() + lines[1].size(), 13u);  // every epoch, and the ends at the meridian
    EXPECT_EQ(lines[0].back(), side * 180);
    EXPECT_EQ(lines[1].front(), -side * 180);
    for (const double longitude : lines[0]) EXPECT_GT(side * longitude, 179);
    for (const double longitude : lines[1]) EXPECT_LT(side * longitude, -179);
  }
}

TEST(SolutionWriter, SaysWhichFileCannotBeWritten) {
  EXPECT_THROW(SolutionWriter("/no/such/folder", {}), DataError);
}

}  // namespace
}  // namespace foucault::exports
