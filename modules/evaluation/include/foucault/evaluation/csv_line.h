#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace foucault::evaluation {

/// One line of CSV without its end; cells with commas, quotes or line ends are quoted (RFC 4180).
std::string csv_line(const std::vector<std::string>& cells);

/// The inverse, for a line without line ends inside cells; none if its quotes are not closed.
std::optional<std::vector<std::string>> split_csv_line(std::string_view line);

}  // namespace foucault::evaluation
