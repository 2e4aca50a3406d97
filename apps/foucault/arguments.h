#pragma once

#include <Eigen/Core>
#include <string>

namespace foucault::app {

/// `X,Y,Z` as given on the command line. Throws UsageError naming `option`.
Eigen::Vector3d parse_vector3(const std::string& option, const std::string& text);

}  // namespace foucault::app
