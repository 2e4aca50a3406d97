#pragma once

#include <string>
#include <vector>

namespace foucault::evaluation {

/// One line of CSV without its end; cells with commas, quotes or line ends are quoted (RFC 4180).
std::string csv_line(const std::vector<std::string>& cells);

}  // namespace foucault::evaluation
