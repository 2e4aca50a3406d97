#include "legend.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "foucault/plot/axis_scale.h"

namespace foucault::plot {
namespace {

constexpr double kPoints = 9.5;
constexpr double kRow = 5.0 * kPixelsPerMillimetre;
constexpr double kSample = 5.5 * kPixelsPerMillimetre;
constexpr double kMarkerSample = 3 * kPixelsPerMillimetre;
constexpr double kGap = 1.5 * kPixelsPerMillimetre;
constexpr double kBetween = 5.0 * kPixelsPerMillimetre;
constexpr int kAnywhere = 1 << 20;  // [px]
constexpr double kPatchHeight = 2.6 * kPixelsPerMillimetre;

LegendEntry::Sample sample_of(Mark mark) {
  if (mark == Mark::points) return LegendEntry::Sample::marker;
  if (mark == Mark::band || mark == Mark::bars) return LegendEntry::Sample::patch;
  return LegendEntry::Sample::line;
}

std::vector<LegendEntry> category_entries(const Series& series) {
  const std::set<double> used(series.category.begin(), series.category.end());
  std::vector<LegendEntry> entries;
  for (size_t i = 0; i < series.categories.size(); ++i) {
    if (used.count(static_cast<double>(i)) == 0) continue;
    const Category& category = series.categories[i];
    entries.push_back({category.label, sample_of(series.mark), category.ink, series.shape,
                       series.size, series.opacity, series.dash});
  }
  return entries;
}

bool same(const LegendEntry& a, const LegendEntry& b) {
  return a.label == b.label && a.sample == b.sample && a.ink == b.ink && a.dash == b.dash;
}

bool overlap(const Span& a, double low, double high) { return high >= a.min && low <= a.max; }

/// What a panel shows of its series.
class View {
 public:
  explicit View(const Panel& panel) : x_(x_span(panel)), y_(y_span(panel)) {}

  bool shows(const Series& series) const {
    for (size_t i = 0; i < series.x.size(); ++i) {
      if (overlap(x_, series.x[i], series.x[i]) && shows_y(series, i)) return true;
    }
    return false;
  }
  bool shows(const Shade& shade) const { return overlap(x_, shade.begin, shade.end); }

  /// Something of it is drawn as arrowheads.
  bool cuts(const Series& series) const {
    if (series.mark == Mark::band || series.mark == Mark::bars) return false;
    for (size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
      if (!overlap(x_, series.x[i], series.x[i])) continue;
      if (std::isfinite(series.y[i]) && !overlap(y_, series.y[i], series.y[i])) return true;
    }
    return false;
  }

 private:
  bool shows_y(const Series& series, size_t i) const {
    if (!series.lower.empty() && series.mark == Mark::band) {
      return overlap(y_, series.lower[i], series.upper[i]);
    }
    if (series.mark == Mark::bars) return std::isfinite(series.y[i]);
    return overlap(y_, series.y[i], series.y[i]);
  }

  Span x_, y_;
};

double pen_width(const LegendEntry& entry) { return std::max(1.6, entry.size) * kPixelsPerPoint; }

/// Whole strokes of a pattern, as many as make it known, in widths of the line.
double pattern_length(Dash dash) {
  const std::vector<double> pattern = dash_pattern(dash);
  const double period = std::accumulate(pattern.begin(), pattern.end(), 0.0);
  if (dash == Dash::dots) return 4 * period - pattern.back();
  if (dash == Dash::dash_dot) return period + pattern.front();
  return 2 * period - pattern.back();
}

double sample_width(const LegendEntry& entry) {
  if (entry.sample == LegendEntry::Sample::marker) return kMarkerSample;
  if (entry.sample == LegendEntry::Sample::patch || entry.dash == Dash::none) return kSample;
  return pattern_length(entry.dash) * pen_width(entry) + 2 * entry.size;
}

std::vector<Polyline> line_sample(const LegendEntry& entry, double x, double middle) {
  return {{{x + entry.size, middle}, {x + sample_width(entry) - entry.size, middle}}};
}

void draw_sample(Surface& canvas, const LegendEntry& entry, double x, double middle) {
  const cv::Rect everywhere(0, 0, kAnywhere, kAnywhere);
  const Rgb colour = rgb(entry.ink);
  const cv::Point2d centre(x + kMarkerSample / 2, middle);
  switch (entry.sample) {
    case LegendEntry::Sample::line:
      return canvas.polylines(line_sample(entry, x, middle),
                              {colour, pen_width(entry), std::max(entry.opacity, 0.5), entry.dash},
                              everywhere);
    case LegendEntry::Sample::marker:
      return canvas.markers({centre}, entry.shape, std::max(5.5, entry.size) * kPixelsPerPoint,
                            colour, 1, everywhere);
    case LegendEntry::Sample::patch:
      return canvas.box(
          cv::Rect(int(x), int(middle - kPatchHeight / 2), int(kSample), int(kPatchHeight)), colour,
          entry.opacity);
  }
}

}  // namespace

std::vector<LegendEntry> legend_entries(const Panel& panel) {
  const View view(panel);
  std::vector<LegendEntry> entries;
  for (const Series& series : panel.series) {
    if (!series.in_legend || !view.shows(series)) continue;
    if (!series.categories.empty()) {
      add_missing(category_entries(series), entries);
    } else if (!series.label.empty()) {
      add_missing({{series.label, sample_of(series.mark), series.ink, series.shape, series.size,
                    series.opacity, series.dash}},
                  entries);
    }
  }
  for (const Shade& shade : panel.shades) {
    if (shade.label.empty() || !view.shows(shade)) continue;
    add_missing(
        {{shade.label, LegendEntry::Sample::patch, shade.ink, Shape::square, 1, 0.25, Dash::none}},
        entries);
  }
  const bool cut =
      !panel.equal_aspect && std::any_of(panel.series.begin(), panel.series.end(),
                                         [&](const Series& series) { return view.cuts(series); });
  if (cut) {
    add_missing({{"beyond the axis", LegendEntry::Sample::marker, Ink::gray, Shape::triangle}},
                entries);
  }
  return entries;
}

void add_missing(const std::vector<LegendEntry>& more, std::vector<LegendEntry>& entries) {
  for (const LegendEntry& entry : more) {
    const bool known = std::any_of(entries.begin(), entries.end(),
                                   [&](const LegendEntry& e) { return same(e, entry); });
    if (!known) entries.push_back(entry);
  }
}

Legend::Legend(std::vector<LegendEntry> entries, double width_px, Typesetter& typesetter) {
  double x = 0;
  for (LegendEntry& entry : entries) {
    const double width = sample_width(entry) + kGap + typesetter.width(entry.label, kPoints);
    if (rows_ == 0) rows_ = 1;
    if (x > 0 && x + width > width_px) {
      x = 0;
      ++rows_;
    }
    width_ = std::max(width_, x + width);
    placed_.push_back({std::move(entry), x, rows_ - 1});
    x += width + kBetween;
  }
}

double Legend::height() const { return rows_ * kRow; }

double Legend::width() const { return width_; }

void Legend::draw(Surface& canvas, cv::Point2d top_left) const {
  for (const Placed& placed : placed_) {
    const double x = top_left.x + placed.x;
    const double middle = top_left.y + (placed.row + 0.5) * kRow;
    draw_sample(canvas, placed.entry, x, middle);
    canvas.text(placed.entry.label, {x + sample_width(placed.entry) + kGap, middle},
                {kPoints, rgb(Ink::black), AlignX::left, AlignY::middle});
  }
}

}  // namespace foucault::plot
