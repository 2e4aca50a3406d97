#include "child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "foucault/core/error.h"

extern char** environ;

namespace foucault::rawlog {

namespace {

constexpr size_t kLastWords = 4096;  ///< that are kept [bytes]

class ChildPipe {
 public:
  ChildPipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) {
      throw DataError(fmt::format("no pipe to another program: {}", std::strerror(errno)));
    }
  }
  ~ChildPipe() {
    close_end(0);
    close_end(1);
  }
  ChildPipe(const ChildPipe&) = delete;
  ChildPipe& operator=(const ChildPipe&) = delete;

  int output() const { return ends_[0]; }
  int input() const { return ends_[1]; }
  void close_input() { close_end(1); }

 private:
  void close_end(size_t end) {
    if (ends_[end] >= 0) close(ends_[end]);
    ends_[end] = -1;
  }

  std::array<int, 2> ends_{-1, -1};
};

/// A process that does not outlive this object.
class Child {
 public:
  Child(const Program& program, int output);
  ~Child() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Its status, as waitpid() has it.
  int wait() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
};

Child::Child(const Program& program, int output) {
  std::vector<char*> arguments;
  arguments.push_back(const_cast<char*>(program.name.c_str()));
  for (const std::string& argument : program.arguments) {
    arguments.push_back(const_cast<char*>(argument.c_str()));
  }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, output, STDERR_FILENO);
  const int error =
      posix_spawnp(&pid_, program.name.c_str(), &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error == 0) return;
  pid_ = -1;
  if (error != ENOENT) {
    throw DataError(
        fmt::format("the program '{}' does not start: {}", program.name, std::strerror(error)));
  }
  throw DataError(
      fmt::format("the program '{}' is not there; install the package {} (Debian, Ubuntu: apt "
                  "install {})",
                  program.name, program.package, program.package));
}

/// The last line, of those that end with a return of the carriage too.
std::string last_line(const std::string& text) {
  constexpr const char* kEnds = "\r\n";
  const size_t end = text.find_last_not_of(" \r\n");
  if (end == std::string::npos) return "it says nothing";
  const size_t before = text.find_last_of(kEnds, end);
  const size_t begin = before == std::string::npos ? 0 : before + 1;
  return text.substr(begin, end + 1 - begin);
}

/// False at its end.
bool read_piece(int descriptor, std::string_view& piece, std::array<char, kLastWords>& buffer) {
  constexpr int kPatience = 100;  // [ms]
  piece = {};
  pollfd ready{descriptor, POLLIN, 0};
  if (poll(&ready, 1, kPatience) <= 0) return true;  // nothing, or a signal
  const ssize_t size = read(descriptor, buffer.data(), buffer.size());
  if (size > 0) piece = {buffer.data(), static_cast<size_t>(size)};
  return size > 0 || (size < 0 && errno == EINTR);
}

}  // namespace

void run_program(const Program& program, const std::function<void(std::string_view)>& listen) {
  ChildPipe pipe;
  Child child(program, pipe.input());
  pipe.close_input();
  std::string words;
  std::array<char, kLastWords> buffer{};
  std::string_view piece;
  while (read_piece(pipe.output(), piece, buffer)) {
    listen(piece);
    words += piece;
    if (words.size() > 2 * kLastWords) words.erase(0, words.size() - kLastWords);
  }
  const int status = child.wait();
  listen({});  // before a signal that meant this program too is taken for a failure
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  const std::string how = WIFSIGNALED(status)
                              ? fmt::format("was ended by signal {}", WTERMSIG(status))
                              : fmt::format("failed ({})", WEXITSTATUS(status));
  throw DataError(fmt::format("{} {}: {}", program.name, how, last_line(words)));
}

}  // namespace foucault::rawlog
