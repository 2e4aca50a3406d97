#include "support/program.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "support/program_path.h"
#include "support/test_folder.h"

extern char** environ;

namespace foucault::test {
namespace {

/// A child process whose output goes into files of a folder.
class Child {
 public:
  Child(const std::string& program, const std::vector<std::string>& arguments) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
    const std::string out = folder_ / "out";
    const std::string err = folder_ / "err";
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), kWrite, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), kWrite, 0600);
    std::vector<std::string> words{program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const int error = posix_spawn(&pid_, program.c_str(), &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) throw std::runtime_error("cannot start " + program);
  }

  pid_t pid() const { return pid_; }

  Outcome wait() const {
    int status = 0;
    waitpid(pid_, &status, 0);
    Outcome outcome;
    if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
    outcome.out = folder_.text("out");
    outcome.err = folder_.text("err");
    return outcome;
  }

 private:
  TestFolder folder_;
  pid_t pid_ = 0;
};

}  // namespace

Outcome foucault(const std::vector<std::string>& arguments) {
  return Child(kProgramPath, arguments).wait();
}

Outcome foucault_after(const std::string& preparation, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"-c", preparation + "; exec \"$0\" \"$@\"", kProgramPath};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return Child("/bin/sh", words).wait();
}

Outcome shell(const std::string& script) {
  return Child("/bin/sh", {"-c", script, kProgramPath}).wait();
}

std::filesystem::path tests_folder() { return std::filesystem::path(kSourceFolder) / "tests"; }

Outcome foucault_disturbed(const std::vector<std::string>& arguments,
                           const std::function<bool()>& now,
                           const std::function<void(pid_t)>& act) {
  const Child child(kProgramPath, arguments);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!now() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  act(child.pid());
  return child.wait();
}

Outcome foucault_interrupted(const std::vector<std::string>& arguments,
                             const std::function<bool()>& now, int signal) {
  return foucault_disturbed(arguments, now, [signal](pid_t pid) { kill(pid, signal); });
}

std::optional<std::filesystem::path> shared_data() {
  const char* named = std::getenv("FOUCAULT_DATA_DIR");
  const std::filesystem::path folder =
      named != nullptr ? std::filesystem::path(named)
                       : std::filesystem::path(kSourceFolder).parent_path() / "shared" / "data";
  if (!std::filesystem::is_directory(folder)) return std::nullopt;
  return folder;
}

}  // namespace foucault::test
