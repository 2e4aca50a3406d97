#include "foucault/plot/files.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "foucault/core/error.h"

namespace foucault::plot {

void write_file(const std::string& path, std::string_view content) {
  std::ofstream file(path, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) throw DataError(path + ": cannot be written (" + std::strerror(errno) + ")");
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw DataError(path + ": cannot be read (" + std::strerror(errno) + ")");
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

}  // namespace foucault::plot
