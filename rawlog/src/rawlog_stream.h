#pragma once

#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "gz_archive.h"

namespace foucault::rawlog {

/// An observation and where it stood.
struct LoggedObservation {
  mrpt::obs::CObservation::Ptr observation;
  int64_t record = 0;     ///< number of its top-level object, from 1
  bool in_frame = false;  ///< came in a sensory frame
};

/// The observations of a rawlog, one after another, whatever way it packs them. Everything MRPT
/// throws comes out as a DataError of one line that says where and what.
class RawlogStream {
 public:
  explicit RawlogStream(const std::string& path);

  std::optional<LoggedObservation> next();

  int64_t records() const { return records_; }
  double progress() const { return archive_.progress(); }
  bool compressed() const { return archive_.compressed(); }
  uint64_t file_size() const { return archive_.file_size(); }
  /// Top-level objects that hold no observations, by class.
  const std::map<std::string, int64_t>& other_records() const { return other_records_; }

 private:
  mrpt::serialization::CSerializable::Ptr read_object();
  std::string explain(const std::string& what) const;

  std::string path_;
  GzReadArchive archive_;
  std::deque<LoggedObservation> pending_;
  int64_t records_ = 0;
  std::map<std::string, int64_t> other_records_;
};

/// Class name without name spaces.
std::string class_name(const mrpt::rtti::CObject& object);

}  // namespace foucault::rawlog
