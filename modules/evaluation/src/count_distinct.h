#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "foucault/evaluation/experiment.h"

namespace foucault::evaluation {

/// How many recordings, IMUs or methods there are.
inline std::size_t count_distinct(const std::vector<ExperimentResult>& results,
                                  std::string ExperimentResult::*member) {
  std::set<std::string> names;
  for (const ExperimentResult& result : results) names.insert(result.*member);
  return names.size();
}

}  // namespace foucault::evaluation
