#include "arguments.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <sstream>
#include <utility>

#include "command.h"
#include "foucault/core/error.h"
#include "jobs/run_store.h"

namespace foucault::app {

CLI::Option* add_input_option(CLI::App& app, const std::string& name, std::string& path,
                              const std::string& help) {
  return app.add_option("-i,--input," + name, path, help);
}

CLI::Option* add_input_option(CLI::App& app, const std::string& name,
                              std::vector<std::string>& paths, const std::string& help) {
  return app.add_option("-i,--input," + name, paths, help);
}

CLI::Option* add_output_option(CLI::App& app, std::string& path, const std::string& help) {
  CLI::Option* option = app.add_option("-o,--out", path, help);
  app.add_flag("-w,--overwrite", "Write over what is there, which only a mapping waits for");
  return option;
}

void add_help_text(CLI::App& app, const std::string& flag, const std::string& description,
                   std::function<std::string()> text) {
  app.add_flag_callback(
         flag, [text = std::move(text)] { throw HelpText(text()); }, description)
      ->trigger_on_parse();
}

void add_config_options(CLI::App& app, ConfigArguments& arguments,
                        std::function<std::string()> help) {
  app.add_option("--config", arguments.file, "Configuration, YAML");
  app.add_option("--set", arguments.assignments, "One key of the configuration; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_help_text(app, "--help-config",
                "List every key of the configuration, with default and meaning", std::move(help));
}

void add_jobs_option(CLI::App& app, int& jobs, const std::string& what) {
  app.add_option("--jobs", jobs, what + " at the same time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

void add_store_options(CLI::App& app, StoreArguments& arguments) {
  app.add_option("--store", arguments.folder,
                 "Folder for finished runs, kept for later calls and shared by workers; default: a "
                 "hidden one beside --out, removed when the results are written");
  app.add_option(
         "--shard", arguments.shard,
         "Only compute a share of the runs into the store, as one of many workers: i/n (1/8 "
         "to 8/8); auto: as Slurm, MPI or AWS Batch say; auto/n: index from the engine "
         "(Kubernetes). Then the same command without --shard writes the results")
      ->type_name("I/N");
  app.add_flag("--no-compute", arguments.no_compute,
               "Write the results of what is in the store, or say how many runs are missing");
}

void add_no_report_flag(CLI::App& app, bool& no_report) {
  app.add_flag("--no-report", no_report, "Draw no figures");
}

void apply(const ConfigArguments& arguments, Configurable& target) {
  if (!arguments.file.empty()) load_config(arguments.file, target);
  for (const std::string& assignment : arguments.assignments) set_config(assignment, target);
}

Eigen::Vector3d parse_vector3(const std::string& option, const std::string& text) {
  std::istringstream stream(text);
  Eigen::Vector3d v;
  char comma = ',';
  for (int i = 0; i < 3; ++i) {
    if (i > 0 && !(stream >> comma)) comma = '\0';
    if (comma != ',' || !(stream >> v[i]) || !std::isfinite(v[i])) {
      throw UsageError(fmt::format("{} '{}': give three numbers as X,Y,Z", option, text));
    }
  }
  if (!(stream >> std::ws).eof()) {
    throw UsageError(fmt::format("{} '{}': give three numbers as X,Y,Z", option, text));
  }
  return v;
}

}  // namespace foucault::app
