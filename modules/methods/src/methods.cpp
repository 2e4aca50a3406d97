#include "foucault/methods/methods.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/ekf/rts.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/measurement/navigator.h"
#include "foucault/navigation/smoother.h"
#include "foucault/preintegration/earth.h"

namespace foucault::methods {
namespace {

using measurement::Navigator;
using navigation::Run;
using preintegration::PreintegrationModel;

constexpr double kForever = std::numeric_limits<double>::infinity();

std::unique_ptr<Navigator> filter(const MethodOptions& o) {
  return std::make_unique<ekf::EkfNavigator>(o.run.imu, o.run.layout, o.ekf);
}

std::unique_ptr<Navigator> window(PreintegrationModel model, const MethodOptions& o) {
  return std::make_unique<fgo::WindowNavigator>(o.fgo, model, o.run.imu, o.run.layout);
}

std::unique_ptr<Run> make_ekf(const MethodOptions& o, state::Sink& sink) {
  return std::make_unique<navigation::NavigationRun>(filter(o), o.run, sink);
}

template <PreintegrationModel model>
std::unique_ptr<Run> make_window(const MethodOptions& o, state::Sink& sink) {
  return std::make_unique<navigation::NavigationRun>(window(model, o), o.run, sink);
}

std::unique_ptr<Run> make_rts(const MethodOptions& o, state::Sink& sink) {
  return navigation::make_smoother(
      std::make_unique<ekf::RtsRecorder>(o.run.imu, o.run.layout, o.ekf), o.run, sink);
}

/// The forward run of a batch.
std::unique_ptr<Navigator> first_estimate(const MethodOptions& o) {
  if (o.batch.start == "refined") return window(PreintegrationModel::refined, o);
  if (o.batch.start == "rough") return window(PreintegrationModel::rough, o);
  if (o.batch.start == "full") return window(PreintegrationModel::full, o);
  return filter(o);
}

std::unique_ptr<Run> make_batch(const MethodOptions& o, state::Sink& sink) {
  return navigation::make_smoother(
      std::make_unique<fgo::BatchRecorder>(first_estimate(o), o.fgo, o.batch.preintegration_model(),
                                           o.run.imu, o.run.layout, o.passes),
      o.run, sink);
}

}  // namespace

const std::vector<Method>& all() {
  static const std::vector<Method> methods{
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
       make_window<PreintegrationModel::refined>, Stage::preintegrate},
      {"rough", "the same with the Earth's rotation neglected (the paper's M2)",
       make_window<PreintegrationModel::rough>, Stage::preintegrate},
      {"full", "refined with the gravity vector of each place: exact over any distance",
       make_window<PreintegrationModel::full>, Stage::preintegrate},
  };
  return methods;
}

const Method& find(const std::string& name) {
  for (const Method& method : all()) {
    if (method.name == name) return method;
  }
  throw UsageError(fmt::format("unknown method '{}'; known: {}", name, names()));
}

std::string names() {
  std::string text;
  for (const Method& method : all()) text += (text.empty() ? "" : ", ") + method.name;
  return text;
}

}  // namespace foucault::methods
