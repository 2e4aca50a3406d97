#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "foucault/evaluation/run_metrics.h"
#include "foucault/evaluation/separation.h"

namespace foucault::exports {

/// The metrics of a run as metrics.json has them; numbers that do not exist are null.
nlohmann::ordered_json run_metrics_json(
    const evaluation::RunMetrics& metrics,
    const std::vector<evaluation::CalibratedBlock>& calibration);

/// Root mean squares of smoothed less forward.
nlohmann::ordered_json separation_json(const evaluation::SeparationMetrics& separation);

}  // namespace foucault::exports
