#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include "foucault/core/error.h"

namespace foucault::exports {

/// Results cannot be written: no room, no folder.
class WriteError : public DataError {
 public:
  using DataError::DataError;
};

/// A text file written from front to back. Whatever goes wrong (a full disk, too) is a WriteError.
class TextFile {
 public:
  explicit TextFile(const std::filesystem::path& path);

  void write(std::string_view text);

  /// Flushes and closes; nothing may be written afterwards.
  void close();

 private:
  [[noreturn]] void fail() const;

  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
};

/// The whole of a file at once.
void write_text_file(const std::filesystem::path& path, std::string_view text);

}  // namespace foucault::exports
