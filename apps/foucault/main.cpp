#include <fmt/format.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <map>
#include <new>
#include <string>
#include <system_error>

#include "command.h"
#include "console.h"
#include "foucault/core/error.h"
#include "interrupt.h"
#include "version.h"

namespace foucault::app {
namespace {

constexpr int kBadData = 1;
constexpr int kBadUsage = 2;

constexpr const char* kFooter =
    "\nExamples:\n"
    "  foucault demo                                       a first look, with simulated data\n"
    "  foucault import i2nav --imu imu.txt --gnss rtk.pos --gps-week 2200 \\\n"
    "      --lever-arm 0.1,-0.3,-0.8 --out trip.rawlog     a recording into a rawlog\n"
    "  foucault info trip.rawlog                           what is in it\n"
    "  foucault run trip.rawlog --out trip                 process it; see trip/report/index.html\n"
    "\n'foucault COMMAND --help' tells the options of a command.\n"
    "Exit codes: 0 all right, 1 bad data, 2 wrong usage, 130 interrupted, 143 terminated.";

/// The solver takes and returns arrays of the window's size at every epoch. Beyond some 100 kB
/// glibc gives them back to the system each time, and faulting them in again took 60 % of a run
/// with GNSS at 4 Hz.
void keep_memory_between_epochs() {
#ifdef __GLIBC__
  constexpr int kKept = 64 << 20;  // [bytes]
  mallopt(M_MMAP_THRESHOLD, kKept);
  mallopt(M_TRIM_THRESHOLD, kKept);
#endif
}

std::string join_arguments(int argc, char** argv) {
  std::string joined = "foucault";
  for (int i = 1; i < argc; ++i) joined += fmt::format(" {}", argv[i]);
  return joined;
}

class Program {
 public:
  Program() {
    app_.footer(kFooter);
    app_.set_version_flag("--version", std::string("foucault ") + kVersion);
    app_.require_subcommand(1);
    for (const Command& command : commands()) add(command);
  }

  int run(int argc, char** argv) {
    if (argc > 1) check_command(argv[1]);
    app_.parse(argc, argv);
    Console console(quiet_);
    Call call{console, join_arguments(argc, argv)};
    actions_.at(app_.get_subcommands().front())(call);
    return 0;
  }

  /// Answers --help and --version, or says what is wrong with the command line.
  int answer(const CLI::ParseError& error) const {
    if (error.get_exit_code() == 0) return app_.exit(error);
    print_error(fmt::format("{}; see '{} --help'", error.what(), deepest_command()));
    return kBadUsage;
  }

 private:
  void add(const Command& command) {
    CLI::App* sub = app_.add_subcommand(command.name, command.summary);
    sub->add_flag("-q,--quiet", quiet_, "Say only what goes wrong");
    actions_.emplace(sub, command.declare(*sub));
  }

  /// CLI11 would only say that a subcommand is missing.
  static void check_command(const std::string& name) {
    if (name.empty() || name.front() == '-') return;
    std::string known;
    for (const Command& command : commands()) {
      if (name == command.name) return;
      known += fmt::format("{}{}", known.empty() ? "" : ", ", command.name);
    }
    throw UsageError(fmt::format("unknown command '{}'; known: {}", name, known));
  }

  std::string deepest_command() const {
    std::string name = "foucault";
    for (const CLI::App* app = &app_; !app->get_subcommands().empty();) {
      app = app->get_subcommands().front();
      name += " " + app->get_name();
    }
    return name;
  }

  CLI::App app_{"Foucault: post-processing of GNSS/IMU recordings", "foucault"};
  bool quiet_ = false;
  std::map<const CLI::App*, std::function<void(Call&)>> actions_;
};

/// What was said must have come out: a pipe may be closed, a disk full.
void finish_output() {
  const bool flushed = std::fflush(stdout) == 0;
  const std::string reason = flushed ? "a part of it is missing" : std::strerror(errno);
  if (flushed && std::ferror(stdout) == 0) return;
  stop_if_interrupted();
  throw DataError("cannot write to the standard output: " + reason);
}

int run(Program& program, int argc, char** argv) {
  int exit_code = 0;
  try {
    exit_code = program.run(argc, argv);
  } catch (const HelpText& help) {
    fmt::print("{}", help.what());
  } catch (const CLI::ParseError& error) {
    exit_code = program.answer(error);
  } catch (const std::system_error&) {  // of a print, perhaps
    finish_output();
    throw;
  }
  finish_output();
  return exit_code;
}

int guarded_run(int argc, char** argv) {
  Program program;
  try {
    return run(program, argc, argv);
  } catch (const UsageError& error) {
    print_error(error.what());
    return kBadUsage;
  } catch (const Interrupted& error) {
    if (!error.is_silent()) print_error(error.what());
    return error.exit_code();
  } catch (const std::bad_alloc&) {
    print_error("out of memory");
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  return kBadData;
}

}  // namespace
}  // namespace foucault::app

int main(int argc, char** argv) {
  foucault::app::keep_memory_between_epochs();
  foucault::app::watch_interrupts();
  return foucault::app::guarded_run(argc, argv);
}
