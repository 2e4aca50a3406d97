#pragma once

#include <array>
#include <string>
#include <vector>

#include "foucault/reports/figure.h"
#include "run_data.h"

/// What the figures of a run are built from.
namespace foucault::reports {

using Names = std::array<const char*, 3>;
constexpr Names kNed{"North", "East", "Down"};

Axis time_axis();
Axis value_axis(const std::string& label, const std::string& unit);

/// Outages, and gaps that nobody asked for.
std::vector<Shade> time_shades(const RunData& data);

/// A panel over time, shaded.
Panel time_panel(const RunData& data, const Axis& y);

Series line(const std::string& label, Ink ink, std::vector<double> x, std::vector<double> y);
Series points(const std::string& label, Ink ink, double size, std::vector<double> x,
              std::vector<double> y);

/// Three panels above each other with one x axis.
Figure stacked_figure(const std::string& name, const std::string& title,
                      const std::string& subtitle);

/// ", from 60 s on", if anything is left out.
std::string since(double statistics_from);

}  // namespace foucault::reports
