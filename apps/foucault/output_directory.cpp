#include "output_directory.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "foucault/core/error.h"
#include "interrupt.h"

namespace fs = std::filesystem;

namespace foucault::app {

/// A folder held open, and locked against others who do the same.
class HeldFolder {
 public:
  explicit HeldFolder(fs::path path)
      : path_(std::move(path)),
        file_(open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)) {}
  ~HeldFolder() {
    if (file_ >= 0) close(file_);
  }
  HeldFolder(const HeldFolder&) = delete;
  HeldFolder& operator=(const HeldFolder&) = delete;

  /// False if another process holds it.
  bool lock() const { return flock(file_, LOCK_EX | LOCK_NB) == 0; }
  void wait_for_lock() const { flock(file_, LOCK_EX); }

  /// Whether the path still leads to this folder.
  bool in_place() const {
    struct stat held {
    }, there{};
    return file_ >= 0 && fstat(file_, &held) == 0 && lstat(path_.c_str(), &there) == 0 &&
           held.st_ino == there.st_ino && held.st_dev == there.st_dev;
  }

 private:
  fs::path path_;
  int file_;
};

namespace {

constexpr const char* kStagingMark = ".foucault-";
constexpr const char* kRandomPart = "XXXXXX";  // as mkdtemp wants it

[[noreturn]] void fail(const fs::path& target, const std::string& reason) {
  throw DataError(
      fmt::format("cannot write to '{}': {}; give another --out", target.string(), reason));
}

/// The folders above `path` that are not there, the deepest first.
std::vector<fs::path> missing_parents(const fs::path& path) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path p = path.parent_path(); p.has_relative_path() && !fs::exists(p, error);
       p = p.parent_path()) {
    missing.push_back(p);
  }
  return missing;
}

/// Removes the staging folders in `folder` that nobody holds.
void remove_left_behind(const fs::path& folder, const std::string& prefix) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool is_staging = name.compare(0, prefix.size(), prefix) == 0 &&
                            name.size() == prefix.size() + std::strlen(kRandomPart);
    if (!is_staging) continue;
    const HeldFolder held(it->path());
    std::error_code ignored;
    if (held.lock() && held.in_place()) fs::remove_all(it->path(), ignored);
  }
}

/// Makes a folder of a name not used yet, with the permissions a plain mkdir would give.
fs::path make_folder(const fs::path& target, const std::string& prefix) {
  std::string name = prefix + kRandomPart;
  if (mkdtemp(name.data()) == nullptr) fail(target, std::strerror(errno));
  const mode_t mask = umask(0);
  umask(mask);
  chmod(name.c_str(), 0777 & ~mask);
  return name;
}

/// Returns errno, 0 if it went well.
int move(const fs::path& from, const fs::path& to, unsigned flags) {
  return renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), flags) == 0 ? 0 : errno;
}

bool is_unsupported(int error) { return error == EINVAL || error == ENOSYS; }

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

/// Moves to a name not used yet. Returns errno.
int move_to_new(const fs::path& from, const fs::path& to) {
  const int error = move(from, to, RENAME_NOREPLACE);
  if (!is_unsupported(error)) return error;
  return is_there(to) ? EEXIST : move(from, to, 0);
}

/// For file systems that cannot exchange: with a moment in which `there` is missing.
int exchange_in_steps(const fs::path& here, const fs::path& there) {
  const fs::path aside = here.string() + ".aside";
  if (const int error = move(there, aside, 0)) return error;
  if (const int error = move(here, there, 0)) {
    move(aside, there, 0);
    return error;
  }
  return move(aside, here, 0);
}

/// Exchanges two entries in one step; if nothing is `there`, moves what is `here`. Returns errno.
int exchange(const fs::path& here, const fs::path& there) {
  const int error = move(here, there, RENAME_EXCHANGE);
  if (error == ENOENT) return move_to_new(here, there);
  if (!is_unsupported(error)) return error;
  return is_there(there) ? exchange_in_steps(here, there) : move(here, there, 0);
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Results take the place of those of the same name, a report that of a report: a folder 'report'
/// of another origin would be lost.
void check_report(const fs::path& target) {
  const fs::path report = target / "report";
  std::error_code error;
  if (!fs::is_directory(report, error) || fs::is_empty(report, error)) return;
  if (fs::exists(report / "report.json", error)) return;
  fail(target, "its folder 'report' is none of ours and would be replaced");
}

/// A file is only put in the place of a file, a folder in that of a folder.
void check_replaceable(const fs::path& ours, const fs::path& theirs) {
  std::error_code ignored;
  if (!fs::exists(theirs, ignored)) return;
  if (fs::is_directory(ours, ignored) == fs::is_directory(theirs, ignored)) return;
  fail(theirs, fs::is_directory(theirs, ignored) ? "it is a folder" : "it is a file");
}

}  // namespace

OutputDirectory::OutputDirectory(const std::string& target) {
  if (target.empty()) throw UsageError("--out is empty; name a folder for the results");
  std::error_code error;
  target_ = fs::absolute(target, error).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path();
  make_staging();
}

OutputDirectory::~OutputDirectory() {
  std::error_code ignored;
  if (staging_.empty()) return;
  fs::remove_all(staging_, ignored);
  for (const fs::path& parent : new_parents_) fs::remove(parent, ignored);  // if it is empty
}

void OutputDirectory::make_staging() {
  std::error_code error;
  const bool exists = fs::exists(target_, error);
  if (exists && !fs::is_directory(target_, error)) fail(target_, "it is a file");
  if (fs::is_symlink(target_, error) && !exists) fail(target_, "it is a link to nothing");
  check_report(target_);
  new_parents_ = missing_parents(target_);
  fs::create_directories(target_.parent_path(), error);
  if (error) fail(target_, error.message());

  const std::string beside = "." + target_.filename().string() + kStagingMark;
  remove_left_behind(target_.parent_path(), beside);
  if (exists) remove_left_behind(target_, kStagingMark);
  const fs::path prefix = exists ? target_ / kStagingMark : target_.parent_path() / beside;
  constexpr int kAttempts = 10;  // another process may take it for left behind before it is locked
  for (int i = 0; i < kAttempts; ++i) {
    staging_ = make_folder(target_, prefix.string());
    held_ = std::make_unique<HeldFolder>(staging_);
    held_->lock();
    if (held_->in_place()) return;
  }
  fail(target_, "folders made there do not last");
}

void OutputDirectory::commit() {
  stop_if_interrupted();
  if (!held_->in_place()) fail(target_, "the folder was removed while it was written");
  const int error = move_to_new(staging_, target_);
  if (error == EEXIST) {
    replace_entries();
  } else if (error != 0) {
    fail(target_, std::strerror(error));
  } else {
    staging_.clear();
  }
  held_.reset();
}

void OutputDirectory::replace_entries() {
  const HeldFolder target(target_);
  target.wait_for_lock();  // one process after another
  const std::vector<fs::path> names = entries_of(staging_);
  for (const fs::path& name : names) check_replaceable(staging_ / name, target_ / name);
  for (auto name = names.begin(); name != names.end(); ++name) {
    const int error = exchange(staging_ / *name, target_ / *name);
    if (error == 0) continue;
    while (name != names.begin()) {
      --name;
      exchange(target_ / *name, staging_ / *name);
    }
    fail(target_, std::strerror(error));
  }
  for (const fs::path& name : names) {
    withdrawn_.erase(std::remove(withdrawn_.begin(), withdrawn_.end(), name.string()),
                     withdrawn_.end());
  }
  remove_withdrawn();
}

/// Into the staging folder, which goes with what was replaced.
void OutputDirectory::remove_withdrawn() {
  for (const std::string& name : withdrawn_) {
    if (!is_there(target_ / name)) continue;
    if (const int error = move_to_new(target_ / name, staging_ / name)) {
      fail(target_ / name, std::strerror(error));
    }
  }
}

std::vector<std::string> written_lines(const std::string& target, bool with_report) {
  std::vector<std::string> lines{fmt::format("{:<10} {}", "written", target)};
  if (with_report) {
    const fs::path page = fs::path(target) / "report" / "index.html";
    lines.push_back(fmt::format("{:<10} {}", "report", page.string()));
  }
  return lines;
}

}  // namespace foucault::app
