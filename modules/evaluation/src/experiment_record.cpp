#include "experiment_record.h"

#include <utility>

#include "foucault/store/archive.h"

namespace foucault::evaluation {
namespace {

using store::integral;
using store::list;
using store::optional;

template <class Archive, class Vector>
void vector3(Archive& archive, Vector& v) {
  for (Eigen::Index i = 0; i < 3; ++i) archive.field(v[i]);
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
    integral(archive, notice.kind);
    archive.field(notice.text);
  });
}

template <class Archive, class Result>
void fields(Archive& archive, Result& result) {
  integral(archive, result.run.truth);
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
  store::Recorder recorder;
  const std::string prefix = prefix_of(result);
  const bool is_named = result.failure.compare(0, prefix.size(), prefix) == 0;
  recorder.size(is_named ? 1 : 0);
  recorder.field(is_named ? result.failure.substr(prefix.size()) : result.failure);
  fields(recorder, result);
  return recorder.bytes();
}

ExperimentResult result_with(const RunName& name, std::string_view content) {
  ExperimentResult result{name, {}, {}, {}, {}, {}};
  store::Player player(content);
  const bool is_named = player.size(0) != 0;
  player.field(result.failure);
  if (is_named) result.failure = prefix_of(result) + result.failure;
  fields(player, result);
  player.finish();
  return result;
}

}  // namespace foucault::evaluation
