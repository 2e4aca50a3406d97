#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "console.h"

namespace CLI {
class App;
}

namespace foucault::app {

/// What a subcommand is given when it runs.
struct Call {
  Console& console;
  std::string command_line;  ///< as typed, for the record
};

/// Declares the options of a subcommand on `app` and returns what is to be done once they are
/// parsed; the options live in the function that is returned.
using Declare = std::function<void(Call&)> (*)(CLI::App& app);

struct Command {
  const char* name;
  const char* summary;
  Declare declare;
};

/// All subcommands, in the order of --help.
const std::vector<Command>& commands();

std::function<void(Call&)> declare_demo(CLI::App& app);
std::function<void(Call&)> declare_simulate(CLI::App& app);
std::function<void(Call&)> declare_import(CLI::App& app);
std::function<void(Call&)> declare_info(CLI::App& app);
std::function<void(Call&)> declare_check(CLI::App& app);
std::function<void(Call&)> declare_run(CLI::App& app);
std::function<void(Call&)> declare_evaluate(CLI::App& app);
std::function<void(Call&)> declare_tune(CLI::App& app);
std::function<void(Call&)> declare_learn(CLI::App& app);
std::function<void(Call&)> declare_allan(CLI::App& app);
std::function<void(Call&)> declare_lab(CLI::App& app);
std::function<void(Call&)> declare_report(CLI::App& app);

/// Text that was asked for instead of work (--help-config): print it, end with 0.
class HelpText : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace foucault::app
