#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>
#include <zlib.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>

#include "foucault/rawlog/rawlog_writer.h"

/// Writes the rawlogs of the fuzz corpus: a few records of every kind that we read, and some that
/// are cut or bent.
///   make_rawlogs FOLDER
namespace {

namespace fs = std::filesystem;
using namespace mrpt::obs;

constexpr int64_t kBegin = 1'600'000'000'000'000'000;
constexpr int64_t kStep = 10'000'000;

mrpt::system::TTimeStamp stamp(int64_t step) {
  constexpr int64_t kEpoch = 116'444'736'000'000'000;  // 1601 to 1970 in 100 ns
  return mrpt::system::TTimeStamp(mrpt::Clock::duration((kBegin + step * kStep) / 100 + kEpoch));
}

CObservationIMU imu(int64_t step) {
  CObservationIMU imu;
  imu.sensorLabel = "imu";
  imu.timestamp = stamp(step);
  for (const auto index : {IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC, IMU_WX, IMU_WY, IMU_WZ}) {
    imu.set(index, 0.5 * index);
  }
  return imu;
}

CObservationGPS gps(int64_t step) {
  CObservationGPS gps;
  gps.sensorLabel = "gps";
  gps.timestamp = stamp(step);
  gnss::Message_NMEA_GGA gga;
  gga.fields.latitude_degrees = 47.5;
  gga.fields.longitude_degrees = 8.25;
  gga.fields.fix_quality = 4;
  gps.setMsg(gga);
  gnss::Message_NMEA_RMC rmc;
  rmc.fields.validity_char = 'A';
  gps.setMsg(rmc);
  gnss::Message_TOPCON_SATS sats;
  sats.USIs = {1, 2};
  sats.ELs = {3, 4};
  sats.AZs = {5, 6};
  gps.setMsg(sats);
  return gps;
}

using Write = std::function<void(const mrpt::serialization::CSerializable&)>;

void write_log(const fs::path& path, const std::function<void(const Write&)>& fill) {
  mrpt::io::CFileOutputStream file(path.string());
  auto archive = mrpt::serialization::archiveFrom(file);
  fill([&](const mrpt::serialization::CSerializable& object) { archive.WriteObject(object); });
}

void observations(const Write& write) {
  for (int64_t step = 0; step < 4; ++step) {
    write(imu(step));
    if (step % 2 == 0) write(gps(step));
  }
  CObservationOdometry odometry;
  odometry.sensorLabel = "wheels";
  odometry.timestamp = stamp(3);
  odometry.hasVelocities = true;
  write(odometry);
  CObservationRobotPose pose;
  pose.sensorLabel = "REFERENCE";
  pose.timestamp = stamp(3);
  write(pose);
}

void frames(const Write& write) {
  CObservationComment comment;
  comment.text = "of no use";
  for (int64_t step = 0; step < 3; ++step) {
    CSensoryFrame frame;
    frame.insert(std::make_shared<CObservationComment>(comment));
    frame.insert(std::make_shared<CObservationIMU>(imu(step)));
    frame.insert(std::make_shared<CObservationGPS>(gps(step)));
    write(CActionCollection());
    write(frame);
  }
  write(comment);
}

/// Fixes with and without velocity and a reference, as our importers write them.
void own_log(const fs::path& path) {
  foucault::RawlogWriter writer(path.string());
  for (int64_t step = 0; step < 4; ++step) {
    const int64_t t_ns = kBegin + step * kStep;
    foucault::GnssFix fix;
    fix.t_ns = t_ns;
    fix.antenna = {0.8, 0.1, 400};
    fix.position_covariance = Eigen::Vector3d(1e-4, 1e-4, 4e-4).asDiagonal();
    if (step % 2 == 1) fix.velocity_n = Eigen::Vector3d(1, 2, 3);
    writer.write(fix);
    writer.write(foucault::ReferencePose{t_ns, {0.8, 0.1, 400}, Eigen::Vector3d(1, 2, 3), {}});
    writer.write(foucault::ImuSample{t_ns, {0.01, 0.02, 0.03}, {0.1, 0.2, -9.8}});
  }
  writer.write(foucault::WheelSpeed{kBegin + 4 * kStep, 3.5});
  writer.finish();
}

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void put(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string inflated(const fs::path& path) {
  std::string bytes(1 << 16, '\0');
  const gzFile file = gzopen(path.c_str(), "rb");
  bytes.resize(static_cast<size_t>(std::max(0, gzread(file, bytes.data(), 1 << 16))));
  gzclose(file);
  return bytes;
}

/// With another version behind every name of the class.
std::string of_version(std::string bytes, const std::string& name, char version) {
  for (size_t at = bytes.find(name); at != std::string::npos; at = bytes.find(name, at + 1)) {
    bytes[at + name.size()] = version;
  }
  return bytes;
}

void make(const fs::path& folder) {
  fs::create_directories(folder);
  write_log(folder / "observations.rawlog", observations);
  write_log(folder / "frames.rawlog", frames);
  own_log(folder / "own_compressed.rawlog");
  const std::string own = inflated(folder / "own_compressed.rawlog");
  put(folder / "own.rawlog", own);
  put(folder / "truncated.rawlog", own.substr(0, own.size() * 2 / 3));
  const std::string compressed = contents(folder / "own_compressed.rawlog");
  put(folder / "truncated_compressed.rawlog", compressed.substr(0, compressed.size() - 20));
  const std::string all = contents(folder / "observations.rawlog");
  for (const char version : {1, 3}) {
    put(folder / ("imu_version_" + std::to_string(version) + ".rawlog"),
        of_version(all, "CObservationIMU", version));
  }
  for (const char version : {5, 9, 10, 99}) {
    put(folder / ("gps_version_" + std::to_string(version) + ".rawlog"),
        of_version(all, "CObservationGPS", version));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_rawlogs FOLDER\n");
    return 2;
  }
  make(argv[1]);
  return 0;
}
