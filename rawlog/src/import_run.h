#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/time.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/rawlog/import.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "foucault/state/interfaces.h"
#include "text_table.h"

namespace foucault::rawlog {

/// One input file of an import. next() throws RowError for a bad row and goes on behind it.
class RecordReader {
 public:
  virtual ~RecordReader() = default;
  virtual std::optional<Record> next() = 0;
  virtual const InputFile& table() const = 0;
  /// Rows that have nothing to read: the receiver says it has no position, or the cells are blank.
  virtual int64_t without_fix() const { return 0; }
  /// What was assumed or left out, once all is read.
  virtual std::vector<std::string> notices() const { return {}; }
};

/// Rows that a stamp far ahead may have in a row, if it is wrong; more are a hole before them.
inline constexpr int kMostRowsAhead = 100;

/// Stamps of a stream: each after the one before, or at the same time if `may_equal`. One that goes
/// on from before a jump of the last rows is right, and they were wrong: who takes the rows leaves
/// them out.
class StampOrder {
 public:
  void check(const Place& row, int64_t t_ns, bool may_equal = false);
  static bool is_jump(int64_t from_ns, int64_t to_ns) {
    return to_ns - from_ns > kNanosecondsPerSecond;
  }

 private:
  void follow(int64_t t_ns);

  std::optional<int64_t> last_ns_;
  std::optional<int64_t> before_jump_ns_;
  int since_jump_ = 0;  ///< rows
};

/// Times that begin again at the end of their week or day, or as a counter does.
class RollingTime {
 public:
  explicit RollingTime(int64_t period_ns, std::optional<int64_t> last_ns = {})
      : period_ns_(period_ns), near_ns_(period_ns / 4), last_ns_(last_ns) {}
  /// One that begins again only within a minute of its end: it may also be switched on again.
  static RollingTime counter(int64_t period_ns) {
    RollingTime time(period_ns);
    time.near_ns_ = 60 * kNanosecondsPerSecond;
    return time;
  }

  /// As if they went on, from the period of the first or of `last_ns` on.
  int64_t unrolled(int64_t time_ns);

 private:
  bool begins(int64_t time_ns) const { return time_ns < near_ns_; }
  bool ends(int64_t time_ns) const {
    return time_ns > period_ns_ - near_ns_ && time_ns < period_ns_ + near_ns_;
  }

  int64_t period_ns_;
  int64_t near_ns_;  ///< to the end, or behind the beginning
  std::optional<int64_t> last_ns_;
  int64_t periods_ = 0;
};

/// Lengths of the intervals over which increments were summed, by the stamps of their ends.
class IntervalLengths {
 public:
  /// Of the one that ends there [ns]; none for the first, which is as long as the second. Where
  /// samples are missing, or the stamp before was wrong, it is one interval.
  std::optional<int64_t> ending_at(int64_t t_ns);

 private:
  std::optional<int64_t> last_ns_;
  int64_t nominal_ns_ = 0;
};

/// The inputs of an import, ready to be read.
struct ImportInputs {
  std::unique_ptr<RecordReader> imu;  ///< may be null
  std::unique_ptr<RecordReader> gnss;
  std::unique_ptr<RecordReader> reference;  ///< may be null
  std::unique_ptr<RecordReader> wheel;      ///< of wheel speeds alone; may be null
  std::string mapping;                      ///< its file, if there is one
  state::Mounting mounting;
  std::optional<Eigen::Vector3d> lever_arm_v;  ///< IMU to antenna [m]; none: not known
  imu::ImuOptions sensor;  ///< what is known of the IMU, for the notes of the log
};

/// Merges the inputs by stamp into options.out. Throws UsageError if that is one of the inputs.
ImportSummary run_import(const ImportOptions& options, ImportInputs inputs);

/// Latitude, longitude [rad], height [m] within their ranges, else a RowError.
Geodetic checked_position(const Place& row, double latitude, double longitude, double height);

/// The stamp of a row, if it is one that a rawlog can hold. Throws RowError.
int64_t checked_stamp(const Place& row, int64_t t_ns);

/// Midnight of a date as strptime's `format` has it; none if it is no date of the years 1950 to
/// 2150.
std::optional<int64_t> midnight_ns(const std::string& date, const char* format);

/// GPS week and second of week, which may lie outside its week, of a row. Throws RowError.
GpsTime checked_gps_time(const Place& row, int64_t week, int64_t tow_ns);
int64_t gps_stamp(const Place& row, int64_t week, int64_t tow_ns);

}  // namespace foucault::rawlog
