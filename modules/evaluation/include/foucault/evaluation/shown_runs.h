#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "foucault/evaluation/experiment.h"

namespace foucault::evaluation {

/// Of which runs reports draw errors over time and maps: the first shift of each recording (of
/// each IMU's first recording, if there are several IMUs), of the first few recordings.
class ShownRuns {
 public:
  explicit ShownRuns(bool several_imus) : by_imu_(several_imus) {}

  /// The number of the figure that a run is drawn in, if any; to be asked in the order of the runs.
  std::optional<std::size_t> place(const RunName& run);

 private:
  bool by_imu_;
  std::vector<RunName> firsts_;
};

}  // namespace foucault::evaluation
