#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "foucault/rawlog/guess_mapping.h"

namespace foucault::rawlog {

namespace {

/// A scalar as YAML reads it back.
std::string guess_scalar(const std::string& text) {
  const bool plain =
      !text.empty() && text != "null" &&
      std::isalnum(static_cast<unsigned char>(text.front())) != 0 &&
      std::all_of(text.begin(), text.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '_' || c == '.' || c == '-' || c == '/' || c == '+';
      });
  if (plain) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

/// Lines of YAML with what is known beside them.
class GuessLines {
 public:
  explicit GuessLines(const std::map<std::string, std::string>& comments) : comments_(comments) {}

  void section(const std::string& name) {
    section_ = name;
    text_ += fmt::format("\n{}:\n", name);
  }
  void top(const std::string& key, const std::string& value) {
    text_ += '\n';
    add(fmt::format("{}: {}", key, value), key);
  }
  /// `key` without its section.
  void line(const std::string& key, const std::string& value) {
    add(fmt::format("  {}: {}", key, value), section_ + "." + key);
  }
  void map(const std::string& key, const std::map<std::string, std::string>& values) {
    add(fmt::format("  {}:", key), section_ + "." + key);
    for (const auto& [name, value] : values) {
      text_ += fmt::format("    {}: {}\n", guess_scalar(name), guess_scalar(value));
    }
  }
  /// A comment of a key that is not there.
  void absent(const std::string& key) {
    const auto found = comments_.find(section_ + "." + key);
    if (found != comments_.end()) text_ += fmt::format("  # {}: {}\n", key, found->second);
  }
  void note(const std::string& text) { text_ += "# " + text + "\n"; }
  const std::string& text() const { return text_; }

 private:
  void add(const std::string& line, const std::string& key) {
    constexpr size_t kColumn = 40;
    const auto found = comments_.find(key);
    text_ += line;
    if (found != comments_.end()) {
      text_ += std::string(line.size() < kColumn ? kColumn - line.size() : 1, ' ');
      text_ += "# " + found->second;
    }
    text_ += '\n';
  }

  const std::map<std::string, std::string>& comments_;
  std::string section_;
  std::string text_;
};

std::string guess_number(double value) { return fmt::format("{}", value); }

std::string time_text(const TimeMapping& time) {
  std::string text = "{system: " + time.system;
  if (time.unit != "s") text += ", unit: " + time.unit;
  if (time.gps_week) text += ", gps_week: " + guess_number(*time.gps_week);
  if (time.boot_sow) text += ", boot_sow: " + guess_number(*time.boot_sow);
  if (!time.date.empty()) text += ", date: " + time.date;
  if (time.offset_s != 0) text += ", offset_s: " + guess_number(time.offset_s);
  return text + "}";
}

void write_table(GuessLines& lines, const std::string& section, const TableMapping& mapping) {
  lines.section(section);
  lines.line("file", guess_scalar(mapping.file));
  if (!mapping.header) lines.line("header", "false");
  lines.map("columns", mapping.columns);
  lines.line("time", time_text(mapping.time));
}

void write_imu(GuessLines& lines, const ImuMapping& imu) {
  write_table(lines, "imu", imu);
  lines.line("gyro_unit", imu.gyro_unit);
  if (imu.gyro_scale != 1) lines.line("gyro_scale", guess_number(imu.gyro_scale));
  lines.line("accel_unit", imu.accel_unit);
  if (imu.accel_scale != 1) lines.line("accel_scale", guess_number(imu.accel_scale));
  lines.line("accel_sign", imu.accel_sign);
  lines.line("axes", fmt::format("[{}]", fmt::join(imu.axes, ", ")));
}

void write_positions(GuessLines& lines, const PositionMapping& mapping) {
  if (mapping.columns.count("latitude") > 0) {
    lines.line("angle_unit", mapping.angle_unit);
    if (mapping.height_m) lines.line("height_m", guess_number(*mapping.height_m));
    if (mapping.columns.count("height") > 0) lines.line("height", mapping.height);
  }
  if (mapping.height_unit != "auto") lines.line("height_unit", mapping.height_unit);
  if (mapping.geoid_separation_m) {
    lines.line("geoid_separation_m", guess_number(*mapping.geoid_separation_m));
  }
  lines.absent("origin");
}

void write_gnss(GuessLines& lines, const GnssMapping& gnss) {
  write_table(lines, "gnss", gnss);
  write_positions(lines, gnss);
  if (gnss.columns.count("velocity_north") > 0 || gnss.columns.count("speed") > 0) {
    lines.line("velocity_unit", gnss.velocity_unit);
  }
  if (gnss.sigma_unit != "m") lines.line("sigma_unit", gnss.sigma_unit);
  if (!gnss.sigma_m.empty())
    lines.line("sigma_m", fmt::format("[{}]", fmt::join(gnss.sigma_m, ", ")));
  if (!gnss.velocity_sigma_m_s.empty()) {
    lines.line("velocity_sigma_m_s", fmt::format("[{}]", fmt::join(gnss.velocity_sigma_m_s, ", ")));
  }
  if (gnss.quality_table.empty()) {
    lines.line("quality", gnss.quality);
  } else {
    lines.map("quality_table", gnss.quality_table);
  }
}

}  // namespace

std::string mapping_text(const MappingGuess& guess) {
  GuessLines lines(guess.comments);
  lines.note("Guessed from the files. Check what is marked `not sure` and `to be told`, then:");
  lines.note("  foucault import csv --mapping THIS.yaml --out trip.rawlog");
  for (const std::string& note : guess.notes) lines.note(note);
  write_imu(lines, guess.mapping.imu);
  if (!guess.mapping.gnss.file.empty()) write_gnss(lines, guess.mapping.gnss);
  if (!guess.mapping.reference.file.empty()) {
    write_table(lines, "reference", guess.mapping.reference);
    write_positions(lines, guess.mapping.reference);
  }
  lines.top("lever_arm_m", fmt::format("[{}]", fmt::join(guess.mapping.lever_arm_m, ", ")));
  return lines.text();
}

}  // namespace foucault::rawlog
