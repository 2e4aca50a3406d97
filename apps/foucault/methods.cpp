#include "methods.h"

namespace foucault::app {
namespace {

/// Where it is not estimated how the IMU sits in the vehicle, wheels are believed only if told so:
/// a degree that is not known is a slip of 2 %.
void without_wheels(measurement::AidOptions& aids) {
  for (std::string* wheels : {&aids.nonholonomic, &aids.wheel_speed})
    if (*wheels == "auto") *wheels = "off";
}

}  // namespace

methods::MethodOptions method_options(const Settings& settings, const state::Mounting& mounting) {
  methods::MethodOptions options;
  navigation::NavigationRunOptions& run = options.run;
  run.gnss = settings.gnss;
  run.gaps = settings.gaps;
  run.aids = settings.aids;
  run.layout = settings.calibrate.layout();
  if (!run.layout.find(state::block::mounting)) without_wheels(run.aids);
  if (!run.layout.find(state::block::baseline_heading) && run.aids.heading == "auto")
    run.aids.heading = "off";  // nobody mounts antennas to the tenth of a degree
  run.node_interval_s = settings.fgo.node_interval_s;
  run.rate = settings.output.epoch_rate();
  run.imu = settings.imu.noise();
  run.mounting = mounting;
  run.alignment = settings.alignment;
  options.ekf = settings.ekf;
  options.fgo = settings.fgo;
  options.batch = settings.batch;
  options.passes = settings.passes;
  return options;
}

std::string forward_method(const std::string& name, const Settings& settings) {
  if (name == "batch") return settings.batch.start;
  return name == "rts" ? "ekf" : "";
}

}  // namespace foucault::app
