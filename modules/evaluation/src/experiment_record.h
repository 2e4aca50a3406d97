#pragma once

#include <string>
#include <string_view>

#include "foucault/evaluation/experiment.h"

namespace foucault::evaluation {

/// What tables, figures and scores need of a result, but for its names and the time of the
/// processor. Numbers come back without loss.
std::string content_of(const ExperimentResult& result);

/// Throws store::BytesError.
ExperimentResult result_with(const RunName& name, std::string_view content);

}  // namespace foucault::evaluation
