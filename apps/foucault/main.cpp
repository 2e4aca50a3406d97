#include <fmt/format.h>
#include <malloc.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <system_error>

#include "console.h"
#include "foucault/core/error.h"
#include "interrupt.h"
#include "program.h"

namespace foucault::app {
namespace {

constexpr int kBadData = 1;
constexpr int kBadUsage = 2;

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
    program.run(argc, argv);
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
