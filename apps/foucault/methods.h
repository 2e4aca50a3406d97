#pragma once

#include <string>

#include "foucault/methods/methods.h"
#include "settings.h"

/// How `run` and `evaluate` use the methods.
namespace foucault::app {

/// What a user gets who names none: the best there is.
inline const std::string kDefaultMethod = "batch";

/// What the configuration tells the methods, and the log of its IMU.
methods::MethodOptions method_options(const Settings& settings, const state::Mounting& mounting);

/// The method that a smoother runs forward; empty for one that does not smooth.
std::string forward_method(const std::string& name, const Settings& settings);

}  // namespace foucault::app
