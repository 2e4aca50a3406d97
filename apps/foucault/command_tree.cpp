#include "command_tree.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace foucault::app {
namespace {

OptionEntry option_entry(const CLI::Option& option) {
  OptionEntry entry;
  for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  if (option.get_positional()) entry.positional = option.get_name(true);
  const std::string type = option.get_type_name();
  if (option.get_items_expected_max() > 0) entry.argument = type.substr(0, type.find(':'));
  entry.help = option.get_description();
  entry.required = option.get_required();
  entry.repeats = option.get_expected_max() >= CLI::detail::expected_max_vector_size;
  return entry;
}

bool has(const std::vector<OptionEntry>& options, const OptionEntry& option) {
  return std::any_of(options.begin(), options.end(), [&](const OptionEntry& other) {
    return other.names == option.names && other.positional == option.positional;
  });
}

CommandEntry command_entry(const CLI::App& app, const std::string& above,
                           const std::vector<OptionEntry>& inherited) {
  CommandEntry entry{above + app.get_name(), app.get_description(), app.get_footer(), {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) entry.options.push_back(option_entry(*option));
  }
  for (const OptionEntry& option : inherited) {
    if (app.get_fallthrough() && !has(entry.options, option)) entry.options.push_back(option);
  }
  for (const CLI::App* sub : app.get_subcommands({})) {
    entry.commands.push_back(command_entry(*sub, entry.name + " ", entry.options));
  }
  return entry;
}

}  // namespace

CommandEntry command_tree(const CLI::App& app) { return command_entry(app, "", {}); }

std::string last_word(const CommandEntry& command) {
  return command.name.substr(command.name.rfind(' ') + 1);
}

std::vector<const CommandEntry*> with_subcommands(const CommandEntry& command) {
  std::vector<const CommandEntry*> all{&command};
  for (const CommandEntry& sub : command.commands) {
    const std::vector<const CommandEntry*> below = with_subcommands(sub);
    all.insert(all.end(), below.begin(), below.end());
  }
  return all;
}

}  // namespace foucault::app
