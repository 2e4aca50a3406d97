#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <memory>

#include "command.h"
#include "config_arguments.h"
#include "fault_study.h"
#include "foucault/evaluation/task_pool.h"
#include "foucault/page/report_page.h"
#include "laboratory_output.h"
#include "laboratory_report.h"
#include "methods.h"
#include "output_directory.h"
#include "return_study.h"
#include "text_file.h"

namespace foucault::app {
namespace {

struct LabOptions {
  std::vector<std::string> motions = lab_motion_names();
  int jobs = processor_count();
  std::string out = "foucault-lab";
  bool no_report = false;
};

MotionStudy study_motion(const LabMotion& motion, const StudyPlan& plan, int jobs,
                         Console& console) {
  const PreintegrationStudy study(motion, plan);
  std::vector<PreintegrationStudy::Record> records(static_cast<std::size_t>(study.intervals()));
  run_tasks(
      records.size(), jobs,
      [&](std::size_t i, const TaskProgress& progress) {
        progress(0);
        records[i] = study.measure(static_cast<int>(i));
      },
      console.progress_of(motion.title));
  return study.summarize(records);
}

void study_preintegration(const LabOptions& options, Call& call) {
  std::vector<LabMotion> motions;
  for (const std::string& name : options.motions) motions.push_back(lab_motion(name));
  OutputDirectory directory(options.out);
  LabResult result;
  result.command_line = call.command_line;
  for (const LabMotion& motion : motions) {
    result.motions.push_back(study_motion(motion, result.plan, options.jobs, call.console));
  }
  write_laboratory(result, directory.staging());
  if (!options.no_report) {
    call.console.progress("drawing", 0);
    page::write_report(content::laboratory_page(laboratory_report(result)),
                       (directory.staging() / "report").string());
  }
  directory.commit();
  for (const std::string& line : laboratory_lines(result)) call.console.say(line);
  call.console.say(fmt::format("{:<10} {}", "written", options.out));
  if (!options.no_report) {
    const std::filesystem::path page = std::filesystem::path(options.out) / "report" / "index.html";
    call.console.say(fmt::format("{:<10} {}", "report", page.string()));
  }
}

struct FaultStudyOptions {
  std::vector<std::string> faults;
  std::vector<std::string> methods{"ekf", "refined", "full"};
  std::vector<int64_t> seeds{1};
  int jobs = processor_count();
  std::string out = "foucault-faults";
};

struct FaultTask {
  std::string fault;
  int64_t seed;
};

std::vector<FaultTask> fault_tasks(const FaultStudyOptions& options) {
  std::vector<std::string> names = options.faults;
  if (names.empty()) {
    for (const FaultCase& fault : fault_cases()) names.push_back(fault.name);
  }
  for (const std::string& method : options.methods) find_method(method);
  std::vector<FaultTask> tasks;
  for (const std::string& name : names) {
    find_fault_case(name);
    for (const int64_t seed : options.seeds) tasks.push_back({name, seed});
  }
  return tasks;
}

void study_faults(const FaultStudyOptions& options, Call& call) {
  const std::vector<FaultTask> tasks = fault_tasks(options);
  OutputDirectory directory(options.out);
  std::vector<std::vector<FaultOutcome>> results(tasks.size());
  run_tasks(
      tasks.size(), options.jobs,
      [&](std::size_t i, const TaskProgress& progress) {
        progress(0);
        const FaultTask& task = tasks[i];
        const std::filesystem::path log =
            directory.staging() / fmt::format("{}-{}.rawlog", task.fault, task.seed);
        results[i] = run_fault(find_fault_case(task.fault), options.methods, Settings(), task.seed,
                               log.string());
      },
      call.console.progress_of("faults"));
  std::vector<FaultOutcome> outcomes;
  for (const auto& result : results) {
    outcomes.insert(outcomes.end(), result.begin(), result.end());
  }
  write_text_file(directory.staging() / "faults.csv", to_csv(fault_table(outcomes)));
  write_text_file(directory.staging() / "faults.md", to_markdown(fault_summary(outcomes)));
  directory.commit();
  call.console.say(fmt::format("{:<10} {}", "written", options.out));
}

CLI::App* declare_fault_study(CLI::App& app, FaultStudyOptions& o) {
  CLI::App* faults = app.add_subcommand(
      "faults", "What faults of recordings do to the methods, on simulated trips");
  faults->fallthrough();
  faults->add_option("--fault", o.faults, "Which ones, separated by commas; default: all")
      ->delimiter(',');
  faults->add_option("--methods", o.methods, "Separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  faults->add_option("--seeds", o.seeds, "Of the trips, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  faults->add_option("--jobs", o.jobs, "Runs at the same time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  faults
      ->add_option("--out", o.out,
                   "Folder for faults.csv, a row a run, and faults.md, a row a fault")
      ->capture_default_str();
  return faults;
}

struct ReturnStudyOptions {
  std::vector<std::string> logs;  ///< empty: a simulated trip
  ConfigArguments config;
  std::vector<std::string> methods;
  std::vector<double> noise, lengths;
  int jobs = processor_count();
  std::string out = "foucault-returns";
};

/// What is not given is swept on the simulated trip, and as configured on a recording.
ReturnStudyOptions completed(ReturnStudyOptions options, const Settings& settings) {
  const bool simulated = options.logs.empty();
  if (simulated) options.logs.emplace_back();
  if (options.noise.empty()) {
    options.noise = simulated ? std::vector<double>{0.1, 0.3, 1, 3, 10} : std::vector<double>{1};
  }
  if (options.lengths.empty()) {
    options.lengths = simulated ? std::vector<double>{5, 15, 30, 60, 120}
                                : std::vector<double>{settings.outages.length_s};
  }
  return options;
}

std::vector<ReturnCase> return_cases(const ReturnStudyOptions& options) {
  for (const std::string& method : options.methods) find_method(method);
  std::vector<ReturnCase> cases;
  for (const std::string& log : options.logs) {
    for (const double noise : options.noise) {
      for (const double length_s : options.lengths) {
        for (const std::string& method : options.methods) {
          cases.push_back({log, noise, length_s, method});
        }
      }
    }
  }
  return cases;
}

void study_returns(const ReturnStudyOptions& given, Call& call) {
  Settings settings;
  apply(given.config, settings);
  const ReturnStudyOptions options = completed(given, settings);
  const std::vector<ReturnCase> cases = return_cases(options);
  OutputDirectory directory(options.out);
  std::vector<ReturnOutcome> outcomes(cases.size());
  run_tasks(
      cases.size(), options.jobs,
      [&](std::size_t i, const TaskProgress& progress) {
        progress(0);
        outcomes[i] = study_return(cases[i], settings);
      },
      call.console.progress_of("returns"));
  write_text_file(directory.staging() / "returns.csv", to_csv(return_table(outcomes)));
  const std::string summary = to_markdown(return_summary(outcomes));
  write_text_file(directory.staging() / "returns.md", summary);
  directory.commit();
  call.console.say(summary);
  call.console.say(fmt::format("{:<10} {}", "written", options.out));
}

CLI::App* declare_return_study(CLI::App& app, ReturnStudyOptions& o) {
  CLI::App* returns = app.add_subcommand(
      "returns",
      "Whether true fixes are believed after outages, whatever the noise model: against no gate");
  returns->fallthrough();
  for (const Method& method : methods()) o.methods.push_back(method.name);
  returns->add_option("LOG", o.logs,
                      "Rawlogs, with the outages of the configuration; default: a "
                      "simulated trip");
  add_config_options(*returns, o.config, [] {
    Settings settings;
    return describe_config(settings);
  });
  returns->add_option("--methods", o.methods, "Separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  returns
      ->add_option("--noise", o.noise,
                   "What the noise of the IMU is configured by, times what it is, separated by "
                   "commas; default: 0.1 to 10, of a recording 1")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  returns
      ->add_option("--lengths", o.lengths,
                   "Of the outages [s], separated by commas; default: 5 to 120, of a recording "
                   "outages.length_s")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  returns->add_option("--jobs", o.jobs, "Runs at the same time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  returns->add_option("--out", o.out, "Folder for returns.csv, a row a run, and returns.md")
      ->capture_default_str();
  return returns;
}

}  // namespace

std::function<void(Call&)> declare_lab(CLI::App& app) {
  app.require_subcommand(1);
  const auto faults = std::make_shared<FaultStudyOptions>();
  CLI::App* fault_study = declare_fault_study(app, *faults);
  const auto returns = std::make_shared<ReturnStudyOptions>();
  CLI::App* return_study = declare_return_study(app, *returns);
  CLI::App* preintegration = app.add_subcommand(
      "preintegration", "Error of rough, refined and full, and of each term, on exact motion");
  preintegration->fallthrough();
  const auto o = std::make_shared<LabOptions>();
  preintegration
      ->add_option("--motion", o->motions,
                   fmt::format("Of {}", fmt::join(lab_motion_names(), ", ")))
      ->delimiter(',')
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->capture_default_str();
  preintegration->add_option("--jobs", o->jobs, "Intervals at the same time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  preintegration
      ->add_option("--out", o->out, "Folder for preintegration.csv, metrics.json, report/")
      ->capture_default_str();
  preintegration->add_flag("--no-report", o->no_report, "Draw no figures");
  app.footer(
      "\nExamples:\n"
      "  foucault lab preintegration --out lab\n"
      "  foucault lab preintegration --motion vibration,airliner --out lab");
  return [o, faults, fault_study, returns, return_study](Call& call) {
    if (fault_study->parsed()) {
      study_faults(*faults, call);
    } else if (return_study->parsed()) {
      study_returns(*returns, call);
    } else {
      study_preintegration(*o, call);
    }
  };
}

}  // namespace foucault::app
