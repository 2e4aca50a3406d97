#pragma once

#include <string>
#include <vector>

#include "foucault/diagnosis/judgement.h"

namespace foucault::app {

/// Findings of `check` for people, and for other programs.
std::string findings_text(const std::vector<diagnosis::Finding>& findings);
std::string findings_json(const std::string& log, const std::vector<diagnosis::Finding>& findings);

/// Subjects of what must be mended before the log is processed.
std::vector<std::string> subjects_to_mend(const std::vector<diagnosis::Finding>& findings);

}  // namespace foucault::app
