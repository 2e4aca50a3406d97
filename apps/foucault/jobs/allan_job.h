#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "foucault/calibration/allan.h"
#include "foucault/calibration/spectrum.h"
#include "settings.h"

namespace foucault::app {

/// Noise of an IMU from the rests in a log.
struct AllanJob {
  std::string log;
  Settings settings;
  std::string out;
  bool report = true;
  std::string command_line;
};

/// A number of a sensor as people know it. No value: the recording does not tell it.
struct AllanValue {
  std::string name, key, unit;
  std::optional<double> value;
  double factor = 1;  ///< one sigma, by which it may be larger or smaller
};

/// One of the two sensors, its three axes together and each alone.
struct AllanSensor {
  struct Fitted {
    std::string name;  ///< "all axes", "x", "y", "z"
    std::vector<int> axes;
    calibration::AllanFit fit;
    std::vector<AllanValue> values;
  };
  std::string name, key;
  std::string unit;          ///< of deviations as they are shown
  double shown = 1;          ///< factor to it
  std::string density_unit;  ///< of spectra
  double density_shown = 1;
  std::array<Fitted, 4> fitted;
  std::vector<calibration::SpectralLine> lines_at_rest, lines_in_motion;
};

struct AllanResult {
  std::string log, out, command_line;
  bool report = true;
  double bias_tau_s = 0;
  int rests = 0;
  calibration::AllanCurve curve;
  calibration::Spectrum at_rest, in_motion;
  std::array<AllanSensor, 2> sensors;  ///< gyroscope, accelerometer
};

/// Writes allan.csv, metrics.json and report/.
/// Throws DataError if the log cannot be read or never rests for ten seconds.
AllanResult allan(const AllanJob& job, Console& console);

/// The same without files, of a log that rests for `least_s` in all; none of one that does not.
std::optional<AllanResult> allan_of_rest(const AllanJob& job, double least_s, Console& console);

std::vector<std::string> summary_lines(const AllanResult& result);

}  // namespace foucault::app
