#pragma once

#include <string>

#include "command_tree.h"

/// What the program installs of itself for man and for shells, made of its command line.
namespace foucault::app {

/// foucault(1), in the language of man.
std::string man_page(const CommandEntry& program, const std::string& version);

/// Completion of commands, options and file names for bash.
std::string bash_completion(const CommandEntry& program);

/// The same for zsh, with what each is for.
std::string zsh_completion(const CommandEntry& program);

}  // namespace foucault::app
