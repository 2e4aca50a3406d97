#pragma once

#include <filesystem>
#include <string>

namespace foucault {

/// A part of the program that is a library of its own: LIBRARY.so in the folder of the program,
/// else in ../lib/foucault beside that.
std::filesystem::path part_file(const std::string& library);

/// The function `entry` of a part, which is loaded once it is needed and stays loaded. Throws
/// DataError if it cannot be loaded.
void* load_part(const std::string& library, const char* entry);

}  // namespace foucault
