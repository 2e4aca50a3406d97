#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "foucault/core/config.h"

namespace foucault::app {

/// --config and --set of a subcommand.
struct ConfigArguments {
  std::string file;
  std::vector<std::string> assignments;
};

/// Adds --config FILE, --set KEY=VALUE (repeated) and --help-config, which prints `help()`.
void add_config_options(CLI::App& app, ConfigArguments& arguments,
                        std::function<std::string()> help);

/// Adds a flag that prints `text()` and ends the program.
void add_help_text(CLI::App& app, const std::string& flag, const std::string& description,
                   std::function<std::string()> text);

/// The file first, then the assignments in their order. Throws DataError, UsageError.
void apply(const ConfigArguments& arguments, Configurable& target);

}  // namespace foucault::app
