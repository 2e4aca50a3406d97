#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "arguments.h"
#include "foucault/core/units.h"
#include "foucault/rawlog/import_raw_gnss.h"
#include "import_formats.h"

/// What receivers record, raw observations among it.
namespace foucault::app {
namespace {

struct RawGnssTexts {
  std::optional<std::string> base_position;
  std::optional<std::string> lever_arm;
};

void add_raw_gnss_options(CLI::App& app, rawlog::RawGnssImport& import, RawGnssTexts& texts) {
  app.add_option("--nav", import.nav, "RINEX navigation files: FILE[,FILE...]")->delimiter(',');
  app.add_option("--base", import.base,
                 "Observations of a base, RINEX or UBX: fixes by RTKLIB, kinematic, forward and "
                 "backward combined");
  app.add_option("--base-position", texts.base_position,
                 "Of the base's antenna [deg, m above the ellipsoid]: LAT,LON,H; without it the "
                 "RINEX header's");
  app.add_option("--rtklib-options", import.rtklib_options,
                 "Options for rnx2rtkp (-k) instead of our own");
  app.add_option("--mapping", import.mapping, "YAML that names columns, units, axes of --imu");
  app.add_option("--data", import.data_dir,
                 "Folder of the files that the mapping names; without it the mapping's own");
  app.add_option("--imu", import.imu, "IMU table, told by --mapping");
  app.add_option("--reference", import.reference, "Reference table, told by --mapping");
  app.add_option("--wheel", import.wheel, "Table of wheel speeds, told by --mapping");
  app.add_option("--lever-arm", texts.lever_arm, kLeverArmHelp);
  add_import_options(app, import);
}

void finish_options(Call& call, const RawGnssTexts& texts, rawlog::RawGnssImport& import) {
  if (texts.lever_arm) import.lever_arm = parse_vector3("--lever-arm", *texts.lever_arm);
  if (texts.base_position) {
    const Eigen::Vector3d base = parse_vector3("--base-position", *texts.base_position);
    import.base_position = Geodetic{base.x() * kDegree, base.y() * kDegree, base.z()};
  }
  import.progress = call.console.progress_of("importing");
}

}  // namespace

std::function<void(Call&)> declare_import_rinex(CLI::App& app) {
  struct Options {
    rawlog::RawGnssImport import;
    RawGnssTexts texts;
  };
  const auto o = std::make_shared<Options>();
  app.add_option("--rover", o->import.rover, "RINEX observations (2 or 3; .gz too)")->required();
  add_raw_gnss_options(app, o->import, o->texts);
  app.footer(
      "\nExamples:\n"
      "  foucault import rinex --rover rover.obs --nav day.nav --out fixes.rawlog\n"
      "  foucault import rinex --rover rover.obs --base base.obs --nav day.nav --imu imu.csv \\\n"
      "      --mapping drive.yaml --out drive.rawlog");
  return [o](Call& call) {
    finish_options(call, o->texts, o->import);
    report_import(call.console, rawlog::import_rinex(o->import), o->import.out);
  };
}

std::function<void(Call&)> declare_import_ubx(CLI::App& app) {
  struct Options {
    rawlog::UbxImport import;
    RawGnssTexts texts;
  };
  const auto o = std::make_shared<Options>();
  add_input_option(app, "log", o->import.rover, "UBX of a u-blox receiver (.ubx, or .gz)")
      ->required();
  app.add_option(
         "--imu-axes", o->import.imu_axes,
         "Axes of the receiver's own IMU that look forward, right, down; without it x,-y,-z")
      ->delimiter(',');
  add_raw_gnss_options(app, o->import, o->texts);
  app.footer(
      "\nExamples:\n"
      "  foucault import ubx drive.ubx --lever-arm 0.3,0,-0.5 --out drive.rawlog\n"
      "  foucault import ubx drive.ubx --base base.obs --nav day.nav --lever-arm 0.3,0,-0.5 \\\n"
      "      --out drive.rawlog");
  return [o](Call& call) {
    finish_options(call, o->texts, o->import);
    report_import(call.console, rawlog::import_ubx(o->import), o->import.out);
  };
}

}  // namespace foucault::app
