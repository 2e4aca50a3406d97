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

/// centre +- 3 sigma.
plot::Series bounds(const std::vector<double>& x, const std::vector<double>& centre,
                    const std::vector<double>& sigma, const std::string& column);

/// Both ends of the band, over the time of `x`.
void add_bounds(const Band& band, const std::string& label, const std::vector<double>& x,
                plot::Panel& panel);

/// Zero if there is none above it.
double largest_finite(const std::vector<double>& values);

/// ", from 60 s on", if anything is left out.
std::string since(double statistics_from);

}  // namespace foucault::content
