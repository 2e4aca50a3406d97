#include "foucault/rawlog/import_novatel.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "arguments.h"
#include "import_formats.h"

namespace foucault::app {

std::function<void(Call&)> declare_import_novatel(CLI::App& app) {
  struct Options {
    rawlog::NovatelImport import;
    std::optional<std::string> lever_arm, velocity_sigma;
    std::vector<double> imu_scales;
  };
  const auto o = std::make_shared<Options>();
  add_input_option(app, "log", o->import.log,
                   "Recording of a NovAtel receiver, ASCII or binary, or .gz")
      ->required();
  app.add_option("--lever-arm", o->lever_arm,
                 std::string(kLeverArmHelp) + "; without it ANT1 of INSCONFIG");
  app.add_option("--imu-type", o->import.imu_type,
                 "As INSCONFIG calls it, e.g. ADIS16488; without it the log's");
  app.add_option("--imu-scales", o->imu_scales,
                 "Of a count, for other types: gyroscope [rad], accelerometer [m/s]: G,A")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--imu-axes", o->import.imu_axes,
                 "IMU axes that look forward, right, down; without it RBV of INSCONFIG, else "
                 "y,x,-z")
      ->delimiter(',');
  app.add_option("--velocity-sigma", o->velocity_sigma, "North, east, down [m/s]: X,Y,Z");
  add_import_options(app, o->import);
  app.footer(
      "\nExamples:\n"
      "  foucault import novatel drive.gps --out drive.rawlog\n"
      "  foucault import novatel drive.gps --imu-type ADIS16488 --lever-arm 0.3,0,-0.5 "
      "--out drive.rawlog");
  return [o](Call& call) {
    rawlog::NovatelImport& import = o->import;
    if (o->lever_arm) import.lever_arm = parse_vector3("--lever-arm", *o->lever_arm);
    if (o->velocity_sigma) {
      import.velocity_sigma = parse_vector3("--velocity-sigma", *o->velocity_sigma);
    }
    if (!o->imu_scales.empty()) import.imu_scales = {o->imu_scales[0], o->imu_scales[1]};
    import.progress = call.console.progress_of("importing");
    report_import(call.console, rawlog::import_novatel(import), import.out);
  };
}

}  // namespace foucault::app
