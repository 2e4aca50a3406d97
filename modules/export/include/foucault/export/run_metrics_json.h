#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "foucault/evaluation/run_metrics.h"

namespace foucault::exports {

/// The metrics of a run as metrics.json has them; numbers that do not exist are null.
nlohmann::ordered_json run_metrics_json(
    const evaluation::RunMetrics& metrics,
    const std::vector<evaluation::CalibratedBlock>& calibration);

}  // namespace foucault::exports
