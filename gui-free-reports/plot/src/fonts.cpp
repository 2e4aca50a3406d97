#include <cstdlib>
#include <filesystem>

#include "foucault/core/error.h"
#include "foucault/plot/renderer.h"

namespace foucault::plot {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRegular = "DejaVuSans.ttf";
constexpr const char* kRemedy =
    "install the package fonts-dejavu-core or set FOUCAULT_FONT to a .ttf file";

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// The bold face that lies beside `regular`, or `regular` itself.
Fonts with_bold(const fs::path& regular) {
  const fs::path bold = regular.parent_path() / (regular.stem().string() + "-Bold.ttf");
  return {regular.string(), is_file(bold) ? bold.string() : regular.string()};
}

Fonts fonts_of_environment(const std::string& value) {
  const fs::path path(value);
  if (is_file(path)) return with_bold(path);
  if (is_file(path / kRegular)) return with_bold(path / kRegular);
  throw DataError("FOUCAULT_FONT='" + value + "': no font there; " + kRemedy);
}

}  // namespace

Fonts find_fonts() {
  const char* const environment = std::getenv("FOUCAULT_FONT");
  if (environment != nullptr && *environment != '\0') return fonts_of_environment(environment);
  for (const char* folder :
       {"/usr/share/fonts/truetype/dejavu", "/usr/share/fonts/truetype/ttf-dejavu",
        "/usr/share/fonts/dejavu-sans-fonts", "/usr/share/fonts/TTF", "/usr/local/share/fonts"}) {
    const fs::path regular = fs::path(folder) / kRegular;
    if (is_file(regular)) return with_bold(regular);
  }
  throw DataError(std::string("no font to draw with (") + kRegular + "); " + kRemedy);
}

}  // namespace foucault::plot
