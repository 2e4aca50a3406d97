#pragma once

#include <string>

#include "foucault/rawlog/rawlog_info.h"

namespace foucault::app {

/// Contents of a rawlog for people and for programs.
std::string rawlog_text(const rawlog::RawlogInfo& info);
std::string rawlog_json(const rawlog::RawlogInfo& info);

}  // namespace foucault::app
