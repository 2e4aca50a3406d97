#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "arguments.h"
#include "foucault/rawlog/import_bag.h"
#include "foucault/rawlog/import_dataflash.h"
#include "foucault/rawlog/import_ulog.h"
#include "import_formats.h"

/// Logs that hold all sensors.
namespace foucault::app {

/// Logs of autopilots, which know their lever arm.
template <class Import>
std::function<void(Call&)> declare_autopilot(CLI::App& app,
                                             rawlog::ImportSummary (*import)(const Import&),
                                             const char* log_help, const char* parameter,
                                             const char* examples) {
  struct Options {
    Import import;
    std::optional<std::string> lever_arm;
  };
  const auto o = std::make_shared<Options>();
  add_input_option(app, "log", o->import.log, log_help)->required();
  app.add_option("--lever-arm", o->lever_arm,
                 std::string(kLeverArmHelp) + "; without it " + parameter + " of the log");
  add_import_options(app, o->import);
  app.footer(examples);
  return [o, import](Call& call) {
    if (o->lever_arm) o->import.lever_arm = parse_vector3("--lever-arm", *o->lever_arm);
    o->import.progress = call.console.progress_of("importing");
    report_import(call.console, import(o->import), o->import.out);
  };
}

std::function<void(Call&)> declare_import_ulog(CLI::App& app) {
  return declare_autopilot(app, rawlog::import_ulog, "ULog of PX4 (.ulg, or .gz)", "EKF2_GPS_POS",
                           "\nExamples:\n"
                           "  foucault import ulog flight.ulg --out flight.rawlog\n"
                           "  foucault import ulog flight.ulg --lever-arm 0.1,0,-0.2 "
                           "--out flight.rawlog");
}

std::function<void(Call&)> declare_import_dataflash(CLI::App& app) {
  return declare_autopilot(app, rawlog::import_dataflash, "DataFlash log (.bin, .log, or .gz)",
                           "GPS_POS1",
                           "\nExamples:\n"
                           "  foucault import dataflash flight.bin --out flight.rawlog\n"
                           "  foucault import dataflash flight.log --lever-arm 0.1,0,-0.2 "
                           "--out flight.rawlog");
}

std::function<void(Call&)> declare_import_bag(CLI::App& app) {
  struct Options {
    rawlog::BagImport import;
    std::string lever_arm;
    std::optional<std::string> gnss_sigma, velocity_sigma;
  };
  const auto o = std::make_shared<Options>();
  add_input_option(app, "bag", o->import.bag,
                   "Bag of ROS 1, MCAP, or rosbag 2: its folder or a .db3")
      ->required();
  app.add_option("--imu-topic", o->import.imu_topic,
                 "Of sensor_msgs/Imu; needed if there are several");
  app.add_option("--gnss-topic", o->import.gnss_topic,
                 "Of sensor_msgs/NavSatFix, or nmea_msgs/Sentence; needed if there are several");
  app.add_option("--velocity-topic", o->import.velocity_topic,
                 "Of geometry_msgs/TwistStamped, east, north, up, at the stamps of the fixes");
  app.add_option("--imu-axes", o->import.imu_axes,
                 "Sensor axes that look forward, right, down; without it x,-y,-z (REP 103)")
      ->delimiter(',');
  app.add_option("--gnss-sigma", o->gnss_sigma,
                 "North, east, down [m], where the messages tell no covariance: X,Y,Z");
  app.add_option("--velocity-sigma", o->velocity_sigma, "The same of velocities [m/s]");
  app.add_option("--lever-arm", o->lever_arm, kLeverArmHelp)->required();
  add_import_options(app, o->import);
  app.footer(
      "\nExamples:\n"
      "  foucault import bag drive.mcap --lever-arm 0.3,0,-0.5 --out drive.rawlog\n"
      "  foucault import bag drive.bag --imu-topic /imu/data --gnss-topic /fix \\\n"
      "      --gnss-sigma 0.02,0.02,0.04 --lever-arm 0.3,0,-0.5 --out drive.rawlog");
  return [o](Call& call) {
    rawlog::BagImport& import = o->import;
    import.lever_arm = parse_vector3("--lever-arm", o->lever_arm);
    if (o->gnss_sigma) import.gnss_sigma = parse_vector3("--gnss-sigma", *o->gnss_sigma);
    if (o->velocity_sigma) {
      import.velocity_sigma = parse_vector3("--velocity-sigma", *o->velocity_sigma);
    }
    import.progress = call.console.progress_of("importing");
    report_import(call.console, rawlog::import_bag(import), import.out);
  };
}

}  // namespace foucault::app
