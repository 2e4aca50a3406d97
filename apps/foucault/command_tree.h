#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

/// The command line as plain data: what manual, completion and advice are made of.
namespace foucault::app {

struct OptionEntry {
  std::vector<std::string> names;  ///< "-o", "--out"
  std::string positional;          ///< "LOG"; empty if it has to be named
  std::string argument;            ///< "TEXT"; empty for a flag
  std::string help;
  bool required = false;
  bool repeats = false;
};

struct CommandEntry {
  std::string name;  ///< in full: "foucault import csv"
  std::string summary;
  std::string notes;  ///< what --help ends with: examples
  std::vector<OptionEntry> options;
  std::vector<CommandEntry> commands;
};

/// Without what is hidden.
CommandEntry command_tree(const CLI::App& app);

/// The last word of its name.
std::string last_word(const CommandEntry& command);

/// All of them, itself first.
std::vector<const CommandEntry*> with_subcommands(const CommandEntry& command);

}  // namespace foucault::app
