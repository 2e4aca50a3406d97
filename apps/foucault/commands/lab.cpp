#include "commands/lab.h"

#include <CLI/CLI.hpp>

namespace foucault::app {

std::function<void(Call&)> declare_lab(CLI::App& app) {
  app.require_subcommand(1);
  const std::vector<Study> studies{declare_fault_study(app), declare_return_study(app),
                                   declare_start_study(app), declare_preintegration_study(app)};
  app.footer(
      "\nExamples:\n"
      "  foucault lab preintegration --out lab\n"
      "  foucault lab faults --fault ramp --out faults\n"
      "  foucault lab returns trip.rawlog --out returns\n"
      "  foucault lab starts --count 50 --out starts");
  return [studies](Call& call) {
    for (const Study& study : studies) {
      if (study.command->parsed()) return study.run(call);
    }
  };
}

}  // namespace foucault::app
