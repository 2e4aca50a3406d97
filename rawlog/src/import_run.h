#pragma once

#include <memory>
#include <optional>
#include <string>

#include "foucault/core/time.h"
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
  /// Rows in which the receiver says it has no position.
  virtual int64_t without_fix() const { return 0; }
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

/// The inputs of an import, ready to be read.
struct ImportInputs {
  std::unique_ptr<RecordReader> imu;
  std::unique_ptr<RecordReader> gnss;
  std::unique_ptr<RecordReader> reference;  ///< may be null
  std::string mapping;                      ///< its file, if there is one
  state::Mounting mounting;
  Eigen::Vector3d lever_arm_v = Eigen::Vector3d::Zero();  ///< IMU to antenna [m]
};

/// Merges the inputs by stamp into options.out. Throws UsageError if that is one of the inputs.
ImportSummary run_import(const ImportOptions& options, ImportInputs inputs);

/// Latitude, longitude [rad], height [m] within their ranges, else a RowError.
Geodetic checked_position(const Place& row, double latitude, double longitude, double height);

/// The stamp of a row, if it is one that a rawlog can hold. Throws RowError.
int64_t checked_stamp(const Place& row, int64_t t_ns);

/// GPS week and second of week, which may lie outside its week, of a row. Throws RowError.
int64_t gps_stamp(const Place& row, int64_t week, int64_t tow_ns);

}  // namespace foucault::rawlog
