#include <filesystem>
#include <memory>

#include "command.h"
#include "foucault/reports/report_page.h"

namespace foucault::app {
namespace {

/// The report folder of a run's folder, or the folder itself.
std::string report_folder(const std::string& folder) {
  const std::filesystem::path inner = std::filesystem::path(folder) / "report";
  return std::filesystem::is_directory(inner) ? inner.string() : folder;
}

}  // namespace

std::function<void(Call&)> declare_report(CLI::App& app) {
  const auto folder = std::make_shared<std::string>();
  app.add_option("DIR", *folder, "Folder that 'foucault run' wrote, or its report folder")
      ->required();
  return [folder](Call& call) {
    const std::string report = report_folder(*folder);
    reports::redraw_report(report);
    call.console.say("report " + report + "/index.html drawn again");
  };
}

}  // namespace foucault::app
