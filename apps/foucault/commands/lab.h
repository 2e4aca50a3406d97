#pragma once

#include <functional>

#include "command.h"

/// The studies of `lab`, a file each. Each declares its subcommand and returns what is to be done.
namespace foucault::app {

/// A subcommand of `lab` and its action.
struct Study {
  CLI::App* command;
  std::function<void(Call&)> run;
};

Study declare_preintegration_study(CLI::App& lab);
Study declare_fault_study(CLI::App& lab);
Study declare_return_study(CLI::App& lab);
Study declare_start_study(CLI::App& lab);

}  // namespace foucault::app
