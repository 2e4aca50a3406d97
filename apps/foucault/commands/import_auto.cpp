#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "arguments.h"
#include "foucault/core/error.h"
#include "foucault/rawlog/recognize.h"
#include "import_formats.h"

/// Import of files whose format is not told.
namespace foucault::app {
namespace {

struct AutoOptions {
  std::vector<std::string> files;
  std::string out;
  std::optional<std::string> lever_arm;
  bool skip_bad_rows = false;
};

struct AutoFile {
  std::string path;
  rawlog::FileFormat format;
};

AutoFile recognized(const std::string& path) {
  const std::optional<rawlog::FileFormat> format = rawlog::recognize(path);
  if (format) return {path, *format};
  throw DataError(fmt::format("'{}' is of no known format; see 'foucault import --help'", path));
}

std::string paths_of(const std::vector<AutoFile>& files, const std::string& command) {
  std::string paths;
  for (const AutoFile& file : files) {
    if (file.format.command == command) paths += " " + file.path;
  }
  return paths;
}

/// What is to be run by hand where one file does not say enough.
std::string advice(const std::vector<AutoFile>& files, const std::string& out) {
  const std::string tables = paths_of(files, "csv");
  const std::string guess = fmt::format("foucault import csv --guess{} --out mapping.yaml", tables);
  for (const char* command : {"rtklib", "nmea", "ubx"}) {
    const std::string fixes = paths_of(files, command);
    if (fixes.empty()) continue;
    if (tables.empty()) {
      return fmt::format("it needs a table of an IMU: foucault import auto IMU.csv{} --out {}",
                         fixes, out);
    }
    return fmt::format(
        "run `{}`, correct that, then `foucault import {}{}{} --mapping mapping.yaml "
        "--out {}`",
        guess, command, command == std::string("ubx") ? "" : " --gnss", fixes, out);
  }
  const std::string raw = paths_of(files, "rinex");
  if (!raw.empty()) {
    return fmt::format("raw observations:{}; see `foucault import rinex --help`", raw);
  }
  if (!tables.empty()) {
    return fmt::format(
        "run `{}`, correct that, then `foucault import csv --mapping mapping.yaml "
        "--out {}`",
        guess, out);
  }
  return "give one of them at a time";
}

/// The command as if it was typed. Throws UsageError with what it misses.
void run_import_of(const AutoFile& file, const AutoOptions& options, Call& call) {
  const Command* command = find_import(file.format.command);
  if (command == nullptr) {
    throw UsageError(
        fmt::format("'{}' is {}, which this program does not import", file.path, file.format.name));
  }
  std::vector<std::string> arguments{"--out", options.out};
  if (options.skip_bad_rows) arguments.emplace_back("--skip-bad-rows");
  if (options.lever_arm) {
    arguments.emplace_back("--lever-arm");
    arguments.push_back(*options.lever_arm);
  }
  arguments.push_back(file.path);
  CLI::App app;
  const std::function<void(Call&)> import = command->declare(app);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    throw UsageError(fmt::format(
        "'{}' is {}; run `foucault import {} {} --out {}` with more options: {}", file.path,
        file.format.name, command->name, file.path, options.out, error.what()));
  }
  import(call);
}

void import_recognized(const AutoOptions& options, Call& call) {
  std::vector<AutoFile> files;
  for (const std::string& path : options.files) {
    files.push_back(recognized(path));
    call.console.say(fmt::format("{:<10} {}", files.back().format.name, path));
  }
  const AutoFile& first = files.front();
  const std::string command = first.format.command;
  if (command.empty()) {
    throw UsageError(fmt::format("'{}' is a rawlog already; run `foucault run {} --out DIR`",
                                 first.path, first.path));
  }
  constexpr const char* kNeedMore[] = {"csv", "rtklib", "nmea", "rinex"};
  const bool needs_more =
      std::find(std::begin(kNeedMore), std::end(kNeedMore), command) != std::end(kNeedMore);
  if (files.size() > 1 || needs_more) throw UsageError(advice(files, options.out));
  run_import_of(first, options, call);
}

}  // namespace

std::function<void(Call&)> declare_import_auto(CLI::App& app) {
  const auto o = std::make_shared<AutoOptions>();
  add_input_option(app, "FILE", o->files, "Recordings, plain or gzip")->required();
  add_output_option(app, o->out, "Rawlog to write")->required();
  app.add_option("--lever-arm", o->lever_arm, kLeverArmHelp);
  app.add_flag("--skip-bad-rows", o->skip_bad_rows,
               "Leave out rows that are wrong, and count them, instead of stopping");
  app.footer(
      "\nExamples:\n"
      "  foucault import auto drive.ubx --out drive.rawlog\n"
      "  foucault import auto drive.bag --lever-arm 0.3,0,-0.5 --out drive.rawlog");
  return [o](Call& call) { import_recognized(*o, call); };
}

}  // namespace foucault::app
