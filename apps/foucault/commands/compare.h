#pragma once

#include "command.h"

namespace foucault::app {

std::function<void(Call&)> declare_compare(CLI::App& app);

}  // namespace foucault::app
