#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/state/interfaces.h"

namespace foucault::rawlog {

/// A hole in a stream, by the median interval; see core/hole.h.
struct Gap {
  int64_t t_ns = 0;   ///< where it begins
  double length = 0;  ///< [s]
};

/// The observations of one label and class.
struct StreamInfo {
  std::string label;
  std::string type;  ///< MRPT class, e.g. CObservationIMU
  int64_t count = 0;
  int64_t first_ns = 0;
  int64_t last_ns = 0;
  /// [s], 0 with fewer than two; to 0.1 %. Where samples come in bursts that of the samples.
  double median_interval = 0;
  double burst_samples = 0;  ///< of the IMU: mean a burst, see BurstPattern; 0: none
  int64_t duplicates = 0;    ///< stamps equal to the one before
  int64_t backward = 0;      ///< stamps before the one before
  int64_t without_stamp = 0;
  int64_t gap_count = 0;
  std::vector<Gap> longest_gaps;  ///< at most 20, in order of time
};

/// What the receiver `label` says in a log.
struct GnssInfo {
  std::string label;
  std::map<FixQuality, int64_t> qualities;
  int64_t without_position = 0;  ///< records without a valid position
  int64_t with_velocity = 0;
  int64_t not_finite = 0;           ///< positions with a value that is not finite
  int64_t first_not_finite_ns = 0;  ///< stamp of the first of them
  int64_t bad_sigma = 0;            ///< zero or not finite
  Eigen::Vector3d min_sigma = Eigen::Vector3d::Zero();  ///< north, east, down [m]
  Eigen::Vector3d max_sigma = Eigen::Vector3d::Zero();
  Geodetic first, last;
  std::optional<Eigen::Vector3d> p_b_a;  ///< lever arm IMU to antenna, in b [m]
  std::optional<Eigen::Vector3d> p_v;    ///< the same, forward-right-down of the vehicle [m]
};

/// Contents of a rawlog.
struct RawlogInfo {
  std::string path;
  int64_t file_bytes = 0;
  bool compressed = false;
  bool sensory_frames = false;  ///< some observations came in sensory frames
  int64_t records = 0;          ///< top-level objects read
  std::vector<StreamInfo> streams;
  std::vector<GnssInfo> receivers;
  std::string imu_label;                    ///< the one RawlogSource takes; empty: none
  std::optional<state::Mounting> mounting;  ///< of that IMU
  int64_t imu_not_finite = 0;               ///< samples with a value that is not finite
  int64_t first_imu_not_finite_ns = 0;      ///< stamp of the first of them
  /// Objects of other classes, with neither label nor stamp: their contents are not read.
  std::map<std::string, int64_t> other_records;
  std::optional<std::string> damage;  ///< one line, if the file breaks off; the rest is up to there
};

/// Reads a rawlog through, with memory that grows only with the number of labels. `progress` gets
/// the part that is read, 0 to 1. Throws DataError as RawlogSource does for files that are missing,
/// empty or no rawlogs; damage further on is reported in the result.
RawlogInfo read_rawlog_info(const std::string& path,
                            const std::function<void(double)>& progress = {});

}  // namespace foucault::rawlog
