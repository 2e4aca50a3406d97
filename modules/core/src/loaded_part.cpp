#include "foucault/core/loaded_part.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>

#include "foucault/core/error.h"

namespace foucault {

std::filesystem::path part_file(const std::string& library) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  const std::string name = library + ".so";
  const fs::path beside = folder / name;
  const fs::path installed = folder.parent_path() / "lib" / "foucault" / name;
  return fs::exists(beside, error) ? beside : installed;
}

void* load_part(const std::string& library, const char* entry) {
  void* const part = dlopen(part_file(library).c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const found = part == nullptr ? nullptr : dlsym(part, entry);
  if (found != nullptr) return found;
  throw DataError(fmt::format(
      "a part of the program cannot be loaded: {}; install foucault again (a program of one's own "
      "is linked to foucault::rawlog and foucault::plot themselves)",
      dlerror()));
}

}  // namespace foucault
