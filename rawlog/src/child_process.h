#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace foucault::rawlog {

/// A program of somebody else, found on the PATH; no shell is between.
struct Program {
  std::string name;
  std::vector<std::string> arguments;
  std::string package;  ///< of Debian, that has it
};

/// Runs it to its end. `listen` gets what it writes on both its outputs, piece by piece, and is
/// called with nothing some ten times a second besides; if it throws, the program is ended.
/// Throws DataError, of one line, if there is no such program (naming the package) or it fails
/// (with its last words).
void run_program(const Program& program, const std::function<void(std::string_view)>& listen);

}  // namespace foucault::rawlog
