#include "config_arguments.h"

#include <utility>

#include "command.h"

namespace foucault::app {

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

void apply(const ConfigArguments& arguments, Configurable& target) {
  if (!arguments.file.empty()) load_config(arguments.file, target);
  for (const std::string& assignment : arguments.assignments) set_config(assignment, target);
}

}  // namespace foucault::app
