#include "layout.h"

#include <algorithm>
#include <cmath>

#include "foucault/plot/text.h"
#include "style.h"

namespace foucault::plot {
namespace {

using style::millimetres;

constexpr double kSpacePerXTick = millimetres(24);
constexpr double kSpacePerYTick = millimetres(13);
constexpr double kColourBarRoom = millimetres(26);

/// Positions of rows or columns: where each plot begins and how long it is [px].
struct Track {
  double begin = 0;
  double length = 0;
};

std::vector<std::string> parted(const std::string& text, const std::string& between) {
  std::vector<std::string> parts;
  size_t begin = 0;
  for (size_t end = text.find(between); end != std::string::npos; end = text.find(between, begin)) {
    parts.push_back(text.substr(begin, end - begin));
    begin = end + between.size();
  }
  parts.push_back(text.substr(begin));
  return parts;
}

class LayoutMaker {
 public:
  LayoutMaker(const Figure& figure, Typesetter& typesetter)
      : figure_(figure), typesetter_(typesetter) {
    layout_.page = {int(std::lround(millimetres(figure.width_mm))),
                    int(std::lround(millimetres(figure.height_mm)))};
    columns_ = std::clamp(figure.columns, 1, std::max(1, int(figure.panels.size())));
    rows_ = (int(figure.panels.size()) + columns_ - 1) / columns_;
  }

  Layout make() {
    place_header();
    widths_ = plot_widths();
    place_rows();
    const std::vector<double> left = left_margins();
    for (int i = 0; i < int(figure_.panels.size()); ++i) place_panel(i, left);
    return std::move(layout_);
  }

 private:
  int row(int panel) const { return panel / columns_; }
  int column(int panel) const { return panel % columns_; }
  double column_width() const {
    return (layout_.page.width - 2 * style::kOuter - (columns_ - 1) * style::kPanelGap) / columns_;
  }
  double column_begin(int c) const {
    return style::kOuter + c * (column_width() + style::kPanelGap);
  }
  bool has_x_labels(int panel) const {
    return !figure_.share_x || panel + columns_ >= int(figure_.panels.size());
  }

  void place_header() {
    double y = style::kOuter;
    if (!figure_.title.empty()) y += millimetres(5.2);
    if (!figure_.subtitle.empty()) y += millimetres(4.8);
    if (y > style::kOuter) y += millimetres(1.6);
    layout_.legend_top = y;
    std::vector<LegendEntry> entries;
    for (const Panel& panel : figure_.panels) {
      if (panel.legend == LegendPlace::figure) add_missing(legend_entries(panel), entries);
    }
    layout_.legend.emplace(entries, layout_.page.width - 2 * style::kOuter, typesetter_);
    top_ = y + layout_.legend->height() + (entries.empty() ? 0 : millimetres(1.2));
  }

  std::optional<Legend> panel_legend(const Panel& panel) {
    if (panel.legend != LegendPlace::panel) return std::nullopt;
    return Legend(legend_entries(panel), column_width() - millimetres(20), typesetter_);
  }

  /// The note in as few lines as have room, the first of them beside the title; one line even if it
  /// is empty where there is a title.
  std::vector<std::string> note_lines(int i) {
    const Panel& panel = figure_.panels[size_t(i)];
    if (panel.title.empty() && panel.note.empty()) return {};
    constexpr const char* kBetween = " · ";
    const double width = widths_[size_t(column(i))];
    const double title = typesetter_.width(panel.title, style::kAxisPoints, true);
    std::vector<std::string> lines{""};
    for (const std::string& part : parted(panel.note, kBetween)) {
      const std::string longer = joined({lines.back(), part}, kBetween);
      const double taken = lines.size() == 1 && title > 0 ? title + millimetres(3) : 0;
      const bool fits = taken + typesetter_.width(longer, style::kNotePoints) <= width;
      const bool is_first = lines.back().empty() && taken == 0;
      if (fits || is_first) {
        lines.back() = longer;
      } else {
        lines.push_back(part);
      }
    }
    return lines;
  }

  double above(int i) {
    const Panel& panel = figure_.panels[size_t(i)];
    double height = style::kAboveData + style::kHeadLine * double(note_lines(i).size());
    if (const std::optional<Legend> legend = panel_legend(panel)) height += legend->height();
    return height;
  }

  double below(int i) const {
    if (!has_x_labels(i)) return style::kStackedGap;
    const Panel& panel = figure_.panels[size_t(i)];
    const bool has_title = !panel.x.label.empty() || !panel.x.unit.empty();
    const double last = row(i) == rows_ - 1 ? 0 : style::kPanelGap;
    return style::kTickLength + millimetres(5) + (has_title ? millimetres(5) : 0) + last;
  }

  void place_rows() {
    std::vector<double> upper(size_t(rows_), 0), lower(size_t(rows_), 0), share(size_t(rows_), 0);
    for (int i = 0; i < int(figure_.panels.size()); ++i) {
      const size_t r = size_t(row(i));
      upper[r] = std::max(upper[r], above(i));
      lower[r] = std::max(lower[r], below(i));
      share[r] = std::max(share[r], figure_.panels[size_t(i)].height_share);
    }
    double room = layout_.page.height - top_ - style::kOuter;
    double shares = 0;
    for (size_t r = 0; r < size_t(rows_); ++r) {
      room -= upper[r] + lower[r];
      shares += share[r];
    }
    double y = top_;
    for (size_t r = 0; r < size_t(rows_); ++r) {
      const double length = std::max(millimetres(8), room * share[r] / shares);
      row_tracks_.push_back({y + upper[r], length});
      y += upper[r] + length + lower[r];
    }
  }

  Ticks y_ticks(const Panel& panel, double height) const {
    return y_ticks(AxisScale(panel.y, y_span(panel), height, 0), height);
  }
  /// As the height suggests, but at least three labels where round steps allow it.
  static Ticks y_ticks(const AxisScale& scale, double height) {
    const int wanted = std::max(2, int(height / kSpacePerYTick));
    Ticks ticks = scale.ticks(wanted);
    for (int count = wanted + 1; labelled(ticks) < 3 && count <= wanted + 4; ++count) {
      ticks = scale.ticks(count);
    }
    return ticks;
  }

  static size_t labelled(const Ticks& ticks) {
    return size_t(std::count_if(ticks.ticks.begin(), ticks.ticks.end(),
                                [](const Tick& tick) { return !tick.label.empty(); }));
  }

  double label_width(const Ticks& ticks) {
    double width = 0;
    for (const Tick& tick : ticks.ticks) {
      width = std::max(width, typesetter_.width(tick.label, style::kTickPoints));
    }
    return width;
  }

  /// As long as rows are not placed, about that of each: labels of ticks hardly depend on it.
  double length_of_row(int r) const {
    if (!row_tracks_.empty()) return row_tracks_[size_t(r)].length;
    return std::max(millimetres(8), (layout_.page.height - top_) / rows_ - millimetres(15));
  }

  /// Of each column, which what stands above its panels has to fit.
  std::vector<double> plot_widths() {
    std::vector<double> widths = left_margins();
    for (int c = 0; c < columns_; ++c) {
      double& width = widths[size_t(c)];
      width = column_width() - width - right_margin(c);
    }
    return widths;
  }

  std::vector<double> left_margins() {
    std::vector<double> margins(size_t(columns_), 0);
    for (int i = 0; i < int(figure_.panels.size()); ++i) {
      const Panel& panel = figure_.panels[size_t(i)];
      const Ticks ticks = y_ticks(panel, length_of_row(row(i)));
      double margin = label_width(ticks) + style::kTickLength + millimetres(1.2);
      if (!axis_title(panel.y, ticks).empty()) margin += millimetres(5.8);
      margins[size_t(column(i))] = std::max(margins[size_t(column(i))], margin);
    }
    return margins;
  }

  static bool has_colour_bar(const Panel& panel) {
    return panel.heat_map || std::any_of(panel.series.begin(), panel.series.end(),
                                         [](const Series& s) { return !s.value.empty(); });
  }

  double right_margin(int panel_column) const {
    for (int i = panel_column; i < int(figure_.panels.size()); i += columns_) {
      if (has_colour_bar(figure_.panels[size_t(i)])) return kColourBarRoom;
    }
    return millimetres(4);
  }

  static void equalize(Span& x, Span& y, const cv::Rect& plot) {
    const double unit = std::max(x.width() / plot.width, y.width() / plot.height);
    const auto widen = [](Span span, double width) {
      const double more = (width - span.width()) / 2;
      return Span{span.min - more, span.max + more};
    };
    x = widen(x, unit * plot.width);
    y = widen(y, unit * plot.height);
  }

  bool fits(const Ticks& ticks, int width) {
    return 1.35 * label_width(ticks) * double(labelled(ticks)) < width;
  }

  /// As many ticks as have room side by side; three if the usual spacing gives fewer.
  Ticks x_ticks(const AxisScale& scale, int width) {
    const int wanted = std::max(2, int(width / kSpacePerXTick));
    const bool few = labelled(scale.ticks(wanted)) < 3;
    for (int count = wanted + 1; few && count <= wanted + 4; ++count) {
      Ticks ticks = scale.ticks(count);
      if (labelled(ticks) >= 3 && fits(ticks, width)) return ticks;
    }
    for (int count = wanted; count > 1; --count) {
      Ticks ticks = scale.ticks(count);
      if (fits(ticks, width)) return ticks;
    }
    return scale.ticks(1);
  }

  static std::optional<AxisScale> colour_scale(const Panel& panel, const cv::Rect& plot) {
    if (!has_colour_bar(panel)) return std::nullopt;
    Panel values;
    values.y = panel.colour;
    values.series.resize(1);
    if (panel.heat_map) values.series[0].y = panel.heat_map->values;
    for (const Series& series : panel.series) {
      values.series[0].y.insert(values.series[0].y.end(), series.value.begin(), series.value.end());
    }
    return AxisScale(panel.colour, y_span(values), plot.br().y, plot.y);
  }

  /// What the x axis of a panel shows: that of all of its column, if they share it.
  Span shown_x(int i) const {
    if (!figure_.share_x) return x_span(figure_.panels[size_t(i)]);
    Span all = x_span(figure_.panels[size_t(i)]);
    for (int other = column(i); other < int(figure_.panels.size()); other += columns_) {
      const Span span = x_span(figure_.panels[size_t(other)]);
      all = {std::min(all.min, span.min), std::max(all.max, span.max)};
    }
    return all;
  }

  void place_panel(int i, const std::vector<double>& left) {
    const Panel& panel = figure_.panels[size_t(i)];
    const size_t c = size_t(column(i));
    const Track& track = row_tracks_[size_t(row(i))];
    const double begin = column_begin(int(c)) + left[c];
    const double width = column_width() - left[c] - right_margin(int(c));
    const cv::Rect plot(int(std::lround(begin)), int(std::lround(track.begin)),
                        std::max(8, int(std::lround(width))), int(std::lround(track.length)));
    Span across = shown_x(i);
    Span up = y_span(panel);
    if (panel.equal_aspect) equalize(across, up, plot);
    const AxisScale x(panel.x, across, plot.x, plot.br().x);
    const AxisScale y(panel.y, up, plot.br().y, plot.y);
    layout_.panels.push_back({&panel, plot, x, y, x_ticks(x, plot.width), y_ticks(y, plot.height),
                              colour_scale(panel, plot), has_x_labels(i), column_begin(int(c)),
                              panel_legend(panel), note_lines(i)});
  }

  const Figure& figure_;
  Typesetter& typesetter_;
  int columns_ = 1;
  int rows_ = 1;
  double top_ = 0;
  std::vector<Track> row_tracks_;
  std::vector<double> widths_;
  Layout layout_;
};

}  // namespace

Layout lay_out(const Figure& figure, Typesetter& typesetter) {
  return LayoutMaker(figure, typesetter).make();
}

}  // namespace foucault::plot
