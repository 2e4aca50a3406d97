#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "command.h"
#include "foucault/core/error.h"
#include "foucault/rawlog/rawlog_info.h"
#include "texts/rawlog_summary.h"

namespace foucault::app {

std::function<void(Call&)> declare_info(CLI::App& app) {
  struct Options {
    std::string log;
    bool json = false;
  };
  const auto options = std::make_shared<Options>();
  add_input_option(app, "LOG", options->log, "Rawlog, plain or compressed")->required();
  app.add_flag("--json", options->json, "Print JSON for other programs");
  app.footer(
      "\nExamples:\n"
      "  foucault info trip.rawlog\n"
      "  foucault info trip.rawlog --json | jq .imu");
  return [options](Call& call) {
    const rawlog::RawlogInfo info =
        rawlog::read_rawlog_info(options->log, call.console.progress_of("reading"));
    call.console.clear_progress();
    fmt::print("{}", options->json ? rawlog_json(info) : rawlog_text(info));
    if (info.damage) throw DataError(*info.damage);
  };
}

}  // namespace foucault::app
