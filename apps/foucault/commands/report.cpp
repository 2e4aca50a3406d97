#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "arguments.h"
#include "command.h"
#include "foucault/core/error.h"
#include "foucault/page/report_page.h"
#include "output_directory.h"

namespace foucault::app {
namespace {

namespace fs = std::filesystem;

/// The report folder of a run's folder, or the folder itself.
std::string report_folder(const std::string& folder) {
  const fs::path inner = fs::path(folder) / "report";
  return fs::is_directory(inner) ? inner.string() : folder;
}

fs::path absolute(const std::string& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

void copy_folder(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy(from, to, fs::copy_options::recursive, error);
  if (error) {
    throw DataError(fmt::format("cannot write to '{}': {}", from.string(), error.message()));
  }
}

/// Draws a copy, which then takes the place of the report.
void redraw(const std::string& report, Console& console) {
  const fs::path folder = absolute(report);
  if (!fs::exists(folder / "report.json")) {
    throw DataError(
        fmt::format("'{}' holds no report; name a folder that 'foucault run' wrote", report));
  }
  OutputDirectory directory(folder.parent_path().string());
  const fs::path copy = directory.staging() / folder.filename();
  copy_folder(folder, copy);
  console.progress("drawing", 0);
  page::redraw_report(copy.string());
  directory.commit();
}

}  // namespace

std::function<void(Call&)> declare_report(CLI::App& app) {
  const auto folder = std::make_shared<std::string>();
  add_input_option(app, "DIR", *folder, "Folder that 'foucault run' wrote, or its report folder")
      ->required();
  app.footer(
      "\nExamples:\n"
      "  foucault report trip\n"
      "  FOUCAULT_FONT=/usr/share/fonts/mine foucault report trip     in letters of your own");
  return [folder](Call& call) {
    const std::string report = report_folder(*folder);
    redraw(report, call.console);
    call.console.say("report " + report + "/index.html drawn again");
  };
}

}  // namespace foucault::app
