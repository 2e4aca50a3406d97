#include <fmt/format.h>

#include <algorithm>

#include "canvas.h"
#include "foucault/core/error.h"
#include "layout.h"
#include "panel_painter.h"
#include "png_bytes.h"
#include "renderer_part.h"
#include "style.h"
#include "svg_canvas.h"

namespace foucault::plot {
namespace {

using style::millimetres;

void check_column(const Figure& figure, const Series& series, const std::vector<double>& column,
                  const char* name, bool required) {
  if (column.size() == series.x.size() || (column.empty() && !required)) return;
  throw DataError(fmt::format("figure '{}', series '{}': {} {} values for {} places", figure.name,
                              series.label, column.size(), name, series.x.size()));
}

void check(const Figure& figure, const Series& series) {
  const bool is_band = series.mark == Mark::band;
  check_column(figure, series, series.y, "y", !is_band);
  check_column(figure, series, series.lower, "lower", is_band);
  check_column(figure, series, series.upper, "upper", is_band || !series.lower.empty());
  check_column(figure, series, series.category, "category", !series.categories.empty());
  check_column(figure, series, series.value, "colour", false);
  check_column(figure, series, series.time, "time", false);
  for (const double category : series.category) {
    if (category < 0 || category >= double(series.categories.size())) {
      throw DataError(fmt::format("figure '{}', series '{}': no category {}", figure.name,
                                  series.label, category));
    }
  }
}

void check(const Figure& figure) {
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) check(figure, series);
    if (!panel.heat_map) continue;
    const HeatMap& map = *panel.heat_map;
    if (map.values.size() != map.rows * map.columns) {
      throw DataError(fmt::format("figure '{}': heat map of {} x {} has {} values", figure.name,
                                  map.rows, map.columns, map.values.size()));
    }
  }
}

void paint_titles(const Figure& figure, Surface& canvas) {
  double baseline = style::kOuter + millimetres(3.6);
  TextStyle title{style::kTitlePoints, style::kText};
  title.bold = true;
  canvas.text(figure.title, {style::kOuter, baseline}, title);
  if (!figure.title.empty()) baseline += millimetres(5.2);
  canvas.text(figure.subtitle, {style::kOuter, baseline},
              {style::kSubtitlePoints, style::kSoftText});
}

/// What is drawn is as high as it has to be for its width: a map.
bool has_shape(const Figure& figure) {
  return std::any_of(figure.panels.begin(), figure.panels.end(),
                     [](const Panel& panel) { return panel.equal_aspect; });
}

/// As wide as a column, or as the text if panels stand side by side. What titles say is in a paper
/// said by the caption.
Figure fitted_to_paper(const Figure& figure) {
  constexpr double kLower = 0.8;  // a narrow figure is not to be as high as a wide one
  constexpr double kAround = 35;  // [mm] above and below a map, whatever its width
  const bool is_column = figure.columns <= 1 || figure.panels.size() <= 1;
  Figure fitted = figure;
  fitted.title.clear();
  fitted.subtitle.clear();
  fitted.width_mm = (is_column ? style::kColumnMm : style::kTextWidthMm) / style::kPaperScale;
  const double narrower = fitted.width_mm / figure.width_mm;
  if (is_column && has_shape(figure)) {
    fitted.height_mm = kAround + narrower * (figure.height_mm - kAround);
  } else {
    fitted.height_mm *= is_column ? kLower : narrower;
  }
  return fitted;
}

}  // namespace

class OpencvDrawing final : public Drawing {
 public:
  explicit OpencvDrawing(const Fonts& fonts) : typesetter_(fonts) {}

  std::vector<unsigned char> png(const Figure& figure) override {
    check(figure);
    const Layout layout = lay_out(figure, typesetter_);
    canvas_.clear(layout.page);
    paint(figure, layout, canvas_);
    return to_png(canvas_.image());
  }

  std::string svg(const Figure& figure) override {
    check(figure);
    const Figure fitted = fitted_to_paper(figure);
    const Layout layout = lay_out(fitted, typesetter_);
    SvgCanvas canvas(layout.page, typesetter_);
    paint(fitted, layout, canvas);
    return canvas.svg(style::kPaperScale);
  }

 private:
  static void paint(const Figure& figure, const Layout& layout, Surface& surface) {
    paint_titles(figure, surface);
    layout.legend->draw(surface, {style::kOuter, layout.legend_top});
    for (const PlacedPanel& panel : layout.panels) paint_panel(panel, surface);
  }

  Typesetter typesetter_;
  Canvas canvas_{{}, typesetter_};
};

}  // namespace foucault::plot

extern "C" foucault::plot::Drawing* foucault_renderer_part(const foucault::plot::Fonts& fonts) {
  return new foucault::plot::OpencvDrawing(fonts);
}
