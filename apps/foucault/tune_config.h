#pragma once

#include <string>
#include <vector>

#include "foucault/evaluation/grid_search.h"
#include "settings.h"

namespace foucault::app {

/// What a search minimizes and how, in the file of a grid.
class TuneOptions : public Configurable {
 public:
  std::string method;                ///< short for methods with one entry
  std::vector<std::string> methods;  ///< each is tuned by itself
  std::string objective = "horizontal";
  double vertical_weight = 1;
  std::string search = "full";

  void fields(ConfigFields& f) override;

  /// Of either key. Throws UsageError for none, one that is not known or given twice.
  std::vector<std::string> methods_to_tune() const;

  /// From the RMS drifts [m].
  double objective_of(double horizontal_rms, double vertical_rms) const;
};

/// A search, as its file says:
///   base: {imu: {preset: ADIS16465}, outages: {first_s: 300}}   # any keys of the configuration
///   grid:
///     imu.arw_deg_sqrt_h: [0.05, 0.1, 0.2]
///     imu.gyro_bias_deg_h: {from: 1, to: 100, steps: 7, scale: log}
///   method: rough              # or methods: [refined, rough], each by itself
///   objective: horizontal      # | vertical | weighted: horizontal + vertical_weight * vertical
///   search: coarse_to_fine     # | full
struct TuneConfig {
  TuneOptions options;
  Settings base;
  ParameterGrid grid;  ///< in the order of the file; numbers ascend

  /// The base with the values of a point.
  Settings at(const GridPoint& point) const;
};

/// Reads it; `assignments` (key=value) change the base. Every value of the grid is tried on the
/// configuration. Throws DataError if the file cannot be read, UsageError for what is wrong in it,
/// with its line.
TuneConfig load_tune_config(const std::string& path, const std::vector<std::string>& assignments);

/// The same from text; `origin` stands for the file name in messages.
TuneConfig load_tune_config_text(const std::string& yaml, const std::string& origin,
                                 const std::vector<std::string>& assignments);

}  // namespace foucault::app
