#pragma once

#include <string>
#include <vector>

namespace foucault::benchmarks {

/// CPU time of a program, user and system, from its start to its end [s]; what it says on stdout is
/// dropped. Throws std::runtime_error if it cannot be started or fails.
double cpu_seconds(const std::vector<std::string>& command);

/// The shortest of so many.
double best_cpu_seconds(const std::vector<std::string>& command, int times);

}  // namespace foucault::benchmarks
