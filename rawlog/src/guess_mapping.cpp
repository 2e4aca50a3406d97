#include "foucault/rawlog/guess_mapping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "foucault/core/error.h"
#include "guess_gnss.h"
#include "guess_imu.h"

namespace foucault::rawlog {

namespace fs = std::filesystem;

namespace {

/// A file and what is in it.
struct GuessFile {
  GuessTable table;
  std::optional<ImuColumns> imu;
  std::optional<FixColumns> fixes;
};

/// The files of the sections.
struct GuessSections {
  const GuessFile* imu = nullptr;
  const GuessFile* gnss = nullptr;
  const GuessFile* reference = nullptr;
};

/// Of two tables of positions the trajectory has attitudes, or less of what receivers tell.
bool is_rather_gnss(const GuessFile& a, const GuessFile& b) {
  const auto receiver = [](const GuessFile& file) {
    const FixColumns& c = *file.fixes;
    int score = c.is_pose() ? -2 : 0;
    for (const char* role : {"quality", "sigma_north", "sigma_horizontal"})
      score += c.has(role) ? 1 : 0;
    return score;
  };
  return receiver(a) > receiver(b);
}

GuessSections sections_of(const std::vector<GuessFile>& files, std::vector<std::string>& notes) {
  GuessSections sections;
  std::vector<const GuessFile*> positions;
  for (const GuessFile& file : files) {
    if (file.imu && sections.imu == nullptr) sections.imu = &file;
    if (file.fixes) positions.push_back(&file);
  }
  std::stable_sort(positions.begin(), positions.end(),
                   [](const GuessFile* a, const GuessFile* b) { return is_rather_gnss(*a, *b); });
  if (!positions.empty()) sections.gnss = positions.front();
  if (positions.size() > 1 && positions.back()->fixes->is_pose())
    sections.reference = positions.back();
  for (const GuessFile& file : files) {
    if (&file == sections.imu || &file == sections.gnss || &file == sections.reference) continue;
    notes.push_back(fmt::format("{} is not used: {}", file.table.path,
                                file.imu ? "another IMU"
                                : file.fixes
                                    ? "more positions"
                                    : "neither gyroscopes with accelerometers nor positions"));
  }
  return sections;
}

std::string path_from(const std::string& folder, const std::string& path) {
  std::error_code error;
  const fs::path relative = fs::relative(path, folder.empty() ? "." : folder, error);
  return error || relative.empty() ? fs::absolute(path).string() : relative.string();
}

void set_comments(MappingGuess& guess, const std::string& section, const Remarks& remarks) {
  for (const auto& [key, remark] : remarks) {
    if (!remark.text.empty()) guess.comments[section + "." + key] = remark.comment();
  }
}

/// File, header and clock of a section.
void set_table(TableMapping& mapping, const GuessTable& table, const std::string& folder,
               const ClockGuess* clock, Remarks& remarks) {
  mapping.file = path_from(folder, table.path);
  mapping.header = table.header;
  if (clock == nullptr) {
    remarks["time"] = {false, "no column grows as a clock does; add the column `time`"};
    return;
  }
  mapping.time = clock->mapping;
  for (const auto& [role, key] : clock->columns) mapping.columns[role] = key;
  remarks["time"] = clock->remark;
}

void name_sensors(const GuessTable& table, const ImuColumns& columns, ImuMapping& mapping) {
  for (size_t i = 0; i < 3; ++i) {
    const std::string axis(1, "xyz"[i]);
    mapping.columns["gyro_" + axis] = table.columns[columns.gyro[i]].key;
    mapping.columns["accel_" + axis] = table.columns[columns.accel[i]].key;
  }
}

/// One of the names of the rates or accelerations, if it is a unit of such.
std::string named_unit(const GuessColumn& column, const std::vector<const char*>& units) {
  const bool known = std::any_of(units.begin(), units.end(),
                                 [&](const char* unit) { return column.name.unit == unit; });
  return known ? column.name.unit : std::string{};
}

bool is_increment_name(const GuessColumn& column) {
  return has_word(column.name, {"delta", "dtheta", "dvel", "dv", "inc", "velinc", "dang"});
}

void set_units(const GuessTable& table, const ImuColumns& columns, const ImuSeries& imu,
               const Gravity& gravity, const std::optional<MotionMatch>& match, ImuMapping& mapping,
               Remarks& remarks) {
  const double step =
      imu.t.size() < 2 ? 0 : (imu.t.back() - imu.t.front()) / static_cast<double>(imu.t.size() - 1);
  const GuessColumn& accel_column = table.columns[columns.accel[0]];
  std::string accel_name = named_unit(accel_column, {"m_s2", "g", "mg", "cm_s2", "m_s"});
  if (accel_name.empty() && is_increment_name(accel_column)) accel_name = "m_s";
  const UnitGuess accel = accel_unit(accel_name, gravity, are_counts(imu.accel), step);
  const GuessColumn& gyro_column = table.columns[columns.gyro[0]];
  const bool increments = accel.unit == "m_s";
  const std::string gyro_name = increments ? named_unit(gyro_column, {"rad", "deg"})
                                           : named_unit(gyro_column, {"rad_s", "deg_s"});
  const UnitGuess gyro = gyro_unit(gyro_name, imu, match ? match->turn : Regression{},
                                   are_counts(imu.gyro), increments, step);
  mapping.accel_unit = accel.unit;
  mapping.accel_scale = accel.scale;
  mapping.gyro_unit = gyro.unit;
  mapping.gyro_scale = gyro.scale;
  remarks["accel_unit"] = accel.remark;
  remarks["gyro_unit"] = gyro.remark;
}

/// What the fixes say of the clocks.
void remark_lag(const MotionMatch& match, GnssMapping& gnss, Remark& remark) {
  constexpr double kSmall = 0.1, kLeap = 14;
  if (!(match.turn.is_sure() || match.force.regression.is_sure() ||
        match.mirrored.regression.is_sure()))
    return;
  if (std::abs(match.lag) <= kSmall) {
    remark.text += "; fixes and IMU agree in time";
  } else if (std::abs(match.lag) > kLeap) {
    gnss.time.offset_s = std::round(match.lag);
    remark.text += fmt::format(
        "; offset_s: fixes agree with the IMU {:+.1f} s, one is GPS's, one UTC", match.lag);
  } else {
    remark.text += fmt::format(
        "; fixes fit the IMU best if moved by {:+.2f} s: offset_s, or leave it to "
        "the run",
        match.lag);
  }
}

void set_axes(const GuessTable& table, const ImuColumns& columns, const Gravity& gravity,
              const std::optional<MotionMatch>& match, ImuMapping& mapping, Remarks& remarks) {
  const bool ios = table.columns[columns.accel[0]].name.words == "accelerometer_acceleration";
  const AxesGuess axes = guess_axes(gravity, match, ios);
  mapping.axes = axes.axes;
  mapping.accel_sign = axes.reversed ? "-1" : "1";
  remarks["axes"] = axes.remark;
  remarks["accel_sign"] = axes.sign;
}

std::string words_before(const GuessTable& table, const FixColumns& columns) {
  const auto latitude = columns.roles.find("latitude");
  if (latitude == columns.roles.end()) return {};
  const std::string& words = table.columns[latitude->second].name.words;
  return words.find('_') == std::string::npos ? std::string{} : words.substr(0, words.find('_'));
}

/// Clocks of the sections; without a pair each the best by name.
struct SectionClocks {
  std::optional<ClockGuess> imu, gnss;
  bool overlap = false;
};

SectionClocks clocks_of_sections(const GuessSections& sections) {
  const GuessFile& imu_file = *sections.imu;
  const std::vector<ClockGuess> imu = clocks_of(
      imu_file.table, imu_rows(imu_file.table, *imu_file.imu), kImuSteps, imu_file.imu->first);
  std::vector<ClockGuess> gnss;
  if (sections.gnss != nullptr) {
    const GuessFile& file = *sections.gnss;
    const std::vector<bool> rows = fix_rows(file.table, *file.fixes);
    const bool held =
        sections.imu == sections.gnss && 10 * std::count(rows.begin(), rows.end(), true) >
                                             9 * static_cast<std::ptrdiff_t>(rows.size());
    gnss = clocks_of(file.table, rows, held ? kImuSteps : kFixSteps,
                     words_before(file.table, *file.fixes));
  }
  SectionClocks clocks;
  if (!imu.empty()) clocks.imu = imu.front();
  if (!gnss.empty()) clocks.gnss = gnss.front();
  if (const std::optional<ClockPair> pair = paired_clocks(imu, gnss)) {
    clocks = {pair->imu, pair->gnss, pair->overlap};
  }
  return clocks;
}

void guess_reference(const GuessFile& file, const std::string& folder, const ClockGuess* imu_clock,
                     MappingGuess& guess) {
  FixColumns columns = *file.fixes;
  ReferenceMapping& mapping = guess.mapping.reference;
  Remarks remarks;
  guess_positions(file.table, columns, mapping, remarks);
  for (const auto& [role, column] : columns.roles) {
    const bool is_motion =
        role == "roll" || role == "pitch" || role == "heading" || role.rfind("velocity_", 0) == 0;
    if (is_motion) mapping.columns[role] = file.table.columns[column].key;
  }
  if (mapping.columns.count("velocity_down") > 0) mapping.columns.erase("velocity_up");
  std::vector<ClockGuess> clocks =
      clocks_of(file.table, fix_rows(file.table, columns), kFixSteps, {});
  for (ClockGuess& clock : clocks_of(file.table, fix_rows(file.table, columns), kImuSteps, {})) {
    clocks.push_back(std::move(clock));  // trajectories have either rate
  }
  std::optional<ClockPair> pair;
  if (imu_clock != nullptr) pair = paired_clocks({*imu_clock}, clocks);
  const ClockGuess* clock = pair ? &pair->gnss : clocks.empty() ? nullptr : &clocks.front();
  set_table(mapping, file.table, folder, clock, remarks);
  set_comments(guess, "reference", remarks);
}

std::vector<GuessFile> read_files(const std::vector<std::string>& paths) {
  std::vector<GuessFile> files;
  for (const std::string& path : paths) {
    GuessFile file{read_guess_table(path), {}, {}};
    file.imu = imu_columns(file.table);
    file.fixes = fix_columns(file.table);
    files.push_back(std::move(file));
  }
  return files;
}

/// The section of fixes with what needs it only.
FixSeries guess_gnss(const GuessFile& file, const ClockGuess* clock, const std::string& folder,
                     GnssMapping& mapping, Remarks& remarks) {
  FixColumns columns = *file.fixes;
  set_table(mapping, file.table, folder, clock, remarks);
  guess_positions(file.table, columns, mapping, remarks);
  FixSeries fixes;
  if (clock != nullptr) {
    fixes = fix_series(file.table, columns, mapping, clock->t);
    check_velocities(file.table, columns, fixes, clock->t, mapping, remarks);
  }
  guess_fixes(file.table, columns, fixes, mapping, remarks);
  return fixes;
}

/// Rows at even times, for what needs no clock.
std::vector<double> even_times(size_t rows) {
  constexpr double kStep = 0.01;
  std::vector<double> t;
  for (size_t i = 0; i < rows; ++i) t.push_back(kStep * static_cast<double>(i));
  return t;
}

/// The section of the IMU; `fixes` if they share its clock.
std::optional<MotionMatch> guess_imu(const GuessFile& file, const ClockGuess* clock,
                                     const std::string& folder, const FixSeries& fixes,
                                     ImuMapping& mapping, Remarks& remarks) {
  name_sensors(file.table, *file.imu, mapping);
  remarks["columns"] = file.imu->remark;
  set_table(mapping, file.table, folder, clock, remarks);
  const ImuSeries imu =
      imu_series(file.table, *file.imu, clock != nullptr ? clock->t : even_times(file.table.rows));
  const std::optional<Gravity> gravity = gravity_of(imu);
  if (!gravity) return std::nullopt;
  std::optional<MotionMatch> match = match_motion(imu, fixes, gravity->up);
  set_units(file.table, *file.imu, imu, *gravity, match, mapping, remarks);
  set_axes(file.table, *file.imu, *gravity, match, mapping, remarks);
  return match;
}

}  // namespace

MappingGuess guess_mapping(const std::vector<std::string>& paths, const std::string& folder) {
  MappingGuess guess;
  const std::vector<GuessFile> files = read_files(paths);
  const GuessSections sections = sections_of(files, guess.notes);
  if (sections.imu == nullptr) {
    throw UsageError(
        "no file has three gyroscopes beside three accelerometers, by names or by data; name them "
        "in a mapping by hand (--help-mapping)");
  }
  const SectionClocks clocks = clocks_of_sections(sections);
  const ClockGuess* imu_clock = clocks.imu ? &*clocks.imu : nullptr;
  const ClockGuess* gnss_clock = clocks.gnss ? &*clocks.gnss : nullptr;
  Remarks imu, gnss;
  FixSeries fixes;
  if (sections.gnss != nullptr) {
    fixes = guess_gnss(*sections.gnss, gnss_clock, folder, guess.mapping.gnss, gnss);
  } else {
    guess.notes.push_back(
        "No file has positions: for `import rtklib` or `import nmea` with --gnss FILE, or add "
        "one.");
  }
  if (!clocks.overlap) fixes = {};
  const auto match = guess_imu(*sections.imu, imu_clock, folder, fixes, guess.mapping.imu, imu);
  if (match) remark_lag(*match, guess.mapping.gnss, gnss["time"]);
  if (imu_clock != nullptr && gnss_clock != nullptr && !clocks.overlap) {
    guess.notes.push_back(
        "not sure: the times of IMU and GNSS do not overlap; they are of different clocks, or a "
        "zone apart: give offset_s, or other columns");
  }
  if (sections.reference != nullptr) {
    guess_reference(*sections.reference, folder, imu_clock, guess);
  }
  set_comments(guess, "imu", imu);
  set_comments(guess, "gnss", gnss);
  guess.comments["lever_arm_m"] = "to be told: from the IMU to the antenna, forward, right, down";
  return guess;
}

}  // namespace foucault::rawlog
