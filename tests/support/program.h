#pragma once

#include <sys/types.h>

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

/// The same from a shell that has done `preparation` before: "ulimit -f 100", "exec > /dev/full".
Outcome foucault_after(const std::string& preparation, const std::vector<std::string>& arguments);

/// Runs a script of the shell; "$0" in it is the built `foucault`.
Outcome shell(const std::string& script);

/// The sources' folder tests/.
std::filesystem::path tests_folder();

/// Starts it, acts on it once `now` says so (or after a minute), and waits for its end.
Outcome foucault_disturbed(const std::vector<std::string>& arguments,
                           const std::function<bool()>& now, const std::function<void(pid_t)>& act);

/// Disturbs it with a signal.
Outcome foucault_interrupted(const std::vector<std::string>& arguments,
                             const std::function<bool()>& now, int signal);

/// Folder of the real recordings: $FOUCAULT_DATA_DIR, else shared/data beside the repository.
std::optional<std::filesystem::path> shared_data();

}  // namespace foucault::test
