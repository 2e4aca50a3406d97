#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "command.h"
#include "command_tree.h"

namespace foucault::app {

/// The command line: all commands and options, and the way from what was typed to what is done.
class Program {
 public:
  Program();

  /// Does what is asked for. Throws what commands throw, HelpText, UsageError, and CLI::ParseError
  /// for answer().
  void run(int argc, char** argv);

  /// Answers --help and --version, or says what is wrong with the command line. The exit code.
  int answer(const CLI::ParseError& error) const;

  CommandEntry tree() const { return command_tree(app_); }

 private:
  void add(const Command& command);
  void add_help();
  void add_generator();
  void check_command(const std::string& name) const;
  std::string help_of(const std::vector<std::string>& words) const;
  std::string what_is_wrong(const CLI::ParseError& error) const;
  const CLI::App& deepest() const;

  CLI::App app_;
  bool quiet_ = false;
  std::vector<std::string> asked_;  ///< words after `help`
  std::map<const CLI::App*, std::function<void(Call&)>> actions_;
};

}  // namespace foucault::app
