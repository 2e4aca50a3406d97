#include "rawlog_stream.h"

#include <fmt/format.h>
#include <mrpt/version.h>

#include <utility>

#include "foucault/core/error.h"
#include "foucault/rawlog/mrpt_convert.h"

namespace foucault::rawlog {

namespace {

/// MRPT_VERSION is 0xABC for version A.B.C, B and C hexadecimal digits (0x2bc is 2.11.12).
std::string mrpt_version() {
  return fmt::format("{}.{}.{}", (MRPT_VERSION >> 8) & 0xF, (MRPT_VERSION >> 4) & 0xF,
                     MRPT_VERSION & 0xF);
}

constexpr std::string_view kNull = "nullptr";

/// Of the class of a log's first object.
bool looks_like_mrpt(std::string_view class_name) {
  const std::string_view name = without_namespace(class_name);
  return name == kNull || (name.size() > 1 && name[0] == 'C' && name[1] >= 'A' && name[1] <= 'Z');
}

}  // namespace

RawlogStream::RawlogStream(const std::string& path, std::string ins_label)
    : path_(path), ins_label_(std::move(ins_label)), file_(path) {}

std::optional<LoggedObservation> RawlogStream::next() {
  if (damage_) return std::nullopt;
  std::string what;
  try {
    return read_next();
  } catch (const RecordTooShort&) {
    what = broken_off();
  } catch (const UnknownVersion& error) {
    what = of_another_version(error);
  } catch (const BadRecord& error) {
    what = damaged(error.what());
  }
  if (records_ == 0 && object_.empty()) {
    throw DataError(
        fmt::format("'{}' is no MRPT rawlog; convert it with `foucault import`", path_));
  }
  damage_ = what;
  return std::nullopt;
}

std::optional<LoggedObservation> RawlogStream::read_next() {
  while (true) {
    const Bytes window = file_.window();
    if (in_frame_ && frame_rest_ == 0) {
      end_frame(window);
      continue;
    }
    if (window.size() == 0 && file_.end() == InflatedFile::End::clean && !in_frame_) {
      return std::nullopt;
    }
    const std::optional<ObjectHeader> header = read_header(window);
    if (!header) throw BadRecord("no object begins there");
    if (object_.empty() && !looks_like_mrpt(header->name)) throw BadRecord("no class of MRPT");
    object_.assign(header->name);
    if (std::optional<LoggedObservation> logged = read_object(*header, window)) return logged;
  }
}

std::optional<LoggedObservation> RawlogStream::read_object(const ObjectHeader& header,
                                                           Bytes window) {
  RecordCursor cursor(window);
  cursor.skip(header.size);
  const std::string_view type = without_namespace(object_);
  if (type == "CObservationIMU") return read_imu_object(cursor, header.version);
  if (type == "CObservationGPS") return read_gps_object(cursor, header.version);
  if (type == "CObservationOdometry")
    return read_observation(cursor, read_odometry, header.version);
  if (type == "CObservationRobotPose") {
    return read_observation(cursor, read_robot_pose, header.version);
  }
  if (type == "CObservationComment" && !in_frame_ && records_ == 0) {  // the notes of our logs
    return read_observation(cursor, read_comment, header.version);
  }
  if (type == "CSensoryFrame" && !in_frame_) {
    begin_frame(cursor, header.version);
  } else if (type == kNull && header.version == kEndOfObject) {  // it has no version
    finish_object(header.size);
  } else {
    return skip_object(header.size);
  }
  return std::nullopt;
}

LoggedObservation RawlogStream::read_imu_object(RecordCursor& cursor, int version) {
  LoggedObservation logged = begin_observation();
  logged.imu = read_imu(cursor, version);
  logged.t_ns = frame_t_ns_ ? frame_t_ns_ : logged.imu->t_ns;
  finish_object(cursor.position());
  return logged;
}

LoggedObservation RawlogStream::read_gps_object(RecordCursor& cursor, int version) {
  if (ins_label_.empty()) return read_observation(cursor, read_gps, version);
  std::optional<InsRecord> ins = read_ins(cursor, version, ins_label_);
  if (!ins) return read_observation(cursor, read_gps, version);
  LoggedObservation logged = begin_observation();
  logged.t_ns = frame_t_ns_ ? frame_t_ns_ : ins->t_ns;
  logged.ins = std::move(ins);
  finish_object(cursor.position());
  return logged;
}

LoggedObservation RawlogStream::read_observation(RecordCursor& cursor, Reader read, int version) {
  LoggedObservation logged = begin_observation();
  logged.observation = read(cursor, version);
  logged.t_ns = frame_t_ns_ ? frame_t_ns_ : from_mrpt(logged.observation->timestamp);
  finish_object(cursor.position());
  return logged;
}

LoggedObservation RawlogStream::begin_observation() const {
  LoggedObservation logged;
  logged.type = without_namespace(object_);
  logged.record = records_ + 1;
  logged.in_frame = in_frame_;
  return logged;
}

void RawlogStream::finish_object(size_t bytes) {
  file_.advance(bytes);
  if (in_frame_) {
    --frame_rest_;
  } else {
    ++records_;
  }
}

/// Version 0 of a frame has a number and a stamp, 1 a number, 2 neither.
void RawlogStream::begin_frame(RecordCursor& cursor, int version) {
  if (version > 2) throw UnknownVersion(UnknownVersion::Age::newer);
  if (version < 2) cursor.skip(sizeof(uint32_t));
  if (version == 0) {
    const mrpt::Clock::duration ticks(cursor.get<int64_t>());
    frame_t_ns_ = from_mrpt(mrpt::system::TTimeStamp(ticks));
  }
  frame_rest_ = cursor.get<uint32_t>();
  in_frame_ = true;
  file_.advance(cursor.position());
}

void RawlogStream::end_frame(Bytes window) {
  RecordCursor cursor(window);
  if (cursor.get<uint8_t>() != kEndOfObject) {
    throw BadRecord("the sensory frame does not end after as many observations as it says");
  }
  leave_frame();
  finish_object(cursor.position());
}

void RawlogStream::leave_frame() {
  in_frame_ = false;
  frame_t_ns_.reset();
}

std::optional<LoggedObservation> RawlogStream::skip_object(size_t header_size) {
  const LoggedObservation logged = begin_observation();
  file_.advance(header_size);
  const LastTwo last = seek_end_of_object();
  finish_object(0);
  if (in_frame_ && frame_rest_ == 0) {
    if (!last.two_ends()) throw BadRecord("the sensory frame does not end with its last object");
    leave_frame();
    finish_object(0);
  }
  if (is_observation_class(object_)) return logged;
  ++other_records_[std::string(without_namespace(object_))];
  return std::nullopt;
}

/// Advances to the object that follows, or to the end of the contents.
LastTwo RawlogStream::seek_end_of_object() {
  LastTwo last;
  const auto pass = [&](const unsigned char* begin, const unsigned char* end) {
    last.add(begin, end);
    file_.advance(static_cast<size_t>(end - begin));
  };
  while (true) {
    const Bytes window = file_.window();
    const unsigned char* const found = find_end_of_object(window.begin, window);
    if (found != window.end) {
      pass(window.begin, found + 1);
      return last;
    }
    if (file_.end() != InflatedFile::End::none) {
      pass(window.begin, window.end);
      if (file_.end() == InflatedFile::End::clean && last.one_end()) return last;
      throw RecordTooShort();
    }
    pass(window.begin, window.end - kLongestHeader);  // one may have begun
  }
}

std::string RawlogStream::count_of_records() const {
  return fmt::format("after {} whole record{}", records_, records_ == 1 ? "" : "s");
}

/// A place in the contents, and in the file where that is another one.
std::string RawlogStream::place(uint64_t contents_offset) const {
  std::string text = fmt::format("byte {} of its contents", contents_offset);
  if (file_.compressed()) text += fmt::format(" (before byte {} of the file)", file_.file_offset());
  return text;
}

std::string RawlogStream::broken_off() {
  const uint64_t contents_end = file_.offset() + file_.window().size();
  const char* const remedy = "copy or record it again";
  switch (file_.end()) {
    case InflatedFile::End::none:
      return damaged("a length in it is beyond every measure");
    case InflatedFile::End::unreadable:
      return fmt::format("'{}' cannot be read beyond byte {}, {}: an error of the disk; {}", path_,
                         file_.file_offset(), count_of_records(), remedy);
    case InflatedFile::End::damaged:
      return fmt::format(
          "'{}' is damaged: its compression breaks at byte {} of the file, byte {} of "
          "its contents, {}; {}",
          path_, file_.file_offset(), contents_end, count_of_records(), remedy);
    case InflatedFile::End::clean:
    case InflatedFile::End::truncated:
      break;
  }
  return fmt::format("'{}' is truncated: it ends at byte {} of its contents, {}; {}", path_,
                     contents_end, count_of_records(), remedy);
}

std::string RawlogStream::damaged(const std::string& what) const {
  const std::string_view type = without_namespace(object_);
  return fmt::format("'{}' is damaged at {}, in record {}{}: {}; copy or record it again", path_,
                     place(file_.offset()), records_ + 1,
                     type.empty() ? "" : fmt::format(" ({})", type), what);
}

std::string RawlogStream::of_another_version(const UnknownVersion& error) const {
  const std::string_view type = without_namespace(object_);
  if (error.age() == UnknownVersion::Age::older) {
    return fmt::format(
        "'{}': record {} ({}) at {} is of a version from before 2015, or damaged; write the log "
        "again with MRPT's rawlog-edit, or copy it again",
        path_, records_ + 1, type, place(file_.offset()));
  }
  return fmt::format(
      "'{}': record {} ({}) at {} was written by a newer MRPT{} than the {} of this program; build "
      "the program with that MRPT, or write the log again with an older one",
      path_, records_ + 1, type, place(file_.offset()),
      type == "CObservationGPS" ? " (2.11.12 or later)" : "", mrpt_version());
}

}  // namespace foucault::rawlog
