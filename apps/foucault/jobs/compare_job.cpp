#include "jobs/compare_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "foucault/content/compare_report.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/plot/files.h"
#include "output_directory.h"
#include "version.h"

namespace foucault::app {
namespace {

namespace fs = std::filesystem;

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

/// A solution.csv, line by line.
class SolutionReader {
 public:
  explicit SolutionReader(const fs::path& path) : path_(path.string()) {
    text_ = plot::read_file(path_);
    rest_ = text_;
    header_ = cells_of(next_line());
    for (const char* name : kColumns) places_.push_back(place_of(name));
  }

  std::vector<content::ComparedEpoch> epochs() {
    std::vector<content::ComparedEpoch> epochs;
    while (!rest_.empty()) epochs.push_back(epoch(cells_of(next_line())));
    if (epochs.empty()) throw DataError(fmt::format("'{}' holds no epoch", path_));
    return epochs;
  }

 private:
  static constexpr const char* kColumns[] = {"t_unix_s",  "lat_deg",   "lon_deg",     "height_m",
                                             "roll_deg",  "pitch_deg", "heading_deg", "sd_north_m",
                                             "sd_east_m", "sd_down_m"};

  std::string_view next_line() {
    ++line_;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return line;
  }

  std::size_t place_of(std::string_view name) const {
    const auto found = std::find(header_.begin(), header_.end(), name);
    if (found != header_.end()) return static_cast<std::size_t>(found - header_.begin());
    throw DataError(
        fmt::format("'{}' has no column {}; name folders that `foucault run` wrote", path_, name));
  }

  double number(std::string_view cell) const {
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error == std::errc() && end == cell.data() + cell.size()) return value;
    throw DataError(fmt::format("'{}', line {}: '{}' is not a number", path_, line_, cell));
  }

  /// Whole and broken seconds apart: a double holds no nanoseconds of today.
  int64_t stamp_of(std::string_view cell) const {
    const std::size_t point = std::min(cell.find('.'), cell.size());
    const double whole = number(cell.substr(0, point));
    const double part = point < cell.size() ? number(cell.substr(point)) : 0;
    return static_cast<int64_t>(whole) * kNanosecondsPerSecond + nanoseconds(part);
  }

  content::ComparedEpoch epoch(const std::vector<std::string_view>& cells) const {
    if (cells.size() < header_.size()) {
      throw DataError(fmt::format("'{}', line {}: {} cells, {} expected", path_, line_,
                                  cells.size(), header_.size()));
    }
    const auto value = [&](std::size_t column) { return number(cells[places_[column]]); };
    content::ComparedEpoch epoch;
    epoch.t_ns = stamp_of(cells[places_[0]]);
    epoch.position = {value(1) * kDegree, value(2) * kDegree, value(3)};
    epoch.roll_deg = value(4);
    epoch.pitch_deg = value(5);
    epoch.heading_deg = value(6);
    epoch.sigma_north_m = value(7);
    epoch.sigma_east_m = value(8);
    epoch.sigma_down_m = value(9);
    return epoch;
  }

  std::string path_, text_;
  std::string_view rest_;
  std::size_t line_ = 0;
  std::vector<std::string_view> header_;
  std::vector<std::size_t> places_;
};

std::string word(const nlohmann::json& json, const char* pointer) {
  const nlohmann::json::json_pointer at(pointer);
  if (!json.contains(at) || json.at(at).is_null()) return "–";
  const nlohmann::json& value = json.at(at);
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
  return value.dump();
}

std::vector<std::pair<std::string, std::string>> facts_of(const nlohmann::json& m) {
  return {{"Log", word(m, "/log")},
          {"Method", word(m, "/method")},
          {"Trustworthy", word(m, "/trustworthy")},
          {"Epochs", word(m, "/epochs")},
          {"Distance (m)", word(m, "/distance_m")},
          {"Fixes used", word(m, "/gnss/used")},
          {"Fixes rejected", word(m, "/gnss/rejected")},
          {"Mean NIS (3)", word(m, "/gnss/mean_nis")},
          {"Horizontal error, RMS (m)", word(m, "/reference/horizontal_rmse_m")},
          {"Vertical error, RMS (m)", word(m, "/reference/vertical_rmse_m")},
          {"Processing (s)", word(m, "/wall_s")},
          {"Version", word(m, "/version")}};
}

content::ComparedRun read_run(const std::string& folder) {
  const fs::path path = fs::path(folder);
  content::ComparedRun run;
  run.epochs = SolutionReader(path / "solution.csv").epochs();
  const std::string metrics = (path / "metrics.json").string();
  try {
    const nlohmann::json json = nlohmann::json::parse(plot::read_file(metrics));
    run.method = word(json, "/method");
    run.facts = facts_of(json);
  } catch (const nlohmann::json::exception& error) {
    throw DataError(fmt::format("'{}': {}", metrics, error.what()));
  }
  return run;
}

/// The last part of the path, or all of it where that is the same for two.
std::vector<std::string> short_names(const std::vector<std::string>& folders) {
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    const fs::path path = fs::path(folder).lexically_normal();
    names.push_back((path.has_filename() ? path : path.parent_path()).filename().string());
  }
  const std::set<std::string> distinct(names.begin(), names.end());
  return distinct.size() == names.size() ? names : folders;
}

}  // namespace

void compare(const std::vector<std::string>& folders, const std::string& out, Console& console) {
  if (folders.size() < 2) throw UsageError("compare needs two folders or more that `run` wrote");
  const std::vector<std::string> names = short_names(folders);
  std::vector<content::ComparedRun> runs;
  for (std::size_t i = 0; i < folders.size(); ++i) {
    runs.push_back(read_run(folders[i]));
    runs.back().name = names[i];
  }
  OutputDirectory directory(out);
  console.progress("drawing", 0);
  page::write_report(content::compare_page(runs, fmt::format("foucault {}", kVersion)),
                     (directory.staging() / "report").string());
  directory.commit();
}

}  // namespace foucault::app
