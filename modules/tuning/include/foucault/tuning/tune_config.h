#pragma once

#include <functional>
#include <string>
#include <vector>

#include "foucault/core/config.h"
#include "foucault/tuning/grid_search.h"

namespace foucault::tuning {

/// What a search minimizes and how, in the file of a grid.
class TuneOptions : public Configurable {
 public:
  std::string method;                ///< short for methods with one entry
  std::vector<std::string> methods;  ///< each is tuned by itself
  std::string objective = "horizontal";
  double vertical_weight = 1;
  std::string search = "full";

  void fields(ConfigFields& f) override;

  /// From the RMS drifts [m].
  double objective_of(double horizontal_rms, double vertical_rms) const;
  std::string objective_name() const;
};

/// What the file of a search is about: the program's configuration and its methods.
struct Tunable {
  Configurable& base;  ///< takes the file's base
  /// Sets key=value on a copy of the base. Throws UsageError if that makes no sense.
  std::function<void(const std::string& assignment)> try_on;
  std::function<void(const std::string& method)> check_method;  ///< throws UsageError
  std::string method_names;                                     ///< for messages
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
  std::vector<std::string> methods;  ///< at least one, none twice
  ParameterGrid grid;                ///< in the order of the file; numbers ascend

  /// Of a point, an entry an axis; the second as key=value for set_config().
  std::vector<std::string> values(const GridPoint& point) const;
  std::vector<std::string> assignments(const GridPoint& point) const;
};

/// Reads it; `assignments` (key=value) change the base. Every value of the grid is tried on the
/// configuration. Throws DataError if the file cannot be read, UsageError for what is wrong in it,
/// with its line.
TuneConfig load_tune_config(const std::string& path, const std::vector<std::string>& assignments,
                            const Tunable& tunable);

/// The same from text; `origin` stands for the file name in messages.
TuneConfig load_tune_config_text(const std::string& yaml, const std::string& origin,
                                 const std::vector<std::string>& assignments,
                                 const Tunable& tunable);

}  // namespace foucault::tuning
