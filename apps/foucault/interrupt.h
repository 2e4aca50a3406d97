#pragma once

#include <stdexcept>

/// Ctrl-C and termination as an exception, so that unfinished output is cleaned up on the way out.
namespace foucault::app {

class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// From now on SIGINT and SIGTERM are only remembered.
void watch_interrupts();

/// Throws Interrupted if one has come.
void stop_if_interrupted();

}  // namespace foucault::app
