#include "arguments.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "foucault/core/error.h"

namespace foucault::app {

Eigen::Vector3d parse_vector3(const std::string& option, const std::string& text) {
  std::istringstream stream(text);
  Eigen::Vector3d v;
  char comma = ',';
  for (int i = 0; i < 3; ++i) {
    if (i > 0 && !(stream >> comma)) comma = '\0';
    if (comma != ',' || !(stream >> v[i]) || !std::isfinite(v[i])) {
      throw UsageError(fmt::format("{} '{}': give three numbers as X,Y,Z", option, text));
    }
  }
  if (!(stream >> std::ws).eof()) {
    throw UsageError(fmt::format("{} '{}': give three numbers as X,Y,Z", option, text));
  }
  return v;
}

}  // namespace foucault::app
