#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "foucault/plot/figure.h"
#include "run_data.h"
#include "series.h"

/// What the figures of a run are built from.
namespace foucault::content {

using Names = std::array<const char*, 3>;
constexpr Names kNed{"North", "East", "Down"};
/// Three curves of one panel, told apart in grey, too.
constexpr std::array<plot::Ink, 3> kTriadInks{plot::Ink::blue, plot::Ink::vermillion,
                                              plot::Ink::green};
constexpr std::array<plot::Dash, 3> kTriadDashes{plot::Dash::none, plot::Dash::dashes,
                                                 plot::Dash::dash_dot};

/// From the first to the last stamp of anything; of no length without data.
Interval whole_run(const RunData& data);

/// Outages, and gaps that nobody asked for.
std::vector<plot::Shade> time_shades(const RunData& data);

/// A row of a panel whose y axis has names, with bars where something went on.
struct Lane {
  std::string label;
  std::string column;
  plot::Ink ink = plot::Ink::blue;
  std::vector<Interval> intervals = {};
};
/// Above those that are there; strokes where bars would be too short to be seen.
void add_lane(const Lane& lane, plot::Panel& panel);

/// A panel over the time of the whole run, shaded.
plot::Panel time_panel(const RunData& data, const plot::Axis& y);

/// Three panels above each other with one x axis.
plot::Figure stacked_figure(const std::string& name, const std::string& title,
                            const std::string& subtitle, const std::string& caption);

/// centre +- 3 sigma.
plot::Series bounds(const std::vector<double>& x, const std::vector<double>& centre,
                    const std::vector<double>& sigma, const std::string& column);

/// Says in numbers how wide bounds are that are too narrow to be seen, which are taken out of the
/// legend, or cut by the axes; `panel` has its series, the bounds first.
void tell_hidden_bounds(const std::vector<double>& sigma, bool cut, plot::Panel& panel);

/// Both ends of the band, over the time of `x`.
void add_bounds(const Band& band, const std::string& label, const std::vector<double>& x,
                plot::Panel& panel);

/// Zero if there is none above it.
double largest_finite(const std::vector<double>& values);

/// The value that a share of the finite positive ones is below.
std::optional<double> positive_quantile(std::vector<double> values, double share);

/// ", from 60 s on", if anything is left out.
std::string since(double statistics_from);

}  // namespace foucault::content
