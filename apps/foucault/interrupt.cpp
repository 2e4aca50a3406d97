#include "interrupt.h"

#include <csignal>

namespace foucault::app {
namespace {

// A signal handler can only speak through a variable of the whole process.
volatile std::sig_atomic_t signal_seen = 0;

void remember(int signal) { signal_seen = signal; }

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

void watch(int signal) {
  struct sigaction action {};
  action.sa_handler = remember;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

const char* text_of(int signal) {
  if (signal == SIGTERM) return "terminated";
  if (signal == SIGHUP) return "the terminal has gone";
  if (signal == SIGPIPE) return "nobody reads the output";
  return "interrupted";
}

}  // namespace

Interrupted::Interrupted(int signal) : std::runtime_error(text_of(signal)), signal_(signal) {}

bool Interrupted::is_silent() const { return signal_ == SIGPIPE; }

void watch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM}) watch(signal);
  for (const int signal : {SIGHUP, SIGPIPE}) {
    if (!is_ignored(signal)) watch(signal);
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

void stop_if_interrupted() {
  if (signal_seen != 0) throw Interrupted(signal_seen);
}

}  // namespace foucault::app
