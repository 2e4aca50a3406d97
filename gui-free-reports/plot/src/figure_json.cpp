#include "figure_json.h"

#include <array>
#include <utility>

#include "foucault/core/error.h"

namespace foucault::plot {
namespace {

using Json = nlohmann::ordered_json;

template <class Enum, size_t N>
using Names = std::array<std::pair<Enum, const char*>, N>;

constexpr Names<Mark, 5> kMarks{{{Mark::line, "line"},
                                 {Mark::points, "points"},
                                 {Mark::steps, "steps"},
                                 {Mark::bars, "bars"},
                                 {Mark::band, "band"}}};
constexpr Names<Shape, 10> kShapes{{{Shape::dot, "dot"},
                                    {Shape::ring, "ring"},
                                    {Shape::cross, "cross"},
                                    {Shape::plus, "plus"},
                                    {Shape::triangle, "triangle"},
                                    {Shape::square, "square"},
                                    {Shape::diamond, "diamond"},
                                    {Shape::star, "star"},
                                    {Shape::tick, "tick"},
                                    {Shape::frame, "frame"}}};
constexpr Names<RangeRole, 4> kRoles{{{RangeRole::full, "full"},
                                      {RangeRole::most, "most"},
                                      {RangeRole::typical, "typical"},
                                      {RangeRole::none, "none"}}};
constexpr Names<AxisKind, 4> kAxisKinds{{{AxisKind::linear, "linear"},
                                         {AxisKind::log, "log"},
                                         {AxisKind::duration, "duration"},
                                         {AxisKind::category, "category"}}};
constexpr Names<Direction, 2> kDirections{
    {{Direction::horizontal, "horizontal"}, {Direction::vertical, "vertical"}}};
constexpr Names<Side, 5> kSides{{{Side::left, "left"},
                                 {Side::right, "right"},
                                 {Side::above, "above"},
                                 {Side::below, "below"},
                                 {Side::centre, "centre"}}};
constexpr Names<LegendPlace, 3> kLegendPlaces{
    {{LegendPlace::figure, "figure"}, {LegendPlace::panel, "panel"}, {LegendPlace::none, "none"}}};

template <class Enum, size_t N>
std::string name_of(const Names<Enum, N>& names, Enum value) {
  for (const auto& [key, name] : names) {
    if (key == value) return name;
  }
  return names.front().second;
}

template <class Enum, size_t N>
Enum value_of(const Names<Enum, N>& names, const Json& json) {
  const std::string wanted = json.get<std::string>();
  for (const auto& [key, name] : names) {
    if (wanted == name) return key;
  }
  throw DataError("unknown word '" + wanted + "'");
}

Ink ink_from(const Json& json) { return ink_from_name(json.get<std::string>()); }

Json optional_number(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

std::optional<double> optional_number(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<double>();
}

template <class Item, class Convert>
Json list_to_json(const std::vector<Item>& items, Convert convert) {
  Json json = Json::array();
  for (const Item& item : items) json.push_back(convert(item));
  return json;
}

template <class Convert>
auto list_from_json(const Json& json, Convert convert) {
  std::vector<decltype(convert(json))> items;
  for (const Json& item : json) items.push_back(convert(item));
  return items;
}

Json axis_to_json(const Axis& a) {
  return {{"label", a.label},
          {"unit", a.unit},
          {"kind", name_of(kAxisKinds, a.kind)},
          {"shown_unit", a.shown_unit},
          {"shown_factor", a.shown_factor},
          {"zero_centred", a.zero_centred},
          {"from_zero", a.from_zero},
          {"min", optional_number(a.min)},
          {"max", optional_number(a.max)},
          {"least_span", a.least_span},
          {"categories", a.categories}};
}

Axis axis_from_json(const Json& j) {
  Axis a;
  a.label = j.at("label").get<std::string>();
  a.unit = j.at("unit").get<std::string>();
  a.kind = value_of(kAxisKinds, j.at("kind"));
  a.shown_unit = j.at("shown_unit").get<std::string>();
  a.shown_factor = j.at("shown_factor").get<double>();
  a.zero_centred = j.at("zero_centred").get<bool>();
  a.from_zero = j.at("from_zero").get<bool>();
  a.min = optional_number(j.at("min"));
  a.max = optional_number(j.at("max"));
  a.least_span = j.at("least_span").get<double>();
  a.categories = j.at("categories").get<std::vector<std::string>>();
  return a;
}

Json category_to_json(const Category& c) { return {{"label", c.label}, {"ink", ink_name(c.ink)}}; }

Category category_from_json(const Json& j) {
  return {j.at("label").get<std::string>(), ink_from(j.at("ink"))};
}

Json series_to_json(const Series& s) {
  return {{"label", s.label},
          {"column", s.column},
          {"mark", name_of(kMarks, s.mark)},
          {"ink", ink_name(s.ink)},
          {"shape", name_of(kShapes, s.shape)},
          {"size", s.size},
          {"opacity", s.opacity},
          {"dashed", s.dashed},
          {"in_legend", s.in_legend},
          {"value_labels", s.value_labels},
          {"range_role", name_of(kRoles, s.range_role)},
          {"categories", list_to_json(s.categories, category_to_json)}};
}

Series series_from_json(const Json& j) {
  Series s;
  s.label = j.at("label").get<std::string>();
  s.column = j.at("column").get<std::string>();
  s.mark = value_of(kMarks, j.at("mark"));
  s.ink = ink_from(j.at("ink"));
  s.shape = value_of(kShapes, j.at("shape"));
  s.size = j.at("size").get<double>();
  s.opacity = j.at("opacity").get<double>();
  s.dashed = j.at("dashed").get<bool>();
  s.in_legend = j.at("in_legend").get<bool>();
  s.value_labels = j.at("value_labels").get<bool>();
  s.range_role = value_of(kRoles, j.at("range_role"));
  s.categories = list_from_json(j.at("categories"), category_from_json);
  return s;
}

Json shade_to_json(const Shade& s) {
  return {{"begin", s.begin}, {"end", s.end}, {"label", s.label}, {"ink", ink_name(s.ink)}};
}

Shade shade_from_json(const Json& j) {
  return {j.at("begin").get<double>(), j.at("end").get<double>(), j.at("label").get<std::string>(),
          ink_from(j.at("ink"))};
}

Json line_to_json(const ReferenceLine& l) {
  return {{"direction", name_of(kDirections, l.direction)},
          {"at", l.at},
          {"label", l.label},
          {"ink", ink_name(l.ink)},
          {"dashed", l.dashed}};
}

ReferenceLine line_from_json(const Json& j) {
  return {value_of(kDirections, j.at("direction")), j.at("at").get<double>(),
          j.at("label").get<std::string>(), ink_from(j.at("ink")), j.at("dashed").get<bool>()};
}

Json annotation_to_json(const Annotation& a) {
  return {{"x", a.x},
          {"y", a.y},
          {"text", a.text},
          {"side", name_of(kSides, a.side)},
          {"ink", ink_name(a.ink)}};
}

Annotation annotation_from_json(const Json& j) {
  return {j.at("x").get<double>(), j.at("y").get<double>(), j.at("text").get<std::string>(),
          value_of(kSides, j.at("side")), ink_from(j.at("ink"))};
}

Json heat_map_to_json(const std::optional<HeatMap>& map) {
  if (!map) return {};
  return {{"columns", map->columns}, {"rows", map->rows}};
}

std::optional<HeatMap> heat_map_from_json(const Json& j) {
  if (j.is_null()) return std::nullopt;
  return HeatMap{j.at("columns").get<size_t>(), j.at("rows").get<size_t>(), {}};
}

Json panel_to_json(const Panel& p) {
  return {{"title", p.title},
          {"note", p.note},
          {"x", axis_to_json(p.x)},
          {"y", axis_to_json(p.y)},
          {"colour", axis_to_json(p.colour)},
          {"equal_aspect", p.equal_aspect},
          {"scale_bar", p.scale_bar},
          {"height_share", p.height_share},
          {"legend", name_of(kLegendPlaces, p.legend)},
          {"heat_map", heat_map_to_json(p.heat_map)},
          {"shades", list_to_json(p.shades, shade_to_json)},
          {"series", list_to_json(p.series, series_to_json)},
          {"lines", list_to_json(p.lines, line_to_json)},
          {"annotations", list_to_json(p.annotations, annotation_to_json)}};
}

Panel panel_from_json(const Json& j) {
  Panel p;
  p.title = j.at("title").get<std::string>();
  p.note = j.at("note").get<std::string>();
  p.x = axis_from_json(j.at("x"));
  p.y = axis_from_json(j.at("y"));
  p.colour = axis_from_json(j.at("colour"));
  p.equal_aspect = j.at("equal_aspect").get<bool>();
  p.scale_bar = j.at("scale_bar").get<bool>();
  p.height_share = j.at("height_share").get<double>();
  p.legend = value_of(kLegendPlaces, j.at("legend"));
  p.heat_map = heat_map_from_json(j.at("heat_map"));
  p.shades = list_from_json(j.at("shades"), shade_from_json);
  p.series = list_from_json(j.at("series"), series_from_json);
  p.lines = list_from_json(j.at("lines"), line_from_json);
  p.annotations = list_from_json(j.at("annotations"), annotation_from_json);
  return p;
}

}  // namespace

Json figure_to_json(const Figure& f) {
  return {{"name", f.name},
          {"title", f.title},
          {"subtitle", f.subtitle},
          {"caption", f.caption},
          {"width_mm", f.width_mm},
          {"height_mm", f.height_mm},
          {"columns", f.columns},
          {"share_x", f.share_x},
          {"panels", list_to_json(f.panels, panel_to_json)}};
}

Figure figure_from_json(const Json& j) {
  Figure f;
  f.name = j.at("name").get<std::string>();
  f.title = j.at("title").get<std::string>();
  f.subtitle = j.at("subtitle").get<std::string>();
  f.caption = j.at("caption").get<std::string>();
  f.width_mm = j.at("width_mm").get<double>();
  f.height_mm = j.at("height_mm").get<double>();
  f.columns = j.at("columns").get<int>();
  f.share_x = j.at("share_x").get<bool>();
  f.panels = list_from_json(j.at("panels"), panel_from_json);
  return f;
}

}  // namespace foucault::plot
