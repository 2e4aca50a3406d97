#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace foucault::test {

/// What a call of the program came to.
struct Outcome {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string out;     ///< stdout
  std::string err;     ///< stderr
};

/// Runs the built `foucault` with `arguments`, stdin empty.
Outcome foucault(const std::vector<std::string>& arguments);

/// Starts it, sends SIGTERM once `now` says so (or after a minute), and waits for its end.
Outcome foucault_interrupted(const std::vector<std::string>& arguments,
                             const std::function<bool()>& now);

/// Folder of the real recordings: $FOUCAULT_DATA_DIR, else shared/data beside the repository.
std::optional<std::filesystem::path> shared_data();

}  // namespace foucault::test
