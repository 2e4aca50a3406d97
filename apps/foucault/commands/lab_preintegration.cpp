#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "commands/lab.h"
#include "foucault/evaluation/task_pool.h"
#include "foucault/laboratory/preintegration_output.h"
#include "foucault/page/report_page.h"
#include "output_directory.h"
#include "pages/laboratory_page.h"
#include "version.h"

namespace foucault::app {
namespace {

using namespace laboratory;

struct PreintegrationOptions {
  std::vector<std::string> motions = laboratory::lab_motion_names();
  int jobs = evaluation::processor_count();
  std::string out = "foucault-lab";
  bool no_report = false;
};

laboratory::MotionStudy study_motion(const laboratory::LabMotion& motion,
                                     const laboratory::StudyPlan& plan, int jobs,
                                     Console& console) {
  const laboratory::PreintegrationStudy study(motion, plan);
  std::vector<laboratory::PreintegrationStudy::Record> records(
      static_cast<std::size_t>(study.intervals()));
  evaluation::run_tasks(
      records.size(), jobs,
      [&](std::size_t i, const evaluation::TaskProgress& progress) {
        progress(0);
        records[i] = study.measure(static_cast<int>(i));
      },
      console.progress_of(motion.title));
  return study.summarize(records);
}

void study_preintegration(const PreintegrationOptions& options, Call& call) {
  std::vector<laboratory::LabMotion> motions;
  for (const std::string& name : options.motions) motions.push_back(laboratory::lab_motion(name));
  OutputDirectory directory(options.out);
  laboratory::StudyResult result;
  result.command_line = call.command_line;
  result.version = kVersion;
  for (const laboratory::LabMotion& motion : motions) {
    result.motions.push_back(study_motion(motion, result.plan, options.jobs, call.console));
  }
  laboratory::write_laboratory(result, directory.staging());
  if (!options.no_report) {
    call.console.progress("drawing", 0);
    page::write_report(content::laboratory_page(laboratory_report(result)),
                       (directory.staging() / "report").string());
  }
  directory.commit();
  call.console.say(laboratory::laboratory_lines(result));
  call.console.say(written_lines(options.out, !options.no_report));
}

}  // namespace

Study declare_preintegration_study(CLI::App& lab) {
  CLI::App* app = lab.add_subcommand(
      "preintegration", "Error of rough, refined and full, and of each term, on exact motion");
  app->fallthrough();
  const auto o = std::make_shared<PreintegrationOptions>();
  app->add_option("--motion", o->motions,
                  fmt::format("Of {}", fmt::join(laboratory::lab_motion_names(), ", ")))
      ->delimiter(',')
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->capture_default_str();
  add_jobs_option(*app, o->jobs, "Intervals");
  add_output_option(*app, o->out, "Folder for preintegration.csv, metrics.json, report/")
      ->capture_default_str();
  add_no_report_flag(*app, o->no_report);
  app->footer(
      "\nExamples:\n"
      "  foucault lab preintegration --out lab\n"
      "  foucault lab preintegration --motion vibration,airliner --out lab");
  return {app, [o](Call& call) { study_preintegration(*o, call); }};
}

}  // namespace foucault::app
