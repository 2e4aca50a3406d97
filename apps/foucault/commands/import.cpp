#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "import_formats.h"

namespace foucault::app {
namespace {

constexpr Command kFormats[] = {
    {"auto", "Any of these: recognizes a file by its content", declare_import_auto},
    {"csv", "Tables in columns, told by a mapping", declare_import_csv},
    {"rtklib", "A solution of RTKLIB (.pos) and an IMU table", declare_import_rtklib},
    {"rinex", "Raw observations (RINEX), made to fixes by RTKLIB", declare_import_rinex},
    {"nmea", "NMEA 0183 of a receiver, and an IMU table", declare_import_nmea},
    {"ubx", "UBX of a u-blox receiver, with its own IMU or a table", declare_import_ubx},
    {"novatel", "Logs of a NovAtel receiver: IMU, GNSS and INS", declare_import_novatel},
    {"bag", "A recording of ROS 1 or 2, MCAP: topics of an IMU and a receiver", declare_import_bag},
    {"ulog", "A ULog of PX4: IMU and GNSS of an autopilot", declare_import_ulog},
    {"dataflash", "A DataFlash log of ArduPilot: IMU and GNSS of an autopilot",
     declare_import_dataflash},
    {"i2nav", "Text files of the i2Nav group (.txt, .pos, .nav)", declare_import_i2nav},
};

constexpr const char* kExamples =
    "\nExamples:\n"
    "  foucault import auto drive.bag --lever-arm 0.3,0,-0.5 --out drive.rawlog\n"
    "  foucault import csv --guess imu.csv gnss.csv --out drive.yaml\n"
    "  foucault import csv --mapping drive.yaml --out drive.rawlog\n"
    "  foucault import i2nav --imu ADIS16465.txt --gnss GNSS_RTK.pos --reference truth.nav \\\n"
    "      --gps-week 2017 --lever-arm -0.073,0.302,0.087 --out trip.rawlog\n"
    "\n'foucault help import FORMAT' tells the options of a format.";

}  // namespace

const Command* find_import(const std::string& name) {
  const auto* found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                   [&](const Command& format) { return name == format.name; });
  return found == std::end(kFormats) ? nullptr : found;
}

std::function<void(Call&)> declare_import(CLI::App& app) {
  app.require_subcommand(1);
  app.footer(kExamples);
  std::vector<std::pair<CLI::App*, std::function<void(Call&)>>> imports;
  for (const Command& format : kFormats) {
    CLI::App* subcommand = app.add_subcommand(format.name, format.summary);
    subcommand->fallthrough();
    imports.emplace_back(subcommand, format.declare(*subcommand));
  }
  return [imports](Call& call) {
    for (const auto& [subcommand, import] : imports) {
      if (subcommand->parsed()) import(call);
    }
  };
}

}  // namespace foucault::app
