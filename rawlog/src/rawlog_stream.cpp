#include "rawlog_stream.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/version.h>

#include <new>

#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string without_namespace(const std::string& name) {
  const size_t colon = name.rfind(':');
  return colon == std::string::npos ? name : name.substr(colon + 1);
}

/// MRPT_VERSION is 0xABC for version A.B.C, B and C hexadecimal digits (0x2bc is 2.11.12).
std::string mrpt_version() {
  return fmt::format("{}.{}.{}", (MRPT_VERSION >> 8) & 0xF, (MRPT_VERSION >> 4) & 0xF,
                     MRPT_VERSION & 0xF);
}

}  // namespace

std::string class_name(const mrpt::rtti::CObject& object) {
  return without_namespace(object.GetRuntimeClass()->className);
}

RawlogStream::RawlogStream(const std::string& path) : path_(path), archive_(path) {}

std::optional<LoggedObservation> RawlogStream::next() {
  while (pending_.empty()) {
    const mrpt::serialization::CSerializable::Ptr object = read_object();
    if (!object) return std::nullopt;
    if (auto observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object)) {
      return LoggedObservation{std::move(observation), records_, false};
    }
    if (const auto frame = std::dynamic_pointer_cast<mrpt::obs::CSensoryFrame>(object)) {
      for (const mrpt::obs::CObservation::Ptr& observation : *frame) {
        if (observation) pending_.push_back({observation, records_, true});
      }
      continue;
    }
    ++other_records_[class_name(*object)];
  }
  LoggedObservation first = std::move(pending_.front());
  pending_.pop_front();
  return first;
}

mrpt::serialization::CSerializable::Ptr RawlogStream::read_object() {
  std::string what;
  try {
    mrpt::serialization::CSerializable::Ptr object;
    while (!object) {  // null objects are legal and say nothing
      archive_.begin_object();
      object = archive_.ReadObject();
      ++records_;
    }
    return object;
  } catch (const mrpt::serialization::CExceptionEOF&) {
    if (archive_.end() == GzReadArchive::End::clean) return {};
  } catch (const std::bad_alloc&) {
    what = "a length in it is beyond the memory";
  } catch (const std::exception& error) {
    what = error.what();
  } catch (...) {
    what = "unknown error";
  }
  throw DataError(explain(what));
}

std::string RawlogStream::explain(const std::string& what) const {
  const std::string name = archive_.object_class();
  const int64_t record = records_ + 1;
  if (records_ == 0 && (name.empty() || (contains(what, "not registered") && name[0] != 'C'))) {
    return fmt::format("'{}' is no MRPT rawlog; convert it with `foucault import`", path_);
  }
  if (archive_.end() == GzReadArchive::End::truncated) {
    return fmt::format(
        "'{}' is truncated: its contents end at byte {} within record {}, after {} whole "
        "record{}; copy or record it again",
        path_, archive_.offset(), record, records_, records_ == 1 ? "" : "s");
  }
  if (contains(what, "serialization version")) {
    const bool gps = name == "CObservationGPS" || contains(what, "CObservationGPS");
    return fmt::format(
        "'{}': record {} ({}) was written by a newer MRPT{} than the {} of this program; build "
        "the program with that MRPT, or write the log again with an older one",
        path_, record, gps ? "CObservationGPS" : without_namespace(name),
        gps ? " (2.11.12 or later)" : "", mrpt_version());
  }
  if (contains(what, "not registered")) {
    return fmt::format(
        "'{}': record {} at byte {} is of class '{}', which MRPT's observation library does not "
        "know; remove such records with rawlog-edit",
        path_, record, archive_.offset(), name);
  }
  return fmt::format(
      "'{}' is damaged at byte {} of its contents, in record {}{}; copy or record "
      "it again",
      path_, archive_.offset(), record, name.empty() ? "" : " (" + without_namespace(name) + ")");
}

}  // namespace foucault::rawlog
