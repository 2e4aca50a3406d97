#pragma once

#include <optional>
#include <string>

/// What kind of recording a file is, by its content; its name says nothing.
namespace foucault::rawlog {

struct FileFormat {
  const char* name;     ///< as messages call it
  const char* command;  ///< of `foucault import`; "" for rawlogs, which need none
};

/// Plain or gzip; a folder is a rosbag 2 if it has metadata.yaml. None if it is nothing known.
/// Throws DataError if the file is missing, empty or cannot be read.
std::optional<FileFormat> recognize(const std::string& path);

}  // namespace foucault::rawlog
