#pragma once

#include <filesystem>
#include <string>

namespace foucault::app {

/// A folder of results that appears whole or not at all. Everything is written into a folder
/// beside the target (inside it, if it exists); commit() moves it into place. Without commit() the
/// destructor removes what was written, and earlier results stay as they were.
class OutputDirectory {
 public:
  /// Throws DataError if nothing can be written there, UsageError if the path is empty.
  explicit OutputDirectory(const std::string& target);
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  /// Where to write until commit().
  const std::filesystem::path& staging() const { return staging_; }

  /// Moves everything to the target, over entries of the same name there; other entries of an
  /// existing target stay. Throws DataError.
  void commit();

 private:
  void replace_entries();

  std::filesystem::path target_;
  std::filesystem::path staging_;
};

}  // namespace foucault::app
