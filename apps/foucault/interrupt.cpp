#include "interrupt.h"

#include <csignal>

namespace foucault::app {
namespace {

// A signal handler can only speak through a variable of the whole process.
volatile std::sig_atomic_t interrupt_seen = 0;

void remember_interrupt(int) { interrupt_seen = 1; }

}  // namespace

void watch_interrupts() {
  std::signal(SIGINT, remember_interrupt);
  std::signal(SIGTERM, remember_interrupt);
}

void stop_if_interrupted() {
  if (interrupt_seen != 0) throw Interrupted();
}

}  // namespace foucault::app
