#include "foucault/laboratory/fault_cases.h"

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>

#include "foucault/core/error.h"

namespace foucault::laboratory {
namespace {

using Kind = simulation::FaultKind;

constexpr double kToTheEnd = std::numeric_limits<double>::infinity();

/// A case of at most two faults.
struct Row {
  const char* name;
  const char* title;
  std::size_t count;
  simulation::Fault faults[2];
  FileDamage damage = FileDamage::none;
  double sigma_m = 0;  ///< of the fixes; 0: the trip's
};

constexpr simulation::Fault middle(Kind kind, double length_s, double size = 0) {
  return {kind, kFaultStart, length_s, size};
}

constexpr simulation::Fault throughout(Kind kind, double size = 0) {
  return {kind, 0, kToTheEnd, size};
}

constexpr Row kRows[] = {
    {"none", "nothing", 0, {}},
    {"outliers", "10 % of the fixes 5 to 50 m off", 1, {throughout(Kind::fix_outliers, 0.1)}},
    {"ramp", "fixes drift off to 20 m in 60 s", 1, {middle(Kind::fix_ramp, 60, 20)}},
    {"ramp_coarse",
     "the same among fixes of 0.2 m",
     1,
     {middle(Kind::fix_ramp, 60, 20)},
     FileDamage::none,
     0.2},
    {"jump", "fixes 100 m off for 20 s", 1, {middle(Kind::fix_jump, 20, 100)}},
    {"jump_back",
     "fixes 100 m off until the jump to the truth",
     1,
     {{Kind::fix_jump, 0, kFaultStart, 100}}},
    {"wrong_after_float",
     "60 s of float fixes, then 10 s of fixes with wrong ambiguities, 5 m off",
     2,
     {{Kind::fix_float, kFaultStart, 60, 1e9}, {Kind::fix_jump, kFaultStart + 60, 10, 5}}},
    {"outliers_float",
     "float and fixed every other 4 s, 10 % of the fixes 5 to 50 m off",
     2,
     {throughout(Kind::fix_float, 4), throughout(Kind::fix_outliers, 0.1)}},
    {"sigma_small", "sigmas ten times too small", 1, {throughout(Kind::fix_sigma_scale, 0.1)}},
    {"sigma_zero", "sigmas of zero for 60 s", 1, {middle(Kind::fix_sigma_zero, 60)}},
    {"sigma_negative", "negative variances for 60 s", 1, {middle(Kind::fix_sigma_negative, 60)}},
    {"sigma_nan", "sigmas not a number for 60 s", 1, {middle(Kind::fix_sigma_nan, 60)}},
    {"duplicate", "each fix twice", 1, {throughout(Kind::fix_duplicate)}},
    {"late", "fixes 1.5 s late for 60 s", 1, {middle(Kind::fix_late, 60, 1.5)}},
    {"swapped",
     "each pair of fixes in the wrong order for 60 s",
     1,
     {middle(Kind::fix_swapped, 60)}},
    {"another_week", "every tenth fix a week ahead", 1, {throughout(Kind::fix_another_week, 1)}},
    {"imu_gap_sample", "one IMU sample missing", 1, {middle(Kind::imu_gap, 0.005)}},
    {"imu_gap_3s", "no IMU for 3 s", 1, {middle(Kind::imu_gap, 3)}},
    {"imu_gap_60s", "no IMU for 60 s", 1, {middle(Kind::imu_gap, 60)}},
    {"imu_duplicate", "every tenth IMU sample twice", 1, {throughout(Kind::imu_duplicate)}},
    {"imu_backward", "every tenth IMU sample after the next", 1, {throughout(Kind::imu_backward)}},
    {"imu_jitter", "IMU stamps off by 1 ms, 1 sigma", 1, {throughout(Kind::imu_jitter, 0.001)}},
    {"imu_bursts",
     "IMU stamped on arrival, 4 at a time, 0.2 ms apart",
     1,
     {throughout(Kind::imu_bursts, 4)}},
    {"imu_nan", "every tenth IMU sample not a number for 60 s", 1, {middle(Kind::imu_nan, 60)}},
    {"imu_clipped",
     "gyroscopes cut off at 10 deg/s for 60 s",
     1,
     {middle(Kind::imu_clipped, 60, 0.1745)}},
    {"imu_stuck", "third gyroscope stuck for 20 s", 1, {middle(Kind::imu_stuck, 20)}},
    {"imu_half_rate",
     "IMU rate 100 instead of 200 Hz from the middle on",
     1,
     {middle(Kind::imu_half_rate, kToTheEnd)}},
    {"imu_interpolated",
     "straight lines in place of 1.5 s of the IMU",
     1,
     {middle(Kind::imu_interpolated, 1.5)}},
    {"imu_splice",
     "0.3 s of the IMU missing under even stamps, caught up 60 s later",
     1,
     {middle(Kind::imu_splice, 60, 0.3)}},
    {"gyro_deg", "angular rates in deg/s", 1, {throughout(Kind::imu_gyro_in_degrees)}},
    {"accel_g", "specific force in g", 1, {throughout(Kind::imu_accel_in_g)}},
    {"axes", "IMU axes left and up for right and down", 1, {throughout(Kind::imu_axes_turned)}},
    {"gps_utc",
     "IMU stamps in GPS time, fixes in UTC",
     1,
     {throughout(Kind::imu_stamps_offset, 18)}},
    {"week",
     "IMU stamps 1024 weeks early",
     1,
     {throughout(Kind::imu_stamps_offset, -1024 * 604800.0)}},
    {"no_overlap", "IMU stamps an hour late", 1, {throughout(Kind::imu_stamps_offset, 3600)}},
    {"file_truncated", "rawlog cut off at 60 %", 0, {}, FileDamage::truncated},
    {"file_overwritten", "64 bytes overwritten in its middle", 0, {}, FileDamage::overwritten},
    {"file_empty", "a file of no bytes", 0, {}, FileDamage::emptied},
    {"file_text", "a text under its name", 0, {}, FileDamage::text},
};

FaultCase case_of(const Row& row) {
  FaultCase fault;
  fault.name = row.name;
  fault.title = row.title;
  fault.faults.assign(row.faults, row.faults + row.count);
  fault.damage = row.damage;
  if (row.sigma_m > 0) fault.sigma_m = row.sigma_m;
  return fault;
}

/// No fixes for gap_s, and then some that are off by offset_m for wrong_s.
FaultCase wrong_return(int gap_s, int wrong_s, int offset_m) {
  const double end_s = kFaultStart + gap_s;
  return {fmt::format("return_{}s_{}s_{}m", gap_s, wrong_s, offset_m),
          fmt::format("{} s without fixes, then {} s of fixes {} m off", gap_s, wrong_s, offset_m),
          {{Kind::fix_gap, kFaultStart, static_cast<double>(gap_s)},
           {Kind::fix_jump, end_s, static_cast<double>(wrong_s), static_cast<double>(offset_m)}}};
}

std::vector<FaultCase> make_cases() {
  std::vector<FaultCase> cases;
  for (const Row& row : kRows) cases.push_back(case_of(row));
  for (const int gap_s : {5, 20, 60}) {
    for (const int wrong_s : {5, 15, 60}) {
      for (const int offset_m : {5, 20, 100}) {
        cases.push_back(wrong_return(gap_s, wrong_s, offset_m));
      }
    }
  }
  return cases;
}

void overwrite_middle(const std::string& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) / 2));
  file << std::string(64, '\xA5');
}

}  // namespace

const std::vector<FaultCase>& fault_cases() {
  static const std::vector<FaultCase> all = make_cases();
  return all;
}

const FaultCase& find_fault_case(const std::string& name) {
  std::string known;
  for (const FaultCase& fault : fault_cases()) {
    if (fault.name == name) return fault;
    known += (known.empty() ? "" : ", ") + fault.name;
  }
  throw UsageError(fmt::format("unknown fault '{}'; known: {}", name, known));
}

void damage_file(const std::string& path, FileDamage damage) {
  namespace fs = std::filesystem;
  try {
    if (damage == FileDamage::truncated) fs::resize_file(path, fs::file_size(path) * 6 / 10);
    if (damage == FileDamage::overwritten) overwrite_middle(path);
    if (damage == FileDamage::emptied) fs::resize_file(path, 0);
    if (damage == FileDamage::text) std::ofstream(path) << "# not a rawlog\n1 2 3\n";
  } catch (const fs::filesystem_error& error) {
    throw DataError(fmt::format("'{}' cannot be changed: {}", path, error.code().message()));
  }
}

}  // namespace foucault::laboratory
