#pragma once

#include <memory>
#include <string>
#include <vector>

#include "foucault/core/profile.h"
#include "foucault/ekf/ekf.h"
#include "foucault/fgo/batch.h"
#include "foucault/fgo/fgo_options.h"
#include "foucault/navigation/run.h"
#include "foucault/navigation/run_options.h"
#include "foucault/state/interfaces.h"

/// The methods by their names. A new one is a function and a line in methods.cpp.
namespace foucault::methods {

/// What a method is told. run.imu has no default; all else suits a car.
struct MethodOptions {
  navigation::NavigationRunOptions run;
  ekf::EkfOptions ekf;
  fgo::FgoOptions fgo;
  fgo::BatchOptions batch;
  /// Of `batch`: for a log of any length, if its epochs may be gone through twice.
  std::shared_ptr<fgo::BatchPasses> passes;
};

/// The run takes a recording and gives its epochs to `sink`, which must outlive it. Throws
/// UsageError for options that make no sense, naming the key.
using Make = std::unique_ptr<navigation::Run> (*)(const MethodOptions& options, state::Sink& sink);

struct Method {
  std::string name;
  std::string summary;
  Make make;
  Stage per_sample;  ///< what a profile calls the work on every IMU sample
  /// How far its epochs may lag behind the measurements [s]; a smoother's come at the end.
  double keep_references_s = 600;
};

/// In the order shown to users.
const std::vector<Method>& all();

/// Throws UsageError naming the known methods.
const Method& find(const std::string& name);

/// The names, for help: "batch, rts".
std::string names();

}  // namespace foucault::methods
