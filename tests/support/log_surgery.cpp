#include "support/log_surgery.h"

#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/gnss_messages_novatel.h>
#include <mrpt/serialization/CArchive.h>

#include <stdexcept>
#include <utility>

namespace foucault::test {

using mrpt::obs::CObservation;
using mrpt::obs::CObservationGPS;
using mrpt::obs::CObservationIMU;

namespace {

/// Null at the end; a compressed stream knows of its end only after it.
mrpt::serialization::CSerializable::Ptr next_object(mrpt::serialization::CArchive& archive) {
  try {
    return archive.ReadObject();
  } catch (const mrpt::serialization::CExceptionEOF&) {
    return nullptr;
  }
}

}  // namespace

void operate_on_log(const std::string& from, const std::string& to, const Operation& operate) {
  mrpt::io::CFileGZInputStream in;
  mrpt::io::CFileGZOutputStream out;
  if (!in.open(from) || !out.open(to)) throw std::runtime_error("cannot open " + from);
  auto reader = mrpt::serialization::archiveFrom(in);
  auto writer = mrpt::serialization::archiveFrom(out);
  while (const mrpt::serialization::CSerializable::Ptr object = next_object(reader)) {
    auto* observation = dynamic_cast<CObservation*>(object.get());
    if (observation == nullptr || operate(*observation)) writer << *object;
  }
}

Operation on_imu(std::function<bool(CObservationIMU&)> operate) {
  return [operate = std::move(operate)](CObservation& observation) {
    auto* imu = dynamic_cast<CObservationIMU*>(&observation);
    return imu == nullptr || operate(*imu);
  };
}

Operation on_gnss(std::function<bool(CObservationGPS&)> operate) {
  return [operate = std::move(operate)](CObservation& observation) {
    auto* gps = dynamic_cast<CObservationGPS*>(&observation);
    const bool fix = gps != nullptr && gps->sensorLabel != "REFERENCE";
    return !fix || operate(*gps);
  };
}

void set_sigma(CObservationGPS& gps, float sigma) {
  auto& fix = gps.getMsgByClass<mrpt::obs::gnss::Message_NV_OEM6_BESTPOS>().fields;
  fix.lat_sigma = sigma;
  fix.lon_sigma = sigma;
  fix.hgt_sigma = sigma;
}

}  // namespace foucault::test
