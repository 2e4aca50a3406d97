#include "novatel_imu.h"

#include <fmt/format.h>

#include <algorithm>

#include "foucault/core/constants.h"

namespace foucault::rawlog {

namespace {

constexpr double kFoot = 0.3048;                     ///< [m]
constexpr double kArcSecond = kDegree / 3600;        ///< [rad]
constexpr double kMilliG = 1e-3 * kStandardGravity;  ///< [m/s^2]

constexpr NovatelScales kHoneywell{0x1p-33, 0x1p-27 * kFoot};
constexpr NovatelScales kHoneywellWide{0x1p-33, 0x1p-26 * kFoot};
constexpr NovatelScales kHg4930{0x1p-33, 0x1p-29};
constexpr NovatelScales kLn200{0x1p-19, 0x1p-14};
constexpr NovatelScales kFsas{0.1 * 0x1p-8 * kArcSecond, 0.05 * 0x1p-15};
constexpr NovatelScales kKvh{0.1 / (3600.0 * 256), 0.05 * 0x1p-15};
constexpr NovatelScales kLitef{1e-9, 2e-8};
constexpr NovatelScales kAdis{720 * 0x1p-31 * kDegree, 200 * 0x1p-31};
constexpr NovatelScales kStim{0x1p-21 * kDegree, 0x1p-22};

/// Epson's counts are rates, taken for one interval.
constexpr NovatelScales epson(double gyro_deg_s, double accel_mg, double rate_hz) {
  return {gyro_deg_s * 0x1p-16 * kDegree / rate_hz, accel_mg * 0x1p-16 * kMilliG / rate_hz};
}
constexpr NovatelScales kG320 = epson(0.008, 0.2, 125);
constexpr NovatelScales kG320Fast = epson(0.008, 0.2, 200);
constexpr NovatelScales kG370 = epson(0.0151515, 0.4, 200);

struct NovatelImuType {
  std::string_view name;
  int number;
  NovatelScales scales;
};

const std::vector<NovatelImuType> kNovatelImus{
    {"HG1700_AG11", 1, kHoneywell},
    {"HG1700_AG17", 4, kHoneywellWide},
    {"HG1900_CA29", 5, kHoneywell},
    {"LN200", 8, kLn200},
    {"HG1700_AG58", 11, kHoneywell},
    {"HG1700_AG62", 12, kHoneywellWide},
    {"IMAR_FSAS", 13, kFsas},
    {"KVH_COTS", 16, kKvh},
    {"HG1930_AA99", 20, kHoneywell},
    {"ISA100C", 26, kLitef},
    {"HG1900_CA50", 27, kHoneywell},
    {"HG1930_CA50", 28, kHoneywell},
    {"ADIS16488", 31, kAdis},
    {"STIM300", 32, kStim},
    {"KVH_1750", 33, kKvh},
    {"EPSON_G320", 41, kG320},
    {"LITEF_MICROIMU", 52, kLitef},
    {"STIM300D", 56, kStim},
    {"HG4930_AN01", 58, kHg4930},
    {"EPSON_G370", 61, kG370},
    {"EPSON_G320_200HZ", 62, kG320Fast},
    {"HG4930_AN04", 68, kHg4930},
    {"HG4930_AN04_400HZ", 69, kHg4930},
};

const NovatelImuType* novatel_imu(int type) {
  const auto found = std::find_if(kNovatelImus.begin(), kNovatelImus.end(),
                                  [&](const NovatelImuType& imu) { return imu.number == type; });
  return found == kNovatelImus.end() ? nullptr : &*found;
}

}  // namespace

const NovatelNames& novatel_imu_names() {
  static const NovatelNames kNames = [] {
    NovatelNames names;
    for (const NovatelImuType& imu : kNovatelImus) names.emplace_back(imu.name, imu.number);
    return names;
  }();
  return kNames;
}

std::string novatel_imu_name(int type) {
  const NovatelImuType* const imu = novatel_imu(type);
  return imu == nullptr ? fmt::format("number {}", type) : std::string(imu->name);
}

std::optional<NovatelScales> novatel_scales(int type) {
  const NovatelImuType* const imu = novatel_imu(type);
  return imu == nullptr ? std::nullopt : std::optional(imu->scales);
}

}  // namespace foucault::rawlog
