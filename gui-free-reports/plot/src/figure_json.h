#pragma once

#include <nlohmann/json_fwd.hpp>

#include "foucault/plot/figure.h"

namespace foucault::plot {

/// Everything about a figure but the numbers of its series and heat maps. Each series carries
/// `rows` and, in `columns`, the names of its CSV columns, which the store fills in.
nlohmann::ordered_json figure_to_json(const Figure& figure);

/// The inverse; series have no numbers yet. Throws nlohmann::json::exception or DataError.
Figure figure_from_json(const nlohmann::ordered_json& json);

}  // namespace foucault::plot
