#include "commands/compare.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "jobs/compare_job.h"
#include "output_directory.h"

namespace foucault::app {

std::function<void(Call&)> declare_compare(CLI::App& app) {
  struct Options {
    std::vector<std::string> folders;
    std::string out;
  };
  const auto o = std::make_shared<Options>();
  add_input_option(app, "DIR", o->folders,
                   "Folders that 'foucault run' wrote; differences are from the "
                   "first")
      ->required();
  add_output_option(app, o->out, "Folder for report/")->required();
  app.footer("\nExample:\n  foucault compare trip-ekf trip-batch --out both");
  return [o](Call& call) {
    compare(o->folders, o->out, call.console);
    call.console.say(written_lines(o->out, true));
  };
}

}  // namespace foucault::app
