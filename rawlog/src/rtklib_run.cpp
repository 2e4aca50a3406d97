#include "rtklib_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "child_process.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/geodesy/wgs84.h"
#include "inflated_file.h"
#include "pos_reader.h"
#include "text_table.h"
#include "ubx_file.h"

namespace foucault::rawlog {

namespace {

constexpr const char* kRtklibPackage = "rtklib";

/// Options of rnx2rtkp 2.4.3 whatever the observations are; the others stay RTKLIB's.
/// - l1+2+3: what of these a receiver has is used.
/// - elmask 10: the lower ones see multipath more than they help.
/// - dynamics off: positions stay independent of each other and of the velocities, which come from
///   Doppler (errdoppler 0.3 Hz, 0.06 m/s along the line of sight; an F9P fed by a simulator shows
///   0.1 Hz, RTKLIB's 1 Hz would leave the velocities without weight).
/// - continuous, not fix-and-hold: a wrong fix is not held; forward and backward check each other.
/// - gloarmode off: ambiguities of GLONASS are integer only between receivers of one kind.
/// - niter 2: the troposphere is linearized about the single solution otherwise; one that is 14 m
///   too low costs 2 cm of height.
/// - timeinterp: between epochs of the base 30 s apart, 1 mm instead of its clock's walk.
/// - timendec 9: a receiver's epochs lie up to 1 ms beside the full second, 3 cm at 30 m/s.
constexpr const char* kRtklibOptions =
    "pos1-frequency=l1+2+3\n"
    "pos1-soltype=combined\n"
    "pos1-elmask=10\n"
    "pos1-dynamics=off\n"
    "pos1-ionoopt=brdc\n"
    "pos1-tropopt=saas\n"
    "pos1-sateph=brdc\n"
    "pos1-navsys=61\n"  // GPS 1, GLONASS 4, Galileo 8, QZSS 16, BeiDou 32
    "pos2-armode=continuous\n"
    "pos2-gloarmode=off\n"
    "pos2-niter=2\n"
    "stats-errdoppler=0.3\n"
    "misc-timeinterp=on\n"
    "out-solformat=llh\n"
    "out-outhead=on\n"
    "out-outopt=on\n"
    "out-outvel=on\n"
    "out-outsingle=on\n"
    "out-timesys=gpst\n"
    "out-timeform=hms\n"
    "out-timendec=9\n"
    "out-degform=deg\n"
    "out-height=ellipsoidal\n"
    "ant2-postype=rinexhead\n";

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw DataError(fmt::format("'{}' cannot be written; is the disk full?", path));
}

/// A plain file in the folder: RTKLIB would unpack beside the original, and takes wildcards in
/// names.
void place_plain(const std::string& path, const std::string& target) {
  InflatedFile input(path);
  Bytes window = input.window();
  if (!input.compressed()) {
    std::filesystem::create_symlink(std::filesystem::absolute(path), target);
    return;
  }
  std::ofstream output(target, std::ios::binary);
  for (; window.size() > 0; window = input.window()) {
    output.write(reinterpret_cast<const char*>(window.begin),
                 static_cast<std::streamsize>(window.size()));
    input.advance(window.size());
  }
  output.close();
  if (!output) throw DataError(fmt::format("'{}' cannot be written; is the disk full?", target));
  if (input.end() != InflatedFile::End::clean) {
    throw DataError(fmt::format(
        "{}: the gzip file is damaged or cut off (byte {}); get the whole one, or unpack what is "
        "left and give that",
        path, input.file_offset()));
  }
}

// RINEX -------------------------------------------------------------------------------------------

std::string_view rinex_label(std::string_view line) {
  constexpr size_t kLabel = 60;
  return line.size() > kLabel ? line.substr(kLabel) : std::string_view{};
}

bool has_label(std::string_view line, std::string_view label) {
  return rinex_label(line).substr(0, label.size()) == label;
}

/// Where the antenna is, if the header says so.
std::optional<Geodetic> approximate_position(std::string_view line) {
  constexpr size_t kWidth = 14;
  Eigen::Vector3d p_e;
  for (size_t i = 0; i < 3; ++i) {
    p_e[static_cast<int>(i)] =
        std::strtod(std::string(line.substr(i * kWidth, kWidth)).c_str(), nullptr);
  }
  constexpr double kEarth = 6e6;
  constexpr double kFar = 1e8;
  if (!(p_e.norm() > kEarth && p_e.norm() < kFar)) return std::nullopt;
  return geodesy::wgs84::ecef_to_geodetic(p_e);
}

/// What an observation file says of itself.
struct RinexFacts {
  std::optional<Geodetic> position;
  int64_t epochs = 0;  ///< of RINEX 3; 0 of RINEX 2
};

RinexFacts facts_of(const std::string& path) {
  TextTable table(path, TextTable::Separator::comma, "");
  RinexFacts facts;
  while (const std::optional<std::string_view> line = table.next_line()) {
    if (!line->empty() && line->front() == '>') ++facts.epochs;
    if (has_label(*line, "APPROX POSITION XYZ")) facts.position = approximate_position(*line);
  }
  return facts;
}

/// The first line of a text; none if it is no text.
std::string first_line(const std::string& path) {
  TextTable table(path, TextTable::Separator::comma, "");
  const std::optional<std::string_view> line = table.next_bytes();
  return line ? std::string(*line) : std::string{};
}

/// Throws DataError unless it is RINEX with these data: O observations, N navigation (all others).
void check_rinex(const std::string& path, bool observations) {
  constexpr size_t kType = 20;
  const std::string line = first_line(path);
  if (has_label(line, "CRINEX")) {
    throw DataError(fmt::format(
        "'{}' is in Hatanaka's compression; make RINEX of it with crx2rnx (rnxcmp)", path));
  }
  const char* const wanted = observations ? "observations" : "navigation data";
  if (!has_label(line, "RINEX VERSION / TYPE")) {
    throw DataError(fmt::format(
        "'{}' does not begin as RINEX does; give RINEX {}, RTKLIB's convbin makes them of "
        "receivers' files",
        path, wanted));
  }
  if ((line[kType] == 'O') != observations) {
    throw DataError(fmt::format("'{}' is RINEX of type '{}', not {}", path, line[kType], wanted));
  }
}

// Programs ----------------------------------------------------------------------------------------

/// UBX to observations `name`.obs and navigation `name`.nav.
void convert(const std::string& path, const ScratchFolder& folder, const std::string& name,
             const std::function<void(double)>& progress) {
  place_plain(path, folder / (name + ".ubx"));
  // Without -od and -os versions of it leave Doppler and signal strength out.
  const Program convbin{"convbin",
                        {"-r", "ubx", "-od", "-os", "-o", folder / (name + ".obs"), "-n",
                         folder / (name + ".nav"), folder / (name + ".ubx")},
                        kRtklibPackage};
  run_program(convbin, [&](std::string_view) { progress(0); });
  if (std::filesystem::exists(folder / (name + ".obs"))) return;
  throw DataError(fmt::format(
      "'{}' has no raw observations (RXM-RAWX, RXM-RAW); switch them on in the receiver", path));
}

bool is_ubx(const std::string& path) { return UbxFile(path).next().has_value(); }

/// The files of a run, in the order in which rnx2rtkp wants them.
std::vector<std::string> place_inputs(const RawGnssImport& options, const ScratchFolder& folder,
                                      const std::function<void(double)>& progress) {
  std::vector<std::string> nav;
  const auto place_observations = [&](const std::string& path, const std::string& name) {
    if (is_ubx(path)) {
      convert(path, folder, name, progress);
      if (std::filesystem::exists(folder / (name + ".nav"))) {
        nav.push_back(folder / (name + ".nav"));
      }
      return;
    }
    check_rinex(path, true);
    place_plain(path, folder / (name + ".obs"));
  };
  std::vector<std::string> files{folder / "rover.obs"};
  place_observations(options.rover, "rover");
  if (options.base) {
    place_observations(*options.base, "base");
    files.push_back(folder / "base.obs");
  }
  for (size_t i = 0; i < options.nav.size(); ++i) {
    check_rinex(options.nav[i], false);
    nav.push_back(folder / fmt::format("{}.nav", i));
    place_plain(options.nav[i], nav.back());
  }
  if (nav.empty()) {
    throw UsageError(fmt::format(
        "'{}' brings no orbits (RXM-SFRBX); give --nav FILE, RINEX navigation data of its day",
        options.rover));
  }
  files.insert(files.end(), nav.begin(), nav.end());
  return files;
}

/// Where the base is, as arguments; a notice if that is the header's word.
std::vector<std::string> base_arguments(const RawGnssImport& options, const ScratchFolder& folder,
                                        RtklibSolution& solution) {
  if (!options.base) return {};
  if (options.base_position) {
    const Geodetic& base = *options.base_position;
    return {"-l", fmt::format("{:.11f}", base.latitude / kDegree),
            fmt::format("{:.11f}", base.longitude / kDegree), fmt::format("{:.5f}", base.height)};
  }
  const std::optional<Geodetic> found = facts_of(folder / "base.obs").position;
  if (!found) {
    throw UsageError(
        fmt::format("'{}' does not say where the base is (APPROX POSITION XYZ); give "
                    "--base-position LAT,LON,H",
                    *options.base));
  }
  solution.notices.push_back(fmt::format(
      "{}: the base is taken to be where its header says, {:.9f}, {:.9f} deg, {:.4f} m; all "
      "fixes are as far off as that is; --base-position tells better",
      *options.base, found->latitude / kDegree, found->longitude / kDegree, found->height));
  return {};
}

std::string option_file(const RawGnssImport& options, const ScratchFolder& folder) {
  if (options.rtklib_options) return *options.rtklib_options;
  const std::string path = folder / "rtklib.conf";
  write_text(path, std::string("pos1-posmode=") + (options.base ? "kinematic\n" : "single\n") +
                       kRtklibOptions);
  return path;
}

/// Fixes of a file, and how many of them are single ones.
std::pair<int64_t, int64_t> count_fixes(const std::string& pos) {
  int64_t fixes = 0;
  int64_t single = 0;
  const std::unique_ptr<RecordReader> reader = make_pos_reader({}, pos);
  for (bool over = false; !over;) {
    try {
      const std::optional<Record> record = reader->next();
      over = !record;
      if (over) break;
      ++fixes;
      single += std::get<GnssFix>(*record).quality == FixQuality::single ? 1 : 0;
    } catch (const RowError&) {  // comes again when the file is read
    }
  }
  return {fixes, single};
}

void check_solution(const RawGnssImport& options, const std::string& pos) {
  std::error_code not_there;
  const bool empty = std::filesystem::file_size(pos, not_there) == 0 || not_there;
  const auto [fixes, single] = empty ? std::pair<int64_t, int64_t>{} : count_fixes(pos);
  if (fixes == 0) {
    throw DataError(fmt::format(
        "rnx2rtkp finds no position in '{}'; are observations and navigation data of one time?",
        options.rover));
  }
  if (!options.base || options.rtklib_options || single < fixes) return;
  throw DataError(
      fmt::format("none of {} fixes uses the base '{}'; are its observations of the time of '{}', "
                  "and the same systems?",
                  fixes, *options.base, options.rover));
}

}  // namespace

ScratchFolder::ScratchFolder() {
  std::error_code error;
  const std::filesystem::path place = std::filesystem::temp_directory_path(error);
  path_ = (place / "foucault-XXXXXX").string();
  if (error || mkdtemp(path_.data()) == nullptr) {
    throw DataError(fmt::format(
        "no folder for temporary files can be made in '{}'; set TMPDIR to one", place.string()));
  }
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

RtklibSolution solve_with_rtklib(const RawGnssImport& options, const ScratchFolder& folder,
                                 const std::function<void(double)>& progress) {
  RtklibSolution solution;
  solution.pos = folder / "solution.pos";
  const std::vector<std::string> files = place_inputs(options, folder, progress);
  Program rnx2rtkp{"rnx2rtkp", {}, kRtklibPackage};
  std::vector<std::string>& arguments = rnx2rtkp.arguments;
  arguments = {"-k", option_file(options, folder), "-o", solution.pos};
  for (const std::vector<std::string>& more : {base_arguments(options, folder, solution), files}) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  }
  // It goes through the epochs forward and, with a base, backward, and begins a line at each.
  const int64_t lines = facts_of(folder / "rover.obs").epochs * (options.base ? 2 : 1);
  int64_t line = 0;
  run_program(rnx2rtkp, [&](std::string_view words) {
    line += std::count(words.begin(), words.end(), '\r');
    progress(lines == 0 ? 0 : std::min(1.0, static_cast<double>(line) / lines));
  });
  check_solution(options, solution.pos);
  return solution;
}

}  // namespace foucault::rawlog
