#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace foucault::app {

class HeldFolder;

/// A folder of results that appears whole or not at all. Everything is written into a hidden folder
/// beside the target (inside it, if it exists); commit() moves it into place. Without commit() the
/// destructor removes what was written, and earlier results stay as they were. What a process that
/// was killed left behind is removed by the next one with the same target; the folder of a process
/// that lives is locked, and left alone.
class OutputDirectory {
 public:
  /// Throws DataError if nothing can be written there, UsageError if the path is empty.
  explicit OutputDirectory(const std::string& target);
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  /// Where to write until commit().
  const std::filesystem::path& staging() const { return staging_; }

  /// What commit() does not write and what an earlier result may have left: it would belong to
  /// none of the new results. An entry of that name goes when the others are replaced.
  void withdraw(const std::string& name) { withdrawn_.push_back(name); }

  /// Moves everything to the target, over entries of the same name there; other entries of an
  /// existing target stay. Never is an entry missing or half there, and if one cannot be replaced,
  /// all are put back. Throws DataError, also if the staging folder has vanished meanwhile, and
  /// Interrupted.
  void commit();

 private:
  void make_staging();
  void replace_entries();
  void remove_withdrawn();

  std::filesystem::path target_;
  std::vector<std::string> withdrawn_;
  std::vector<std::filesystem::path> new_parents_;  ///< folders made above it, the deepest first
  std::filesystem::path staging_;
  std::unique_ptr<HeldFolder> held_;  ///< the staging folder
};

/// Where the results are, for the user.
std::vector<std::string> written_lines(const std::string& target, bool with_report);

}  // namespace foucault::app
