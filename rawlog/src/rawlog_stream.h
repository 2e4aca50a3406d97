#pragma once

#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "inflated_file.h"
#include "mrpt_records.h"

namespace foucault::rawlog {

/// An observation and where it stood. Exactly one of `imu`, `ins` and `observation` is there, or
/// none for a class that we do not use, of which nothing but the class is known.
struct LoggedObservation {
  std::string_view type;  ///< class without name spaces; valid until the next one is read
  std::optional<ImuRecord> imu;
  std::optional<InsRecord> ins;              ///< where one is asked for
  mrpt::obs::CObservation::Ptr observation;  ///< GPS, odometry, robot pose, comment
  std::optional<int64_t> t_ns;
  int64_t record = 0;     ///< number of its top-level object, from 1
  bool in_frame = false;  ///< came in a sensory frame

  std::string_view label() const {
    if (imu) return imu->label;
    if (ins) return ins->label;
    return observation ? std::string_view(observation->sensorLabel) : std::string_view();
  }
};

/// The last two bytes of what was passed over, piece by piece.
class LastTwo {
 public:
  void add(const unsigned char* begin, const unsigned char* end) {
    if (end - begin >= 2) before_last_ = end[-2];
    if (end - begin == 1) before_last_ = last_;
    if (end > begin) last_ = end[-1];
  }
  bool one_end() const { return last_ == kEndOfObject; }
  bool two_ends() const { return one_end() && before_last_ == kEndOfObject; }

 private:
  unsigned char before_last_ = 0;
  unsigned char last_ = 0;
};

/// The observations of a rawlog, one after another, whatever way it packs them. The first damage
/// ends it: everything before it is given out.
class RawlogStream {
 public:
  /// CObservationGPS of `ins_label` that hold an INSPVAS alone are InsRecords.
  /// Throws DataError as InflatedFile.
  explicit RawlogStream(const std::string& path, std::string ins_label = {});

  /// None at the end, and at a damage. Throws DataError if the file is no rawlog.
  std::optional<LoggedObservation> next();

  /// What ended the log before its end: one line with file, place and remedy.
  const std::optional<std::string>& damage() const { return damage_; }
  int64_t records() const { return records_; }
  double progress() const { return damage_ ? 1 : file_.progress(); }
  bool compressed() const { return file_.compressed(); }
  uint64_t file_size() const { return file_.file_size(); }
  /// Top-level objects that hold no observations, by class.
  const std::map<std::string, int64_t>& other_records() const { return other_records_; }

 private:
  using Reader = mrpt::obs::CObservation::Ptr (*)(RecordCursor& cursor, int version);

  std::optional<LoggedObservation> read_next();
  std::optional<LoggedObservation> read_object(const ObjectHeader& header, Bytes window);
  LoggedObservation read_imu_object(RecordCursor& cursor, int version);
  LoggedObservation read_gps_object(RecordCursor& cursor, int version);
  LoggedObservation read_observation(RecordCursor& cursor, Reader read, int version);
  LoggedObservation begin_observation() const;
  void finish_object(size_t bytes);
  void begin_frame(RecordCursor& cursor, int version);
  void end_frame(Bytes window);
  void leave_frame();
  std::optional<LoggedObservation> skip_object(size_t header_size);
  LastTwo seek_end_of_object();

  std::string count_of_records() const;
  std::string place(uint64_t contents_offset) const;
  std::string broken_off();
  std::string damaged(const std::string& what) const;
  std::string of_another_version(const UnknownVersion& error) const;

  std::string path_;
  std::string ins_label_;
  InflatedFile file_;
  std::string object_;  ///< class of the object at hand
  bool in_frame_ = false;
  uint32_t frame_rest_ = 0;
  std::optional<int64_t> frame_t_ns_;  ///< of frames of version 0, whose stamp is everybody's
  int64_t records_ = 0;
  std::map<std::string, int64_t> other_records_;
  std::optional<std::string> damage_;
};

}  // namespace foucault::rawlog
