#include "experiment_record.h"

#include <type_traits>
#include <utility>

#include "foucault/store/bytes.h"

namespace foucault::evaluation {
namespace {

/// Writes what it is shown. Reader has the same calls: one list of fields serves both.
class Recorder {
 public:
  void field(const int64_t& value) { writer_.put(value); }
  void field(const double& value) { writer_.put(value); }
  void field(const std::string& text) { writer_.put(std::string_view(text)); }
  std::size_t size(std::size_t count) {
    writer_.put(static_cast<uint64_t>(count));
    return count;
  }
  const std::string& bytes() const { return writer_.bytes(); }

 private:
  store::ByteWriter writer_;
};

class Player {
 public:
  explicit Player(std::string_view bytes) : reader_(bytes) {}
  void field(int64_t& value) { value = reader_.integer(); }
  void field(double& value) { value = reader_.number(); }
  void field(std::string& text) { text = reader_.text(); }
  std::size_t size(std::size_t) { return reader_.count(); }
  void finish() const { reader_.finish(); }

 private:
  store::ByteReader reader_;
};

template <class Archive, class List, class Visit>
void list(Archive& archive, List& values, Visit visit) {
  const std::size_t count = archive.size(values.size());
  if constexpr (std::is_const_v<List>) {
    for (const auto& value : values) visit(value);
  } else {
    for (std::size_t i = 0; i < count; ++i) visit(values.emplace_back());
  }
}

template <class Archive, class Optional, class Visit>
void optional(Archive& archive, Optional& value, Visit visit) {
  const bool is_there = archive.size(value ? 1 : 0) != 0;
  if (!is_there) return;
  if constexpr (!std::is_const_v<Optional>) value.emplace();
  visit(*value);
}

template <class Archive, class Vector>
void vector3(Archive& archive, Vector& v) {
  for (Eigen::Index i = 0; i < 3; ++i) archive.field(v[i]);
}

template <class Archive, class Enum>
void enumerator(Archive& archive, Enum& value) {
  auto number = static_cast<int64_t>(value);
  archive.field(number);
  if constexpr (!std::is_const_v<Enum>) value = static_cast<Enum>(number);
}

template <class Archive, class Value>
void drift_value(Archive& archive, Value& value) {
  archive.field(value.horizontal);
  archive.field(value.vertical);
}

template <class Archive, class Any>
void outage(Archive& archive, Any& o) {
  archive.field(o.index);
  archive.field(o.begin_ns);
  archive.field(o.end_ns);
}

template <class Archive, class Sample>
void sample(Archive& archive, Sample& s) {
  archive.field(s.since_begin_s);
  vector3(archive, s.error_n);
  drift_value(archive, s.normalized);
}

template <class Archive, class Drift>
void drift(Archive& archive, Drift& d) {
  outage(archive, d.outage);
  drift_value(archive, d.maximum);
  drift_value(archive, d.end);
  list(archive, d.at_marks, [&](auto& mark) {
    optional(archive, mark, [&](auto& value) { drift_value(archive, value); });
  });
  list(archive, d.samples, [&](auto& s) { sample(archive, s); });
  archive.field(d.distance_m);
  optional(archive, d.after_return, [&](auto& error) {
    archive.field(error.rms);
    archive.field(error.maximum);
    optional(archive, error.settled_s, [&](auto& settled_s) { archive.field(settled_s); });
  });
}

template <class Archive, class Point>
void track_point(Archive& archive, Point& p) {
  archive.field(p.t_ns);
  archive.field(p.position.latitude);
  archive.field(p.position.longitude);
  archive.field(p.position.height);
  vector3(archive, p.error_n);
}

template <class Archive, class Notices>
void notices(Archive& archive, Notices& all) {
  list(archive, all, [&](auto& notice) {
    archive.field(notice.t_ns);
    enumerator(archive, notice.kind);
    archive.field(notice.text);
  });
}

template <class Archive, class Result>
void fields(Archive& archive, Result& result) {
  enumerator(archive, result.run.truth);
  list(archive, result.run.drifts, [&](auto& d) { drift(archive, d); });
  list(archive, result.run.withheld, [&](auto& o) { outage(archive, o); });
  archive.field(result.run.scheduled);
  archive.field(result.run.first_fix_ns);
  archive.field(result.run.last_fix_ns);
  list(archive, result.track, [&](auto& p) { track_point(archive, p); });
  notices(archive, result.notices);
  notices(archive, result.remarks.notices);
  optional(archive, result.remarks.damage, [&](auto& text) { archive.field(text); });
}

/// The line of a failure begins with the recording, whose name others may have changed.
std::string prefix_of(const ExperimentResult& result) { return result.recording + ": "; }

}  // namespace

std::string content_of(const ExperimentResult& result) {
  Recorder recorder;
  const std::string prefix = prefix_of(result);
  const bool is_named = result.failure.compare(0, prefix.size(), prefix) == 0;
  recorder.size(is_named ? 1 : 0);
  recorder.field(is_named ? result.failure.substr(prefix.size()) : result.failure);
  fields(recorder, result);
  return recorder.bytes();
}

ExperimentResult with_content(ExperimentResult named, std::string_view content) {
  Player player(content);
  const bool is_named = player.size(0) != 0;
  player.field(named.failure);
  if (is_named) named.failure = prefix_of(named) + named.failure;
  fields(player, named);
  player.finish();
  return named;
}

}  // namespace foucault::evaluation
