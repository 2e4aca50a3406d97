#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "arguments.h"
#include "command.h"
#include "foucault/core/error.h"
#include "foucault/diagnosis/examination.h"
#include "foucault/rawlog/rawlog_source.h"
#include "settings.h"

namespace foucault::app {
namespace {

const char* name_of(diagnosis::Severity severity) {
  switch (severity) {
    case diagnosis::Severity::ok:
      return "ok";
    case diagnosis::Severity::warning:
      return "warning";
    case diagnosis::Severity::error:
      return "error";
  }
  return "";
}

void print(const std::vector<diagnosis::Finding>& findings) {
  for (const diagnosis::Finding& finding : findings) {
    fmt::print("{:<8} {:<20} {}\n", name_of(finding.severity), finding.subject, finding.text);
    if (!finding.remedy.empty()) fmt::print("{:<8} {:<20} -> {}\n", "", "", finding.remedy);
  }
}

void check(const std::string& log, const Settings& settings, Console& console) {
  rawlog::RawlogSource source(log, settings.imu.sample_kind(), settings.rawlog);
  diagnosis::Examination examination(settings.imu.noise(), source.mounting(), settings.gnss);
  while (const std::optional<Measurement> measurement = source.next()) {
    examination.add(*measurement);
    console.progress("checking", source.progress());
  }
  console.clear_progress();
  const std::vector<diagnosis::Finding> findings = examination.findings();
  print(findings);
  for (const state::Notice& notice : source.notices()) {
    fmt::print("{:<8} {:<20} {}\n", "warning", "log", notice.text);
  }
  if (source.damage()) throw DataError(*source.damage());
  const auto errors =
      std::count_if(findings.begin(), findings.end(), [](const diagnosis::Finding& finding) {
        return finding.severity == diagnosis::Severity::error;
      });
  if (errors > 0) {
    throw DataError(
        fmt::format("'{}': {} of the findings above must be mended first", log, errors));
  }
}

}  // namespace

std::function<void(Call&)> declare_check(CLI::App& app) {
  struct Options {
    std::string log;
    ConfigArguments config;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("LOG", options->log, "Rawlog to judge")->required();
  add_config_options(app, options->config, settings_help);
  app.footer(
      "\nWhat is looked at: rates and holes, overlap, the date, where a reference lies, sigmas of\n"
      "fixes, lever arm, units and axes, the time offset between IMU and GNSS, noise and bias of\n"
      "the IMU at rest against imu.*, and what is lost by rotations between its samples.\n"
      "Exit code 1 if something must be mended before the log is processed.");
  return [options](Call& call) {
    Settings settings;
    apply(options->config, settings);
    check(options->log, settings_for(options->log, settings), call.console);
  };
}

}  // namespace foucault::app
