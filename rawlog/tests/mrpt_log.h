#pragma once

#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/serialization/CArchive.h>

#include <cstdint>
#include <string>

namespace foucault::test {

inline mrpt::system::TTimeStamp mrpt_stamp(int64_t t_ns) {
  constexpr int64_t kEpoch = 116'444'736'000'000'000;  // 1601 to 1970 in 100 ns
  return mrpt::system::TTimeStamp(mrpt::Clock::duration(t_ns / 100 + kEpoch));
}

/// A rawlog written by MRPT's own streams, as other programs write it.
template <class Stream>
class MrptLog {
 public:
  explicit MrptLog(const std::string& path)
      : stream_(path), archive_(mrpt::serialization::archiveFrom(stream_)) {}
  void write(const mrpt::serialization::CSerializable& object) { archive_.WriteObject(object); }

 private:
  Stream stream_;
  decltype(mrpt::serialization::archiveFrom(std::declval<Stream&>())) archive_;
};
using GzLog = MrptLog<mrpt::io::CFileGZOutputStream>;
using PlainLog = MrptLog<mrpt::io::CFileOutputStream>;

inline mrpt::obs::CObservationIMU imu_at(int64_t t_ns, const std::string& label = "imu") {
  using namespace mrpt::obs;
  CObservationIMU imu;
  imu.sensorLabel = label;
  imu.timestamp = mrpt_stamp(t_ns);
  imu.set(IMU_X_ACC, 0.1);
  imu.set(IMU_Y_ACC, 0.2);
  imu.set(IMU_Z_ACC, 9.7);
  imu.set(IMU_WX, 0.01);
  imu.set(IMU_WY, 0.02);
  imu.set(IMU_WZ, 0.03);
  return imu;
}

inline mrpt::obs::gnss::Message_NMEA_GGA gga(int quality = 4) {
  mrpt::obs::gnss::Message_NMEA_GGA message;
  message.fields.latitude_degrees = 47.5;
  message.fields.longitude_degrees = 8.25;
  message.fields.altitude_meters = 400;
  message.fields.geoidal_distance = 47.5;
  message.fields.fix_quality = static_cast<uint8_t>(quality);
  message.fields.thereis_HDOP = true;
  message.fields.HDOP = 2;
  return message;
}

inline mrpt::obs::CObservationGPS gps_at(int64_t t_ns, const std::string& label = "gps") {
  mrpt::obs::CObservationGPS gps;
  gps.sensorLabel = label;
  gps.timestamp = mrpt_stamp(t_ns);
  gps.setMsg(gga());
  return gps;
}

}  // namespace foucault::test
