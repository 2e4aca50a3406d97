#include "texts/rawlog_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "foucault/core/fix_quality.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/core/units.h"
#include "foucault/export/json_object.h"

namespace foucault::app {
namespace {

using exports::Json;
using exports::Object;

constexpr std::size_t kGapsShown = 5;

double rate_hz(const rawlog::StreamInfo& stream) {
  return stream.median_interval > 0 ? 1 / stream.median_interval : 0;
}

double length_s(const rawlog::StreamInfo& stream) {
  return seconds_between(stream.first_ns, stream.last_ns);
}

Eigen::Vector3d mounting_rpy_deg(const state::Mounting& mounting) {
  const so3::Euler euler = so3::to_euler(mounting.q_v_b);
  return Eigen::Vector3d(euler.roll, euler.pitch, so3::wrap(euler.heading)) * units::kDegrees;
}

void add_notes(const rawlog::StreamInfo& s, std::vector<std::string>& notes) {
  if (s.backward > 0) notes.push_back(fmt::format("{}: {} stamps go back", s.label, s.backward));
  if (s.burst_samples > 0) {
    notes.push_back(fmt::format(
        "{}: stamps are of arrival, in bursts of {:.1f}; they are made even, {:.3g} ms apart",
        s.label, s.burst_samples, 1e3 * s.median_interval));
  } else if (s.duplicates > 0) {
    notes.push_back(fmt::format("{}: {} stamps repeat the one before", s.label, s.duplicates));
  }
  if (s.without_stamp > 0) {
    notes.push_back(fmt::format("{}: {} observations have no stamp", s.label, s.without_stamp));
  }
}

void add_notes(const rawlog::GnssInfo& r, std::vector<std::string>& notes) {
  if (r.not_finite > 0) {
    notes.push_back(fmt::format("{}: {} fixes are not finite, the first at {}; they are left out",
                                r.label, r.not_finite, utc_text(r.first_not_finite_ns)));
  }
  if (r.bad_sigma > 0) {
    notes.push_back(
        fmt::format("{}: {} fixes with a sigma that is zero or not finite", r.label, r.bad_sigma));
  }
}

/// What a user should know before processing the log, a line each.
std::vector<std::string> health_notes(const rawlog::RawlogInfo& info) {
  std::vector<std::string> notes;
  if (info.damage) notes.push_back("damaged: " + *info.damage);
  if (info.imu_label.empty()) notes.emplace_back("no IMU: 'run' cannot process it");
  if (info.receivers.empty()) notes.emplace_back("no GNSS receiver: 'run' cannot process it");
  if (info.imu_not_finite > 0) {
    notes.push_back(fmt::format("{} IMU samples are not finite, the first at {}; they are left out",
                                info.imu_not_finite, utc_text(info.first_imu_not_finite_ns)));
  }
  for (const rawlog::StreamInfo& stream : info.streams) add_notes(stream, notes);
  for (const rawlog::GnssInfo& receiver : info.receivers) add_notes(receiver, notes);
  return notes;
}

std::string stream_text(const rawlog::StreamInfo& s) {
  std::string text =
      fmt::format("  {:<14} {:<22} {:>9}  {:>8.2f} Hz  {} .. {} ({:.1f} s)\n", s.label, s.type,
                  s.count, rate_hz(s), utc_text(s.first_ns), utc_text(s.last_ns), length_s(s));
  if (s.gap_count == 0) return text;
  text += fmt::format("  {:<14} {} gaps; the longest:", "", s.gap_count);
  std::vector<rawlog::Gap> gaps = s.longest_gaps;
  std::sort(gaps.begin(), gaps.end(),
            [](const rawlog::Gap& a, const rawlog::Gap& b) { return a.length > b.length; });
  gaps.resize(std::min(gaps.size(), kGapsShown));
  for (const rawlog::Gap& gap : gaps) {
    text +=
        fmt::format(" {:.3f} s at +{:.1f} s;", gap.length, seconds_between(s.first_ns, gap.t_ns));
  }
  text.back() = '\n';
  return text;
}

std::string receiver_text(const rawlog::GnssInfo& r) {
  std::string text = fmt::format("  {:<14}", r.label);
  for (const auto& [quality, count] : r.qualities) {
    text += fmt::format(" {} {},", count, name_of(quality));
  }
  text +=
      fmt::format(" {} without position, {} with velocity\n", r.without_position, r.with_velocity);
  text += fmt::format(
      "  {:<14} sigma north {:.3g} to {:.3g}, east {:.3g} to {:.3g}, down {:.3g} to {:.3g} m\n", "",
      r.min_sigma.x(), r.max_sigma.x(), r.min_sigma.y(), r.max_sigma.y(), r.min_sigma.z(),
      r.max_sigma.z());
  text +=
      fmt::format("  {:<14} from {:.7f} {:.7f} {:.1f} m\n", "", r.first.latitude * units::kDegrees,
                  r.first.longitude * units::kDegrees, r.first.height);
  if (r.p_v) {
    text += fmt::format("  {:<14} lever arm forward {:.3f}, right {:.3f}, down {:.3f} m\n", "",
                        r.p_v->x(), r.p_v->y(), r.p_v->z());
  }
  return text;
}

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json stream_json(const rawlog::StreamInfo& s) {
  Json gaps = Json::array();
  for (const rawlog::Gap& gap : s.longest_gaps) {
    gaps.push_back(Object().with("t_unix_s", to_seconds(gap.t_ns)).with("length_s", gap.length));
  }
  return Object()
      .with("label", s.label)
      .with("type", s.type)
      .with("count", s.count)
      .with("first_unix_s", to_seconds(s.first_ns))
      .with("last_unix_s", to_seconds(s.last_ns))
      .with("duration_s", length_s(s))
      .with("rate_hz", rate_hz(s))
      .with("median_interval_s", s.median_interval)
      .with("duplicates", s.duplicates)
      .with("backward", s.backward)
      .with("without_stamp", s.without_stamp)
      .with("gaps", s.gap_count)
      .with("longest_gaps", gaps);
}

Json geodetic_json(const Geodetic& p) {
  return Object()
      .with("lat_deg", p.latitude * units::kDegrees)
      .with("lon_deg", p.longitude * units::kDegrees)
      .with("height_m", p.height);
}

Json receiver_json(const rawlog::GnssInfo& r) {
  Json qualities = Json::object();
  for (const auto& [quality, count] : r.qualities) qualities[std::string(name_of(quality))] = count;
  Json json = Object()
                  .with("label", r.label)
                  .with("qualities", qualities)
                  .with("without_position", r.without_position)
                  .with("with_velocity", r.with_velocity)
                  .with("not_finite", r.not_finite)
                  .with("bad_sigma", r.bad_sigma)
                  .with("min_sigma_m", vector_json(r.min_sigma))
                  .with("max_sigma_m", vector_json(r.max_sigma))
                  .with("first", geodetic_json(r.first))
                  .with("last", geodetic_json(r.last));
  if (r.p_v) json["lever_arm_m"] = vector_json(*r.p_v);
  return json;
}

}  // namespace

std::string rawlog_text(const rawlog::RawlogInfo& info) {
  std::string text = fmt::format("{}: {:.1f} MB{}, {} records{}\n", info.path,
                                 1e-6 * static_cast<double>(info.file_bytes),
                                 info.compressed ? ", compressed" : "", info.records,
                                 info.sensory_frames ? ", in sensory frames" : "");
  text += "streams\n";
  for (const rawlog::StreamInfo& stream : info.streams) text += stream_text(stream);
  if (!info.receivers.empty()) text += "GNSS\n";
  for (const rawlog::GnssInfo& receiver : info.receivers) text += receiver_text(receiver);
  if (info.mounting) {
    const Eigen::Vector3d rpy = mounting_rpy_deg(*info.mounting);
    text += fmt::format("IMU\n  {:<14} mounted at roll {:.2f}, pitch {:.2f}, heading {:.2f} deg\n",
                        info.imu_label, rpy.x(), rpy.y(), rpy.z());
  }
  for (const auto& [type, count] : info.other_records) {
    text += fmt::format("skipped {} records of {}\n", count, type);
  }
  text += "health\n";
  const std::vector<std::string> notes = health_notes(info);
  for (const std::string& note : notes) text += "  " + note + "\n";
  if (notes.empty()) text += "  nothing to complain about\n";
  return text;
}

std::string rawlog_json(const rawlog::RawlogInfo& info) {
  Json json =
      Object()
          .with("path", info.path)
          .with("file_bytes", info.file_bytes)
          .with("compressed", info.compressed)
          .with("sensory_frames", info.sensory_frames)
          .with("records", info.records)
          .with("streams", Json::array())
          .with("gnss", Json::array())
          .with("imu",
                Object().with("label", info.imu_label).with("not_finite", info.imu_not_finite))
          .with("other_records", info.other_records)
          .with("health", health_notes(info));
  for (const rawlog::StreamInfo& stream : info.streams)
    json["streams"].push_back(stream_json(stream));
  for (const rawlog::GnssInfo& receiver : info.receivers)
    json["gnss"].push_back(receiver_json(receiver));
  if (info.mounting) {
    json["imu"]["mounting_rpy_deg"] = vector_json(mounting_rpy_deg(*info.mounting));
  }
  return json.dump(2) + "\n";
}

}  // namespace foucault::app
