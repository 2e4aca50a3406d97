#pragma once

#include <string>
#include <string_view>

namespace foucault::plot {

/// Throws DataError naming the file.
void write_file(const std::string& path, std::string_view content);
std::string read_file(const std::string& path);

}  // namespace foucault::plot
