#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace foucault::test {

/// The files of a folder of results by their relative names, with the times of the processor taken
/// out of metrics.json and points.csv: what is left does not depend on who computed it.
std::map<std::string, std::string> timeless_files(const std::filesystem::path& folder);

}  // namespace foucault::test
