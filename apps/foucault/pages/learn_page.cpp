#include "pages/learn_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pages/allan_page.h"
#include "version.h"

namespace foucault::app {
namespace {

std::string verdict(const LearnedValue& value) {
  return value.observable ? "learned" : "not observable in this recording";
}

page::Table values_table(const LearnResult& result) {
  page::Table table{"Noise",
                    "One sigma: the value may be so many times larger or smaller.",
                    false,
                    {"key", "unit", "told", "learned", "one sigma", "verdict"},
                    {}};
  for (const LearnedValue& v : result.values)
    table.rows.push_back({v.key, v.unit, fmt::format("{:.3g}", v.told),
                          fmt::format("{:.3g}", v.value), fmt::format("×/÷ {:.2f}", v.factor),
                          verdict(v)});
  return table;
}

plot::Series points(const char* label, const char* column, plot::Ink ink, plot::Shape shape) {
  plot::Series series{label, column, plot::Mark::points, ink, shape};
  series.size = 6;
  return series;
}

/// Places beside each other, numbers about one on a logarithmic axis.
plot::Panel about_one(const char* label, const char* one) {
  plot::Panel panel;
  panel.x.kind = plot::AxisKind::category;
  panel.y = {label, "", plot::AxisKind::log};
  panel.lines.push_back({plot::Direction::horizontal, 1, one});
  return panel;
}

/// Ratio to what was told, on a logarithmic axis.
plot::Figure values_figure(const LearnResult& result) {
  plot::Figure figure{"learned", "Learned noise, in what was told"};
  figure.caption =
      "Each number divided by what was told (the line at one), with bars of two sigmas. Grey: the "
      "recording does not tell it.";
  figure.height_mm = 90;
  plot::Panel panel = about_one("Learned / told", "as told");
  plot::Series known = points("learned, 2σ", "learned", plot::Ink::blue, plot::Shape::dot);
  plot::Series unknown =
      points("not observable", "not_observable", plot::Ink::gray, plot::Shape::ring);
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    const LearnedValue& v = result.values[i];
    panel.x.categories.push_back(v.name);
    plot::Series& series = v.observable ? known : unknown;
    const double ratio = v.value / v.told;
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(ratio);
    series.lower.push_back(ratio / (v.factor * v.factor));
    series.upper.push_back(ratio * v.factor * v.factor);
  }
  for (plot::Series* series : {&known, &unknown})
    if (!series->x.empty()) panel.series.push_back(std::move(*series));
  figure.panels.push_back(std::move(panel));
  return figure;
}

plot::Figure profile_figure(const LearnResult& result) {
  plot::Figure figure{"likelihood", "Likelihood about the learned noise"};
  figure.caption =
      "Logarithm of the likelihood by factors of each number, all others as learned. It falls by "
      "half at one sigma and by two at two; where it is flat, the recording does not tell.";
  constexpr double kDeepest = -12;
  figure.columns = 3;
  figure.height_mm = 45.0 * static_cast<double>((result.values.size() + 2) / 3);
  for (const LearnedValue& v : result.values) {
    plot::Panel panel;
    panel.title = v.name;
    panel.x = {"Factor", "", plot::AxisKind::log};
    panel.y = {"Log-likelihood", ""};
    panel.y.min = kDeepest;
    panel.y.max = 1;
    panel.legend = plot::LegendPlace::none;
    plot::Series series{"", v.name};
    series.x = v.profile_factors;
    for (const double fall : v.profile) series.y.push_back(fall < kDeepest ? plot::kNoValue : fall);
    panel.series.push_back(std::move(series));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

/// Of two sets of predictions, beside each other.
plot::Figure horizons_figure(const LearnResult& result) {
  plot::Figure figure{"horizons", "Predictions before and after"};
  figure.caption =
      "Squared errors of predicted fixes by their variance, the mean of a row: one is right, more "
      "is overconfident.";
  figure.height_mm = 80;
  plot::Panel panel = about_one("Error² / variance", "right");
  plot::Series before = points("as told", "told", plot::Ink::orange, plot::Shape::ring);
  plot::Series after = points("as learned", "learned", plot::Ink::blue, plot::Shape::dot);
  for (std::size_t i = 0; i < result.after.size(); ++i) {
    const double horizon = result.after[i].horizon_s;
    panel.x.categories.push_back(horizon > 0 ? fmt::format("{:.0f} s", horizon) : "next fix");
    for (plot::Series* series : {&before, &after}) series->x.push_back(static_cast<double>(i));
    before.y.push_back(result.before[i].mean);
    after.y.push_back(result.after[i].mean);
  }
  panel.series = {std::move(before), std::move(after)};
  figure.panels.push_back(std::move(panel));
  return figure;
}

std::string lasting_text(const LearnResult& result) {
  if (!result.lasting) return "Errors of fixes do not last beyond the next one.";
  return fmt::format(
      "Of the errors of fixes {:.2g} sigmas last for about {:.0f} s (a Gauss-Markov process); the "
      "noise of the IMU was learned beside them. No method models that part: gnss.sigma_scale is "
      "what serves methods that take errors for white, and positions are somewhat more certain "
      "than they should be.",
      result.lasting->sigmas, result.lasting->tau_s);
}

}  // namespace

page::ReportPage learn_page(const LearnResult& result) {
  page::ReportPage page;
  page.title = "Noise from the recording";
  page.subtitle = fmt::format("{}", fmt::join(result.logs, ", "));
  const auto told = std::count_if(result.values.begin(), result.values.end(),
                                  [](const LearnedValue& v) { return v.observable; });
  page.key_numbers = {
      {"length", fmt::format("{:.0f}", result.length_s), "s", "that was learned from"},
      {"numbers", fmt::format("{} of {}", told, result.values.size()), "",
       "that the recording tells"}};
  page.sections = {
      {"Noise", {lasting_text(result)}, {values_table(result)}, {values_figure(result)}},
      {"How sure", {}, {}, {profile_figure(result)}},
      {"Predictions", {}, {}, {horizons_figure(result)}}};
  if (result.rest) {
    page.sections.push_back(
        {"At rest",
         {fmt::format("{} rests for {:.0f} s in all. White noise that is lower here than what was "
                      "learned is what driving adds: vibration, and what is not modelled.",
                      result.rest->log, result.rest->curve.length_s())},
         {},
         allan_figures(*result.rest)});
  }
  page.listings = {{"Configuration", result.config}, {"Command", result.command_line}};
  page.footer = fmt::format("foucault {}", kVersion);
  return page;
}

}  // namespace foucault::app
