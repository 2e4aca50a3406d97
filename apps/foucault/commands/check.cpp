#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "arguments.h"
#include "command.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/diagnosis/examination.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/state/told_blocks.h"
#include "jobs/survey.h"
#include "settings.h"
#include "texts/check_text.h"

namespace foucault::app {
namespace {

struct CheckOptions {
  std::string log;
  ConfigArguments config;
  bool json = false;
};

constexpr const char* kClockSubjects[] = {"time offset", "clock drift"};  // of diagnosis

std::vector<double> for_people(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

/// Fixes are of so much before their stamps on the clock of the IMU.
std::string offset_text(double offset, double sigma) {
  return fmt::format("stamps of the IMU are {:.4f} s (sigma {:.4f}) {} those of GNSS, estimated",
                     std::abs(offset), sigma, offset < 0 ? "after" : "before");
}

/// Of a block that an estimator found: its elements, those that the recording does not tell by a
/// half of what was told as unknown.
diagnosis::Finding finding_of(const evaluation::CalibratedBlock& found,
                              const evaluation::CalibratedBlock& told) {
  const bool angle = found.block.unit == "rad";
  const double factor = angle ? 1 / kDegree : 1;
  const std::vector<double> values = for_people(found.value, factor);
  const std::vector<double> sigmas = for_people(found.sigma, factor);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < values.size(); ++i) {
    texts.push_back(found.sigma[i] <= state::kLeftWhereTold * told.sigma[i]
                        ? fmt::format("{:.4g} (sigma {:.2g})", values[i], sigmas[i])
                        : fmt::format("not told by the recording (taken: {:.4g}, sigma {:.2g})",
                                      values[i], sigmas[i]));
  }
  std::string subject(found.block.name);
  std::replace(subject.begin(), subject.end(), '_', ' ');
  if (found.block.name == state::block::time_offset.name &&
      found.sigma[0] <= state::kLeftWhereTold * told.sigma[0])
    return {diagnosis::Severity::ok, subject, offset_text(found.value[0], found.sigma[0]), ""};
  const std::string unit = angle                     ? " deg"
                           : found.block.unit == "1" ? ""
                                                     : fmt::format(" {}", found.block.unit);
  return {diagnosis::Severity::ok, subject,
          fmt::format("estimated{}: {}", unit, fmt::join(texts, ", ")), ""};
}

/// What the methods estimate takes the place of what was matched; where they cannot process the
/// log, that.
std::vector<diagnosis::Finding> with_estimates(std::vector<diagnosis::Finding> findings,
                                               const Survey* survey) {
  if (!survey) return findings;
  if (!survey->failure.empty()) {
    findings.push_back({diagnosis::Severity::warning, "processing", survey->failure, ""});
    return findings;
  }
  if (survey->blocks.empty()) return findings;
  const auto is_of_clocks = [](const diagnosis::Finding& one) {
    return std::find(std::begin(kClockSubjects), std::end(kClockSubjects), one.subject) !=
           std::end(kClockSubjects);
  };
  findings.erase(std::remove_if(findings.begin(), findings.end(), is_of_clocks), findings.end());
  for (std::size_t i = 0; i < survey->blocks.size(); ++i)
    findings.push_back(finding_of(survey->blocks[i], survey->told[i]));
  return findings;
}

/// The log is looked through by an estimator first, with whose clocks and noise it is judged. Also
/// what the reader noticed.
std::vector<diagnosis::Finding> findings_of(const std::string& log, rawlog::RawlogSource& source,
                                            const Settings& settings, const Surveyor& surveyor,
                                            Console& console) {
  diagnosis::Examination examination(settings.imu.noise(), source.mounting(), settings.gnss);
  while (const std::optional<Measurement> measurement = source.next()) {
    examination.add(*measurement);
    console.progress("checking", source.progress());
  }
  console.clear_progress();
  std::vector<diagnosis::Finding> findings =
      with_estimates(examination.findings(), surveyor.found(log));
  for (const state::Notice& notice : source.notices()) {
    findings.push_back({diagnosis::Severity::warning, "log", notice.text, ""});
  }
  return findings;
}

void check(const CheckOptions& options, const Settings& told, Console& console) {
  Surveyor surveyor(console);
  const Settings settings = surveyor.complete(options.log, told);
  rawlog::RawlogSource source(options.log, settings.imu.sample_kind(), settings.rawlog);
  const std::vector<diagnosis::Finding> findings =
      findings_of(options.log, source, settings, surveyor, console);
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
      "fixes, lever arm, units and axes, noise and bias of the IMU at rest against imu.*, and "
      "what\n"
      "is lost by rotations between its samples. Clocks, lever arm, mounting, scale factors and\n"
      "noise are what `run` would find in the log, each with its sigma.\n"
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
