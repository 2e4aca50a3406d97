#pragma once

#include <memory>
#include <string>
#include <vector>

#include "foucault/core/profile.h"
#include "foucault/state/interfaces.h"
#include "settings.h"

/// The methods that `run` and `evaluate` know. A new one is a function and a line in methods.cpp.
namespace foucault::app {

using EstimatorFactory = std::unique_ptr<state::Estimator> (*)(const Settings& settings,
                                                               const state::Mounting& mounting,
                                                               state::Sink& sink);

struct Method {
  std::string name;
  std::string summary;
  EstimatorFactory make;
  Stage per_sample;  ///< what a profile calls the work on every IMU sample
  /// How far its epochs may lag behind the measurements [s]; a smoother's come at the end.
  double keep_references_s = 600;
};

/// What a user gets who names none: the best there is.
inline const std::string kDefaultMethod = "batch";

/// In the order shown to users.
const std::vector<Method>& methods();

/// The driver of all methods around a navigator of one's own.
std::unique_ptr<state::Estimator> drive(std::unique_ptr<measurement::Navigator> navigator,
                                        const Settings& settings, const state::Mounting& mounting,
                                        state::Sink& sink);

/// Throws UsageError naming the known methods.
const Method& find_method(const std::string& name);

/// The method that a smoother runs forward; empty for one that does not smooth.
std::string forward_method(const std::string& name, const Settings& settings);

/// The names, for help: "refined, rough".
std::string method_names();

}  // namespace foucault::app
