#include "foucault/core/loaded_part.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>

#include "foucault/core/error.h"

namespace foucault {

void* load_part(const std::string& library, const char* entry) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  fs::path file = folder / (library + ".so");
  if (!fs::exists(file)) file = folder.parent_path() / "lib" / "foucault" / (library + ".so");
  void* const part = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const found = part == nullptr ? nullptr : dlsym(part, entry);
  if (found != nullptr) return found;
  throw DataError(
      fmt::format("a part of the program cannot be loaded: {}; install it again", dlerror()));
}

}  // namespace foucault
