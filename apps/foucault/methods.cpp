#include "methods.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/ekf/ekf.h"
#include "foucault/ekf/rts_smoother.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/inertial/navigation_run.h"

namespace foucault::app {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

NavigationRunOptions run_options(const Settings& settings) {
  NavigationRunOptions options;
  options.gnss = settings.gnss;
  options.gaps = settings.gaps;
  options.node_interval_s = settings.fgo.node_interval_s;
  options.rate = settings.output.epoch_rate();
  return options;
}

std::unique_ptr<Estimator> drive(std::unique_ptr<Navigator> navigator, const Settings& settings,
                                 const Mounting& mounting, Sink& sink) {
  Aligner aligner(settings.alignment, settings.imu.noise(), mounting);
  return std::make_unique<NavigationRun>(std::move(navigator), std::move(aligner),
                                         run_options(settings), sink);
}

template <PreintegrationModel model>
std::unique_ptr<Estimator> make_window(const Settings& settings, const Mounting& mounting,
                                       Sink& sink) {
  auto navigator = std::make_unique<WindowNavigator>(settings.fgo, model, settings.imu.noise());
  return drive(std::move(navigator), settings, mounting, sink);
}

std::unique_ptr<Estimator> make_ekf(const Settings& settings, const Mounting& mounting,
                                    Sink& sink) {
  auto navigator = std::make_unique<EkfNavigator>(settings.imu.noise(), settings.ekf);
  return drive(std::move(navigator), settings, mounting, sink);
}

std::unique_ptr<Estimator> make_rts(const Settings& settings, const Mounting& mounting,
                                    Sink& sink) {
  Aligner aligner(settings.alignment, settings.imu.noise(), mounting);
  return make_rts_smoother(settings.imu.noise(), settings.ekf, std::move(aligner),
                           run_options(settings), sink);
}

}  // namespace

const std::vector<Method>& methods() {
  static const std::vector<Method> all{
      {"ekf", "error-state Kalman filter on a full mechanization (the paper's M0)", make_ekf},
      {"refined", "factor graph, preintegration on a rotating Earth (the paper's M1)",
       make_window<PreintegrationModel::refined>},
      {"rough", "factor graph, the Earth's rotation neglected (M2)",
       make_window<PreintegrationModel::rough>},
      {"full", "refined with the gravity vector of each place: exact over any distance",
       make_window<PreintegrationModel::full>},
      {"rts", "the filter forward, then a smoother backward: every epoch from all fixes", make_rts,
       kForever},
  };
  return all;
}

const Method& find_method(const std::string& name) {
  for (const Method& method : methods()) {
    if (method.name == name) return method;
  }
  throw UsageError(fmt::format("unknown method '{}'; known: {}", name, method_names()));
}

std::string method_names() {
  std::string names;
  for (const Method& method : methods()) names += (names.empty() ? "" : ", ") + method.name;
  return names;
}

}  // namespace foucault::app
