#include "live_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "foucault/core/time.h"
#include "foucault/plot/axis_scale.h"

namespace foucault::page {

using namespace plot;

namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMostRows = 2000;  // of a series
constexpr uint32_t kGap = 0xffffff;
constexpr uint32_t kHighest = 0xfffffe;

// ---- numbers

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Three bytes are four digits of base 64.
void append_code(uint32_t code, std::string& text) {
  for (const int shift : {18, 12, 6, 0}) text += kDigits[(code >> shift) & 63];
}

Span finite_range(const std::vector<double>& values) {
  Span range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range.min = std::min(range.min, value);
    range.max = std::max(range.max, value);
  }
  return range.max < range.min ? Span{0, 0} : range;
}

std::string encoded(const std::vector<double>& values, const Span& range) {
  std::string text;
  text.reserve(4 * values.size());
  const double scale = range.width() > 0 ? kHighest / range.width() : 0;
  for (const double value : values) {
    const bool is_gap = !std::isfinite(value);
    append_code(is_gap ? kGap : static_cast<uint32_t>(std::lround((value - range.min) * scale)),
                text);
  }
  return text;
}

/// Columns of the page, equal ones once.
class ColumnPool {
 public:
  size_t place(const std::vector<double>& values) {
    const Span range = finite_range(values);
    const auto [found, is_new] =
        places_.try_emplace({range.min, range.max, encoded(values, range)}, places_.size());
    if (is_new) columns_.push_back({std::get<2>(found->first), range.min, range.max});
    return found->second;
  }
  const Json& columns() const { return columns_; }

 private:
  std::map<std::tuple<double, double, std::string>, size_t> places_;
  Json columns_ = Json::array();
};

// ---- thinning

/// The rows of [begin, end) that hold the ends of it, an extreme of a column, or a gap.
void keep_of(const std::vector<const std::vector<double>*>& columns, size_t begin, size_t end,
             std::set<size_t>& rows) {
  rows.insert({begin, end - 1});
  for (const std::vector<double>* column : columns) {
    size_t least = begin, most = begin;
    for (size_t i = begin; i < end; ++i) {
      const double value = (*column)[i];
      if (!std::isfinite(value)) rows.insert(i);
      if (!(value >= (*column)[least])) least = i;
      if (!(value <= (*column)[most])) most = i;
    }
    rows.insert({least, most});
  }
}

/// Rows to draw of a series, in order; empty: all.
std::vector<size_t> thinned_rows(const Series& series) {
  const size_t size = series.x.size();
  if (size <= kMostRows) return {};
  std::vector<const std::vector<double>*> columns;
  for (const std::vector<double>* column : {&series.y, &series.lower, &series.upper}) {
    if (!column->empty()) columns.push_back(column);
  }
  const size_t buckets = kMostRows / (2 + 2 * columns.size());
  std::set<size_t> rows;
  for (size_t b = 0; b < buckets; ++b) {
    keep_of(columns, b * size / buckets, (b + 1) * size / buckets, rows);
  }
  return {rows.begin(), rows.end()};
}

std::vector<double> taken(const std::vector<double>& values, const std::vector<size_t>& rows) {
  if (rows.empty()) return values;
  std::vector<double> result;
  result.reserve(rows.size());
  for (const size_t row : rows) result.push_back(values[row]);
  return result;
}

// ---- the look

constexpr const char* kMarks[] = {"line", "points", "steps", "bars", "band"};
constexpr const char* kDashes[] = {"none", "dashes", "long_dashes", "dots", "dash_dot"};
constexpr const char* kShapes[] = {"dot",    "ring",    "cross", "plus", "triangle",
                                   "square", "diamond", "star",  "tick", "frame"};
constexpr const char* kKinds[] = {"linear", "log", "duration", "category", "bearing"};
constexpr const char* kSides[] = {"left", "right", "above", "below", "centre"};

template <size_t N, class Enum>
const char* word(const char* const (&words)[N], Enum value) {
  return words[static_cast<size_t>(value)];
}

Json axis_json(const Axis& axis, const Span& range) {
  Json json{{"label", axis.label},
            {"unit", shown_unit(axis)},
            {"factor", axis.shown_factor},
            {"kind", word(kKinds, axis.kind)},
            {"range", {range.min, range.max}}};
  if (axis.kind == AxisKind::category) json["names"] = axis.categories;
  return json;
}

Json series_json(const Series& series, ColumnPool& pool) {
  Json json{{"label", series.label},
            {"mark", word(kMarks, series.mark)},
            {"ink", ink_name(series.ink)},
            {"shape", word(kShapes, series.shape)},
            {"size", series.size},
            {"opacity", series.opacity},
            {"dash", word(kDashes, series.dash)},
            {"legend", series.in_legend}};
  const std::vector<size_t> rows = thinned_rows(series);
  for (const auto& [name, column] :
       {std::pair{"x", &series.x}, std::pair{"y", &series.y}, std::pair{"lower", &series.lower},
        std::pair{"upper", &series.upper}, std::pair{"category", &series.category},
        std::pair{"time", &series.time}}) {
    if (!column->empty()) json[name] = pool.place(taken(*column, rows));
  }
  if (series.categories.empty()) return json;
  json["categories"] = Json::array();
  for (const Category& category : series.categories) {
    json["categories"].push_back({category.label, ink_name(category.ink)});
  }
  return json;
}

Json panel_json(const Panel& panel, ColumnPool& pool) {
  Json json{{"title", panel.title},
            {"note", panel.note},
            {"x", axis_json(panel.x, x_span(panel))},
            {"y", axis_json(panel.y, y_span(panel))},
            {"equal", panel.equal_aspect},
            {"share", panel.height_share}};
  for (const char* list : {"shades", "series", "lines", "annotations"}) json[list] = Json::array();
  for (const Shade& s : panel.shades) {
    json["shades"].push_back({s.begin, s.end, s.label, ink_name(s.ink)});
  }
  for (const Series& s : panel.series) json["series"].push_back(series_json(s, pool));
  for (const ReferenceLine& l : panel.lines) {
    json["lines"].push_back(
        {l.direction == Direction::horizontal, l.at, l.label, ink_name(l.ink), l.dashed});
  }
  for (const Annotation& a : panel.annotations) {
    json["annotations"].push_back({a.x, a.y, a.text, word(kSides, a.side), ink_name(a.ink)});
  }
  return json;
}

bool is_coloured_by_value(const Panel& panel) {
  return panel.heat_map || std::any_of(panel.series.begin(), panel.series.end(), [](const auto& s) {
           return !s.value.empty() || s.shape == Shape::frame;
         });
}

Json figure_json(const Figure& figure, ColumnPool& pool) {
  Json json{{"title", figure.title},     {"width", figure.width_mm},  {"height", figure.height_mm},
            {"columns", figure.columns}, {"share_x", figure.share_x}, {"panels", Json::array()}};
  for (const Panel& panel : figure.panels) json["panels"].push_back(panel_json(panel, pool));
  return json;
}

Json inks_json() {
  Json json = Json::object();
  for (int i = 0; i <= static_cast<int>(Ink::yellow); ++i) {
    const Rgb c = rgb(static_cast<Ink>(i));
    json[std::string(ink_name(static_cast<Ink>(i)))] = "rgb(" + std::to_string(c.red) + "," +
                                                       std::to_string(c.green) + "," +
                                                       std::to_string(c.blue) + ")";
  }
  return json;
}

/// "<" must not end the script that holds it.
std::string within_html(std::string json) {
  for (size_t at = json.find('<'); at != std::string::npos; at = json.find('<', at)) {
    json.replace(at, 1, "\\u003c");
  }
  return json;
}

}  // namespace

std::string live_data(const ReportPage& page) {
  Json json = Json::object();
  if (page.start_ns) {
    json["start_ms"] = static_cast<double>(*page.start_ns) * 1e-6;
    json["gps_second"] = static_cast<double>(unix_to_gps(*page.start_ns).tow_ns) * 1e-9;
  }
  json["inks"] = inks_json();
  ColumnPool pool;
  Json figures = Json::object();
  for (const Section& section : page.sections) {
    for (const Figure& figure : section.figures) {
      const bool live =
          !figure.panels.empty() &&
          std::none_of(figure.panels.begin(), figure.panels.end(), is_coloured_by_value);
      if (live) figures[figure.name] = figure_json(figure, pool);
    }
  }
  json["columns"] = pool.columns();
  json["figures"] = std::move(figures);
  return within_html(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace foucault::page
