#include "figure_json.h"

#include <array>

#include "foucault/plot/json_fields.h"

namespace nlohmann {

template <>
struct adl_serializer<foucault::plot::Ink> {
  template <class Json>
  static void to_json(Json& json, foucault::plot::Ink ink) {
    json = ink_name(ink);
  }
  template <class Json>
  static void from_json(const Json& json, foucault::plot::Ink& ink) {
    ink = foucault::plot::ink_from_name(json.template get<std::string>());
  }
};

}  // namespace nlohmann

namespace foucault::plot {

static auto words_of(Mark) {
  return std::array{std::pair(Mark::line, "line"), std::pair(Mark::points, "points"),
                    std::pair(Mark::steps, "steps"), std::pair(Mark::bars, "bars"),
                    std::pair(Mark::band, "band")};
}

static auto words_of(Dash) {
  return std::array{std::pair(Dash::none, "none"), std::pair(Dash::dashes, "dashes"),
                    std::pair(Dash::long_dashes, "long_dashes"), std::pair(Dash::dots, "dots"),
                    std::pair(Dash::dash_dot, "dash_dot")};
}

static auto words_of(Shape) {
  return std::array{std::pair(Shape::dot, "dot"),           std::pair(Shape::ring, "ring"),
                    std::pair(Shape::cross, "cross"),       std::pair(Shape::plus, "plus"),
                    std::pair(Shape::triangle, "triangle"), std::pair(Shape::square, "square"),
                    std::pair(Shape::diamond, "diamond"),   std::pair(Shape::star, "star"),
                    std::pair(Shape::tick, "tick"),         std::pair(Shape::frame, "frame")};
}

static auto words_of(RangeRole) {
  return std::array{std::pair(RangeRole::full, "full"), std::pair(RangeRole::most, "most"),
                    std::pair(RangeRole::typical, "typical"), std::pair(RangeRole::none, "none")};
}

static auto words_of(AxisKind) {
  return std::array{std::pair(AxisKind::linear, "linear"), std::pair(AxisKind::log, "log"),
                    std::pair(AxisKind::duration, "duration"),
                    std::pair(AxisKind::category, "category"),
                    std::pair(AxisKind::bearing, "bearing")};
}

static auto words_of(Direction) {
  return std::array{std::pair(Direction::horizontal, "horizontal"),
                    std::pair(Direction::vertical, "vertical")};
}

static auto words_of(Side) {
  return std::array{std::pair(Side::left, "left"), std::pair(Side::right, "right"),
                    std::pair(Side::above, "above"), std::pair(Side::below, "below"),
                    std::pair(Side::centre, "centre")};
}

static auto words_of(LegendPlace) {
  return std::array{std::pair(LegendPlace::figure, "figure"),
                    std::pair(LegendPlace::panel, "panel"), std::pair(LegendPlace::none, "none")};
}

static auto fields_of(const Axis*) {
  return std::tuple(std::pair("label", &Axis::label), std::pair("unit", &Axis::unit),
                    std::pair("kind", &Axis::kind), std::pair("shown_unit", &Axis::shown_unit),
                    std::pair("shown_factor", &Axis::shown_factor),
                    std::pair("zero_centred", &Axis::zero_centred),
                    std::pair("from_zero", &Axis::from_zero), std::pair("min", &Axis::min),
                    std::pair("max", &Axis::max), std::pair("least_span", &Axis::least_span),
                    std::pair("categories", &Axis::categories));
}

static auto fields_of(const Category*) {
  return std::tuple(std::pair("label", &Category::label), std::pair("ink", &Category::ink));
}

static auto fields_of(const Series*) {
  return std::tuple(
      std::pair("label", &Series::label), std::pair("column", &Series::column),
      std::pair("mark", &Series::mark), std::pair("ink", &Series::ink),
      std::pair("shape", &Series::shape), std::pair("size", &Series::size),
      std::pair("opacity", &Series::opacity), std::pair("dash", &Series::dash),
      std::pair("in_legend", &Series::in_legend), std::pair("value_labels", &Series::value_labels),
      std::pair("range_role", &Series::range_role), std::pair("categories", &Series::categories));
}

static auto fields_of(const Shade*) {
  return std::tuple(std::pair("begin", &Shade::begin), std::pair("end", &Shade::end),
                    std::pair("label", &Shade::label), std::pair("ink", &Shade::ink));
}

static auto fields_of(const ReferenceLine*) {
  return std::tuple(std::pair("direction", &ReferenceLine::direction),
                    std::pair("at", &ReferenceLine::at), std::pair("label", &ReferenceLine::label),
                    std::pair("ink", &ReferenceLine::ink),
                    std::pair("dashed", &ReferenceLine::dashed));
}

static auto fields_of(const Annotation*) {
  return std::tuple(std::pair("x", &Annotation::x), std::pair("y", &Annotation::y),
                    std::pair("text", &Annotation::text), std::pair("side", &Annotation::side),
                    std::pair("ink", &Annotation::ink));
}

static auto fields_of(const HeatMap*) {
  return std::tuple(std::pair("columns", &HeatMap::columns), std::pair("rows", &HeatMap::rows));
}

static auto fields_of(const Panel*) {
  return std::tuple(
      std::pair("title", &Panel::title), std::pair("note", &Panel::note), std::pair("x", &Panel::x),
      std::pair("y", &Panel::y), std::pair("colour", &Panel::colour),
      std::pair("equal_aspect", &Panel::equal_aspect), std::pair("scale_bar", &Panel::scale_bar),
      std::pair("height_share", &Panel::height_share), std::pair("legend", &Panel::legend),
      std::pair("heat_map", &Panel::heat_map), std::pair("shades", &Panel::shades),
      std::pair("series", &Panel::series), std::pair("lines", &Panel::lines),
      std::pair("annotations", &Panel::annotations));
}

static auto fields_of(const Figure*) {
  return std::tuple(
      std::pair("name", &Figure::name), std::pair("title", &Figure::title),
      std::pair("subtitle", &Figure::subtitle), std::pair("caption", &Figure::caption),
      std::pair("width_mm", &Figure::width_mm), std::pair("height_mm", &Figure::height_mm),
      std::pair("columns", &Figure::columns), std::pair("share_x", &Figure::share_x),
      std::pair("panels", &Figure::panels));
}

nlohmann::ordered_json figure_to_json(const Figure& figure) { return figure; }

Figure figure_from_json(const nlohmann::ordered_json& json) { return json.get<Figure>(); }

}  // namespace foucault::plot
