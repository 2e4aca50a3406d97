#include "command.h"

#include "commands/compare.h"

namespace foucault::app {

const std::vector<Command>& commands() {
  static const std::vector<Command> all{
      {"demo", "simulate a trip, process it and draw its report", declare_demo},
      {"simulate", "write a simulated recording with its truth", declare_simulate},
      {"import", "turn recordings in other formats into a rawlog", declare_import},
      {"info", "contents, rates, gaps and health of a rawlog", declare_info},
      {"check", "judge a rawlog: clocks, units, axes, noise, sigmas", declare_check},
      {"run", "process a rawlog: solution files, metrics, report", declare_run},
      {"evaluate", "withhold fixes, measure the drift of every method", declare_evaluate},
      {"tune", "search the parameters with the least drift", declare_tune},
      {"learn", "find the noise of IMU, fixes and wheels in recordings", declare_learn},
      {"allan", "noise of an IMU at rest, and what shakes it", declare_allan},
      {"lab", "study the models on exact motion", declare_lab},
      {"compare", "show two runs or more together, with differences", declare_compare},
      {"report", "draw a report again from its numbers", declare_report},
  };
  return all;
}

}  // namespace foucault::app
