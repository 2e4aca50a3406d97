#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "command.h"
#include "foucault/core/error.h"
#include "foucault/diagnosis/examination.h"
#include "foucault/rawlog/rawlog_source.h"
#include "settings.h"
#include "texts/check_text.h"

namespace foucault::app {
namespace {

struct CheckOptions {
  std::string log;
  ConfigArguments config;
  bool json = false;
};

/// Also what the reader noticed.
std::vector<diagnosis::Finding> findings_of(rawlog::RawlogSource& source, const Settings& settings,
                                            Console& console) {
  diagnosis::Examination examination(settings.imu.noise(), source.mounting(), settings.gnss);
  while (const std::optional<Measurement> measurement = source.next()) {
    examination.add(*measurement);
    console.progress("checking", source.progress());
  }
  console.clear_progress();
  std::vector<diagnosis::Finding> findings = examination.findings();
  for (const state::Notice& notice : source.notices()) {
    findings.push_back({diagnosis::Severity::warning, "log", notice.text, ""});
  }
  return findings;
}

void check(const CheckOptions& options, const Settings& settings, Console& console) {
  rawlog::RawlogSource source(options.log, settings.imu.sample_kind(), settings.rawlog);
  const std::vector<diagnosis::Finding> findings = findings_of(source, settings, console);
  console.print(options.json ? findings_json(options.log, findings) : findings_text(findings));
  if (source.damage()) throw DataError(*source.damage());
  const std::vector<std::string> subjects = subjects_to_mend(findings);
  if (subjects.empty()) return;
  throw DataError(fmt::format("'{}': {} of the findings must be mended first: {}", options.log,
                              subjects.size(), fmt::join(subjects, ", ")));
}

}  // namespace

std::function<void(Call&)> declare_check(CLI::App& app) {
  const auto options = std::make_shared<CheckOptions>();
  add_input_option(app, "LOG", options->log, "Rawlog to judge")->required();
  app.add_flag("--json", options->json, "Print JSON for other programs");
  add_config_options(app, options->config, settings_help);
  app.footer(
      "\nWhat is looked at: rates and holes, overlap, the date, where a reference lies, sigmas of\n"
      "fixes, lever arm, units and axes, the time offset between IMU and GNSS, noise and bias of\n"
      "the IMU at rest against imu.*, and what is lost by rotations between its samples.\n"
      "Exit code 1 if something must be mended before the log is processed; with -q that is all.\n"
      "\nExamples:\n"
      "  foucault check trip.rawlog\n"
      "  foucault check trip.rawlog --set imu.preset=ICM20602\n"
      "  foucault check trip.rawlog --json | jq '.findings[] | select(.severity != \"ok\")'\n"
      "  foucault check -q trip.rawlog && foucault run trip.rawlog --out trip");
  return [options](Call& call) {
    Settings settings;
    apply(options->config, settings);
    check(*options, settings_for(options->log, settings), call.console);
  };
}

}  // namespace foucault::app
