#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "foucault/core/config.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// Options that several subcommands have.
namespace foucault::app {

struct StoreArguments;

/// What is read: by its place, or by -i, --input. `name` stands for it in the help.
CLI::Option* add_input_option(CLI::App& app, const std::string& name, std::string& path,
                              const std::string& help);
CLI::Option* add_input_option(CLI::App& app, const std::string& name,
                              std::vector<std::string>& paths, const std::string& help);

/// Adds -o, --out, and the flag -w, --overwrite that programs of MRPT want before they write over
/// what is there. This one does so without, except over what was corrected by hand.
CLI::Option* add_output_option(CLI::App& app, std::string& path, const std::string& help);

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

/// Adds --jobs N.
void add_jobs_option(CLI::App& app, int& jobs, const std::string& what = "Runs");

/// Adds --store DIR, --shard and --no-compute.
void add_store_options(CLI::App& app, StoreArguments& arguments);

/// Adds --no-report.
void add_no_report_flag(CLI::App& app, bool& no_report);

/// The file first, then the assignments in their order. Throws DataError, UsageError.
void apply(const ConfigArguments& arguments, Configurable& target);

/// `X,Y,Z` as given on the command line. Throws UsageError naming `option`.
Eigen::Vector3d parse_vector3(const std::string& option, const std::string& text);

}  // namespace foucault::app
