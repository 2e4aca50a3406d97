#pragma once

#include <array>
#include <string>
#include <vector>

#include "foucault/plot/figure.h"
#include "run_data.h"
#include "series.h"

/// What the figures of a run are built from.
namespace foucault::content {

using Names = std::array<const char*, 3>;
constexpr Names kNed{"North", "East", "Down"};

/// Outages, and gaps that nobody asked for.
std::vector<plot::Shade> time_shades(const RunData& data);

/// A panel over time, shaded.
plot::Panel time_panel(const RunData& data, const plot::Axis& y);

/// Three panels above each other with one x axis.
plot::Figure stacked_figure(const std::string& name, const std::string& title,
                            const std::string& subtitle, const std::string& caption);

/// ", from 60 s on", if anything is left out.
std::string since(double statistics_from);

}  // namespace foucault::content
