#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iterator>
#include <memory>
#include <optional>

#include "arguments.h"
#include "command.h"
#include "foucault/core/error.h"
#include "foucault/core/fix_quality.h"
#include "foucault/core/time.h"
#include "foucault/core/units.h"
#include "foucault/rawlog/import_bag.h"
#include "foucault/rawlog/import_csv.h"
#include "foucault/rawlog/import_i2nav.h"
#include "foucault/rawlog/import_nmea.h"
#include "foucault/rawlog/import_rtklib.h"
#include "foucault/rawlog/import_ulog.h"
#include "texts/rawlog_summary.h"

namespace foucault::app {
namespace {

using Action = std::function<void(Call&)>;

std::string stream_line(const std::string& name, const rawlog::ImportStream& s) {
  std::string line = fmt::format("{:<10} {} from {}, {} .. {} ({:.1f} s)", name, s.written, s.file,
                                 utc_text(s.first_ns), utc_text(s.last_ns),
                                 seconds_between(s.first_ns, s.last_ns));
  if (s.without_fix > 0) {
    line += fmt::format(", {} rows without {}", s.without_fix, name == "GNSS" ? "a fix" : "values");
  }
  return line;
}

void report_stream(Console& console, const std::string& name, const rawlog::ImportStream& s) {
  console.say(stream_line(name, s));
  if (s.skipped > 0) {
    console.warn(
        fmt::format("{}: skipped {} bad rows, the first: {}", s.file, s.skipped, s.first_skipped));
  }
  for (const std::string& notice : s.notices) console.warn(notice);
}

void report_summary(Console& console, const rawlog::ImportSummary& summary,
                    const std::string& out) {
  if (!summary.imu.file.empty()) report_stream(console, "IMU", summary.imu);
  report_stream(console, "GNSS", summary.gnss);
  if (summary.reference) report_stream(console, "reference", *summary.reference);
  std::string qualities;
  for (const auto& [quality, count] : summary.qualities) {
    qualities += fmt::format("{}{} {}", qualities.empty() ? "" : ", ", count, name_of(quality));
  }
  console.say(
      fmt::format("{:<10} {}; {} with velocity", "fixes", qualities, summary.with_velocity));
  if (summary.wheel_speeds > 0) {
    console.say(fmt::format("{:<10} {}", "wheels", summary.wheel_speeds));
  }
  const Eigen::Vector3d& arm = summary.lever_arm_v;
  console.say(fmt::format("{:<10} forward {:.3f}, right {:.3f}, down {:.3f} m", "lever arm",
                          arm.x(), arm.y(), arm.z()));
  console.say(fmt::format("{:<10} {}", "written", out));
}

void add_common(CLI::App& app, rawlog::ImportOptions& options) {
  app.add_option("--out", options.out, "Rawlog to write")->required();
  app.add_flag("--skip-bad-rows", options.skip_bad_rows,
               "Leave out rows that are wrong, and count them, instead of stopping");
}

constexpr const char* kLeverArmHelp =
    "IMU to antenna along the vehicle's forward, right, down [m]: X,Y,Z";

Action declare_i2nav(CLI::App& app) {
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
  app.add_option("--gps-week", o->import.gps_week,
                 "GPS week of the first row; without it the reference's");
  app.add_option("--lever-arm", o->lever_arm, kLeverArmHelp)->required();
  add_common(app, o->import);
  return [o](Call& call) {
    o->import.lever_arm = parse_vector3("--lever-arm", o->lever_arm);
    o->import.progress = call.console.progress_of("importing");
    report_summary(call.console, rawlog::import_i2nav(o->import), o->import.out);
  };
}

Action declare_ulog(CLI::App& app) {
  struct Options {
    rawlog::UlogImport import;
    std::optional<std::string> lever_arm;
  };
  const auto o = std::make_shared<Options>();
  app.add_option("log", o->import.log, "ULog of PX4 (.ulg, or .gz)")->required();
  app.add_option("--lever-arm", o->lever_arm,
                 std::string(kLeverArmHelp) + "; without it EKF2_GPS_POS of the log");
  add_common(app, o->import);
  return [o](Call& call) {
    if (o->lever_arm) o->import.lever_arm = parse_vector3("--lever-arm", *o->lever_arm);
    o->import.progress = call.console.progress_of("importing");
    report_summary(call.console, rawlog::import_ulog(o->import), o->import.out);
  };
}

Action declare_bag(CLI::App& app) {
  struct Options {
    rawlog::BagImport import;
    std::string lever_arm;
    std::optional<std::string> gnss_sigma, velocity_sigma;
  };
  const auto o = std::make_shared<Options>();
  app.add_option("bag", o->import.bag, "Bag of ROS 1 (.bag)")->required();
  app.add_option("--imu-topic", o->import.imu_topic,
                 "Of sensor_msgs/Imu; needed if there are several");
  app.add_option("--gnss-topic", o->import.gnss_topic,
                 "Of sensor_msgs/NavSatFix; needed if there are several");
  app.add_option("--velocity-topic", o->import.velocity_topic,
                 "Of geometry_msgs/TwistStamped, east, north, up, at the stamps of the fixes");
  app.add_option("--imu-axes", o->import.imu_axes,
                 "Sensor axes that look forward, right, down; without it x,-y,-z (REP 103)")
      ->delimiter(',');
  app.add_option("--gnss-sigma", o->gnss_sigma,
                 "North, east, down [m], where the messages tell no covariance: X,Y,Z");
  app.add_option("--velocity-sigma", o->velocity_sigma, "The same of velocities [m/s]");
  app.add_option("--lever-arm", o->lever_arm, kLeverArmHelp)->required();
  add_common(app, o->import);
  return [o](Call& call) {
    rawlog::BagImport& import = o->import;
    import.lever_arm = parse_vector3("--lever-arm", o->lever_arm);
    if (o->gnss_sigma) import.gnss_sigma = parse_vector3("--gnss-sigma", *o->gnss_sigma);
    if (o->velocity_sigma) {
      import.velocity_sigma = parse_vector3("--velocity-sigma", *o->velocity_sigma);
    }
    import.progress = call.console.progress_of("importing");
    report_summary(call.console, rawlog::import_bag(import), import.out);
  };
}

/// `rtklib`, `csv` and `nmea` take the same options.
template <class Import>
Action declare_mapped(CLI::App& app, rawlog::ImportSummary (*import)(const Import&),
                      const char* gnss_help, bool needs_mapping = true) {
  struct Options {
    Import import;
    std::optional<std::string> lever_arm;
  };
  const auto o = std::make_shared<Options>();
  app.add_option("--mapping", o->import.mapping,
                 "YAML that names columns, units, axes, clocks and the lever arm")
      ->required(needs_mapping);
  app.add_option("--data", o->import.data_dir,
                 "Folder of the files that the mapping names; without it the mapping's own");
  app.add_option("--imu", o->import.imu, "IMU table, instead of the mapping's");
  app.add_option("--gnss", o->import.gnss, gnss_help);
  app.add_option("--reference", o->import.reference, "Reference table, instead of the mapping's");
  app.add_option("--lever-arm", o->lever_arm, kLeverArmHelp);
  add_common(app, o->import);
  return [o, import](Call& call) {
    if (o->lever_arm) o->import.lever_arm = parse_vector3("--lever-arm", *o->lever_arm);
    o->import.progress = call.console.progress_of("importing");
    report_summary(call.console, import(o->import), o->import.out);
  };
}

std::string mapping_help() {
  rawlog::ImportMapping mapping;
  return describe_config(mapping);
}

}  // namespace

Action declare_import(CLI::App& app) {
  app.require_subcommand(1);
  app.footer(
      "\nExamples:\n"
      "  foucault import i2nav --imu ADIS16465.txt --gnss GNSS_RTK.pos --reference truth.nav \\\n"
      "      --gps-week 2017 --lever-arm -0.073,0.302,0.087 --out trip.rawlog\n"
      "  foucault import rtklib --gnss drive.pos --imu imu.csv --mapping drive.yaml --out "
      "drive.rawlog\n"
      "  foucault import csv --mapping drive.yaml --out drive.rawlog\n"
      "  foucault import nmea --gnss drive.nmea --imu imu.csv --mapping drive.yaml --out "
      "drive.rawlog\n"
      "  foucault import ulog flight.ulg --lever-arm 0.1,0,-0.2 --out flight.rawlog\n"
      "  foucault import bag drive.bag --lever-arm 0.3,0,-0.5 --out drive.rawlog");
  CLI::App* i2nav = app.add_subcommand("i2nav", "Text files of the i2Nav group (.txt, .pos, .nav)");
  CLI::App* rtklib = app.add_subcommand("rtklib", "A solution of RTKLIB (.pos) and an IMU table");
  CLI::App* csv = app.add_subcommand("csv", "Tables in columns, told by a mapping");
  CLI::App* nmea = app.add_subcommand("nmea", "NMEA 0183 of a receiver, and an IMU table");
  CLI::App* ulog = app.add_subcommand("ulog", "A ULog of PX4: IMU and GNSS of an autopilot");
  CLI::App* bag = app.add_subcommand("bag", "A bag of ROS 1: topics of an IMU and a receiver");
  for (CLI::App* format : {i2nav, rtklib, csv, nmea, ulog, bag}) format->fallthrough();
  const Action import_from_i2nav = declare_i2nav(*i2nav);
  const Action import_from_rtklib = declare_mapped<rawlog::RtklibImport>(
      *rtklib, rawlog::import_rtklib, "RTKLIB's .pos, instead of the mapping's");
  const Action import_from_csv = declare_mapped<rawlog::CsvImport>(
      *csv, rawlog::import_csv, "GNSS table, instead of the mapping's");
  const Action import_from_ulog = declare_ulog(*ulog);
  const Action import_from_bag = declare_bag(*bag);
  const Action import_from_nmea = declare_mapped<rawlog::NmeaImport>(
      *nmea, rawlog::import_nmea, "NMEA sentences, instead of the mapping's", false);
  for (CLI::App* format : {rtklib, csv, nmea}) {
    add_help_text(*format, "--help-mapping",
                  "List every key of a mapping, with default and meaning", mapping_help);
  }
  return [=](Call& call) {
    if (i2nav->parsed()) import_from_i2nav(call);
    if (rtklib->parsed()) import_from_rtklib(call);
    if (csv->parsed()) import_from_csv(call);
    if (nmea->parsed()) import_from_nmea(call);
    if (ulog->parsed()) import_from_ulog(call);
    if (bag->parsed()) import_from_bag(call);
  };
}

}  // namespace foucault::app
