#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

#include "arguments.h"
#include "foucault/core/error.h"
#include "foucault/rawlog/guess_mapping.h"
#include "foucault/rawlog/import_csv.h"
#include "foucault/rawlog/import_i2nav.h"
#include "foucault/rawlog/import_nmea.h"
#include "foucault/rawlog/import_rtklib.h"
#include "import_formats.h"

/// Tables and texts, one file a sensor.
namespace foucault::app {
namespace {

std::string mapping_help() {
  rawlog::ImportMapping mapping;
  return describe_config(mapping);
}

template <class Import>
struct MappedOptions {
  Import import;
  std::optional<std::string> lever_arm;
};

/// `rtklib`, `csv` and `nmea` take the same options.
template <class Import>
std::function<void(Call&)> declare_mapped(CLI::App& app,
                                          rawlog::ImportSummary (*import)(const Import&),
                                          const char* gnss_help, bool needs_mapping = true) {
  const auto o = std::make_shared<MappedOptions<Import>>();
  app.add_option("--mapping", o->import.mapping,
                 "YAML that names columns, units, axes, clocks and the lever arm")
      ->required(needs_mapping);
  app.add_option("--data", o->import.data_dir,
                 "Folder of the files that the mapping names; without it the mapping's own");
  app.add_option("--imu", o->import.imu, "IMU table, instead of the mapping's");
  app.add_option("--gnss", o->import.gnss, gnss_help);
  app.add_option("--reference", o->import.reference, "Reference table, instead of the mapping's");
  app.add_option("--wheel", o->import.wheel, "Table of wheel speeds, instead of the mapping's");
  app.add_option("--lever-arm", o->lever_arm, kLeverArmHelp);
  add_import_options(app, o->import);
  add_help_text(app, "--help-mapping", "List every key of a mapping, with default and meaning",
                mapping_help);
  return [o, import](Call& call) {
    if (o->lever_arm) o->import.lever_arm = parse_vector3("--lever-arm", *o->lever_arm);
    o->import.progress = call.console.progress_of("importing");
    report_import(call.console, import(o->import), o->import.out);
  };
}

/// Writes a file, or to the terminal. What somebody corrected by hand is not written over unasked.
void write_mapping(Console& console, const std::string& text, const std::string& out,
                   bool overwrite) {
  if (out.empty()) {
    std::cout << text;
    return;
  }
  if (!overwrite && std::filesystem::exists(out)) {
    throw UsageError("'" + out + "' is there already; name another file, or write over it by -w");
  }
  std::ofstream file(out, std::ios::binary);
  if (!(file << text << std::flush)) {
    throw DataError("'" + out + "' cannot be written; check the folder");
  }
  console.say("written    " + out + "; check what is marked `not sure` and `to be told`");
}

void guess_and_write(Console& console, const std::vector<std::string>& files,
                     const std::string& out, bool overwrite) {
  const std::string folder = std::filesystem::path(out).parent_path().string();
  write_mapping(console, rawlog::mapping_text(rawlog::guess_mapping(files, folder)), out,
                overwrite);
}

}  // namespace

std::function<void(Call&)> declare_import_i2nav(CLI::App& app) {
  struct Options {
    rawlog::I2navImport import;
    std::string lever_arm;
  };
  const auto o = std::make_shared<Options>();
  app.add_option("--imu", o->import.imu,
                 "Increments: sow, dtheta x y z [rad], dvel x y z [m/s] (.txt or .gz)")
      ->required();
  app.add_option("--gnss", o->import.gnss,
                 "Fixes: sow, latitude, longitude [deg], height [m], sigma north, east, down [m]")
      ->required();
  app.add_option("--reference", o->import.reference, "Reference trajectory (.nav)");
  app.add_option(
      "--wheel", o->import.wheel,
      "Wheel speeds, if they have a file of their own: sow, speed [m/s], a header or not "
      "(.txt, .csv or .gz)");
  app.add_option("--gps-week", o->import.gps_week,
                 "GPS week of the first row; without it the reference's");
  app.add_option("--lever-arm", o->lever_arm, kLeverArmHelp)->required();
  add_import_options(app, o->import);
  app.footer(
      "\nExamples:\n"
      "  foucault import i2nav --imu ADIS16465.txt --gnss GNSS_RTK.pos --reference truth.nav \\\n"
      "      --gps-week 2017 --lever-arm -0.073,0.302,0.087 --out trip.rawlog\n"
      "  foucault import i2nav --imu imu.txt --gnss rtk.pos --wheel wheel.csv --gps-week 2200 \\\n"
      "      --lever-arm 0.1,-0.3,-0.8 --out drive.rawlog");
  return [o](Call& call) {
    o->import.lever_arm = parse_vector3("--lever-arm", o->lever_arm);
    o->import.progress = call.console.progress_of("importing");
    report_import(call.console, rawlog::import_i2nav(o->import), o->import.out);
  };
}

std::function<void(Call&)> declare_import_rtklib(CLI::App& app) {
  app.footer(
      "\nExamples:\n"
      "  foucault import rtklib --gnss drive.pos --imu imu.csv --mapping drive.yaml \\\n"
      "      --out drive.rawlog");
  return declare_mapped<rawlog::RtklibImport>(app, rawlog::import_rtklib,
                                              "RTKLIB's .pos, instead of the mapping's");
}

std::function<void(Call&)> declare_import_csv(CLI::App& app) {
  const auto import = declare_mapped<rawlog::CsvImport>(
      app, rawlog::import_csv, "GNSS table, instead of the mapping's", false);
  const auto files = std::make_shared<std::vector<std::string>>();
  app.add_option("--guess", *files,
                 "Instead of an import: write a mapping of these tables to start from, to --out "
                 "(.yaml) or to the terminal");
  app.get_option("--out")->required(false);
  app.footer(
      "\nExamples:\n"
      "  foucault import csv --guess imu.csv gnss.csv --out drive.yaml\n"
      "  foucault import csv --mapping drive.yaml --out drive.rawlog\n"
      "  foucault import csv --mapping drive.yaml --data day2 --lever-arm 0.3,0,-0.5 "
      "--out day2.rawlog");
  return [&app, import, files](Call& call) {
    const std::string out = app.get_option("--out")->as<std::string>();
    if (!files->empty()) {
      return guess_and_write(call.console, *files, out, app.count("--overwrite") > 0);
    }
    if (app.get_option("--mapping")->empty()) {
      throw UsageError("--mapping is required; --guess FILE... writes one to start from");
    }
    if (out.empty()) throw UsageError("--out is required");
    import(call);
  };
}

std::function<void(Call&)> declare_import_nmea(CLI::App& app) {
  app.footer(
      "\nExamples:\n"
      "  foucault import nmea --gnss drive.nmea --imu imu.csv --mapping drive.yaml "
      "--out drive.rawlog\n"
      "  foucault import nmea --gnss drive.nmea --out fixes.rawlog");
  return declare_mapped<rawlog::NmeaImport>(app, rawlog::import_nmea,
                                            "NMEA sentences, instead of the mapping's", false);
}

}  // namespace foucault::app
