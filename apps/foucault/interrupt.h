#pragma once

#include <stdexcept>

/// Ctrl-C and other requests to stop as an exception, so that unfinished output is cleaned up on
/// the way out.
namespace foucault::app {

class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(int signal);

  /// What a shell says of a program that this signal ended: 130 for Ctrl-C, 143 for SIGTERM.
  int exit_code() const { return 128 + signal_; }
  /// Nobody reads our output any more; saying so would only disturb, as in `foucault info X |
  /// head`.
  bool is_silent() const;

 private:
  int signal_;
};

/// From now on SIGINT and SIGTERM are only remembered, SIGHUP and SIGPIPE too unless they are
/// ignored, as nohup has it; a file beyond the limit of its size becomes an error of writing.
void watch_interrupts();

/// Throws Interrupted if one has come.
void stop_if_interrupted();

}  // namespace foucault::app
