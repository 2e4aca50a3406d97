#include "methods.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/ekf/ekf.h"
#include "foucault/ekf/rts.h"
#include "foucault/fgo/batch.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/navigation/smoother.h"

namespace foucault::app {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

/// Where it is not estimated how the IMU sits in the vehicle, wheels are believed only if told so:
/// a degree that is not known is a slip of 2 %.
void without_wheels(measurement::AidOptions& aids) {
  for (std::string* wheels : {&aids.nonholonomic, &aids.wheel_speed})
    if (*wheels == "auto") *wheels = "off";
}

navigation::NavigationRunOptions run_options(const Settings& settings,
                                             const state::Mounting& mounting) {
  navigation::NavigationRunOptions options;
  options.gnss = settings.gnss;
  options.gaps = settings.gaps;
  options.aids = settings.aids;
  if (!settings.calibrate.layout().find(state::block::mounting)) without_wheels(options.aids);
  options.node_interval_s = settings.fgo.node_interval_s;
  options.rate = settings.output.epoch_rate();
  options.imu = settings.imu.noise();
  options.mounting = mounting;
  return options;
}

std::unique_ptr<measurement::Navigator> window(preintegration::PreintegrationModel model,
                                               const Settings& settings) {
  return std::make_unique<fgo::WindowNavigator>(settings.fgo, model, settings.imu.noise(),
                                                settings.calibrate.layout());
}

std::unique_ptr<measurement::Navigator> filter(const Settings& settings) {
  return std::make_unique<ekf::EkfNavigator>(settings.imu.noise(), settings.calibrate.layout(),
                                             settings.ekf);
}

template <preintegration::PreintegrationModel model>
std::unique_ptr<state::Estimator> make_window(const Settings& settings,
                                              const state::Mounting& mounting, state::Sink& sink) {
  return drive(window(model, settings), settings, mounting, sink);
}

std::unique_ptr<state::Estimator> make_ekf(const Settings& settings,
                                           const state::Mounting& mounting, state::Sink& sink) {
  return drive(filter(settings), settings, mounting, sink);
}

std::unique_ptr<state::Estimator> make_rts(const Settings& settings,
                                           const state::Mounting& mounting, state::Sink& sink) {
  alignment::Aligner aligner(settings.alignment, settings.imu.noise(), mounting,
                             settings.calibrate.layout());
  return navigation::make_smoother(
      std::make_unique<ekf::RtsRecorder>(settings.imu.noise(), settings.calibrate.layout(),
                                         settings.ekf),
      std::move(aligner), run_options(settings, mounting), sink, settings.calibrate.layout());
}

/// The forward run of a batch.
std::unique_ptr<measurement::Navigator> first_estimate(const Settings& settings) {
  const std::string& name = settings.batch.start;
  if (name == "refined") return window(preintegration::PreintegrationModel::refined, settings);
  if (name == "rough") return window(preintegration::PreintegrationModel::rough, settings);
  if (name == "full") return window(preintegration::PreintegrationModel::full, settings);
  return filter(settings);
}

std::unique_ptr<state::Estimator> make_batch(const Settings& settings,
                                             const state::Mounting& mounting, state::Sink& sink) {
  alignment::Aligner aligner(settings.alignment, settings.imu.noise(), mounting,
                             settings.calibrate.layout());
  return navigation::make_smoother(
      std::make_unique<fgo::BatchRecorder>(
          first_estimate(settings), settings.fgo, settings.batch.preintegration_model(),
          settings.imu.noise(), settings.calibrate.layout(), settings.passes),
      std::move(aligner), run_options(settings, mounting), sink, settings.calibrate.layout());
}

}  // namespace

std::unique_ptr<state::Estimator> drive(std::unique_ptr<measurement::Navigator> navigator,
                                        const Settings& settings, const state::Mounting& mounting,
                                        state::Sink& sink) {
  alignment::Aligner aligner(settings.alignment, settings.imu.noise(), mounting,
                             settings.calibrate.layout());
  return std::make_unique<navigation::NavigationRun>(std::move(navigator), std::move(aligner),
                                                     run_options(settings, mounting), sink);
}

const std::vector<Method>& methods() {
  static const std::vector<Method> all{
      {"batch",
       "the default: one factor graph over the whole log, from the filter's run forward: every "
       "epoch from all fixes (memory: 6 kB an epoch)",
       make_batch, Stage::propagate, kForever},
      {"rts",
       "the filter forward, then a smoother backward: every epoch from all fixes "
       "(memory: 6 kB an epoch)",
       make_rts, Stage::mechanize, kForever},
      {"ekf", "error-state Kalman filter on a full mechanization (the paper's M0)", make_ekf,
       Stage::mechanize},
      {"refined", "sliding factor graph, preintegration on a rotating Earth (the paper's M1)",
       make_window<preintegration::PreintegrationModel::refined>, Stage::preintegrate},
      {"rough", "the same with the Earth's rotation neglected (the paper's M2)",
       make_window<preintegration::PreintegrationModel::rough>, Stage::preintegrate},
      {"full", "refined with the gravity vector of each place: exact over any distance",
       make_window<preintegration::PreintegrationModel::full>, Stage::preintegrate},
  };
  return all;
}

const Method& find_method(const std::string& name) {
  for (const Method& method : methods()) {
    if (method.name == name) return method;
  }
  throw UsageError(fmt::format("unknown method '{}'; known: {}", name, method_names()));
}

std::string forward_method(const std::string& name, const Settings& settings) {
  if (name == "batch") return settings.batch.start;
  return name == "rts" ? "ekf" : "";
}

std::string method_names() {
  std::string names;
  for (const Method& method : methods()) names += (names.empty() ? "" : ", ") + method.name;
  return names;
}

}  // namespace foucault::app
