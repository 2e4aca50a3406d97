#pragma once

#include <array>
#include <string>
#include <vector>

#include "foucault/plot/figure.h"
#include "run_data.h"

/// What the figures of a run are built from.
namespace foucault::content {

using Names = std::array<const char*, 3>;
constexpr Names kNed{"North", "East", "Down"};

plot::Axis time_axis();
plot::Axis value_axis(const std::string& label, const std::string& unit);

/// Outages, and gaps that nobody asked for.
std::vector<plot::Shade> time_shades(const RunData& data);

/// A panel over time, shaded.
plot::Panel time_panel(const RunData& data, const plot::Axis& y);

plot::Series line(const std::string& label, plot::Ink ink, std::vector<double> x,
                  std::vector<double> y);
plot::Series points(const std::string& label, plot::Ink ink, double size, std::vector<double> x,
                    std::vector<double> y);

/// Three panels above each other with one x axis.
plot::Figure stacked_figure(const std::string& name, const std::string& title,
                            const std::string& subtitle);

/// ", from 60 s on", if anything is left out.
std::string since(double statistics_from);

}  // namespace foucault::content
