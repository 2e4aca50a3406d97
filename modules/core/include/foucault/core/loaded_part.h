#pragma once

#include <string>

namespace foucault {

/// The function `entry` of a part of the program that is a library of its own, loaded once it is
/// needed: <library>.so in the folder of the program, or in ../lib/foucault beside that. It stays
/// loaded. Throws DataError if it cannot be loaded.
void* load_part(const std::string& library, const char* entry);

}  // namespace foucault
