#include "foucault/plot/figure_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "figure_json.h"
#include "foucault/core/error.h"
#include "foucault/plot/files.h"
#include "foucault/plot/text.h"

namespace foucault::plot {
namespace {

using Json = nlohmann::ordered_json;

// ---- names

/// Units and signs in letters.
std::string spelled(std::string text) {
  constexpr std::pair<std::string_view, std::string_view> kSpelled[] = {
      {"°", "deg"}, {"²", "2"}, {"√", "sqrt"}, {"σ", "sigma"}, {"µ", "u"}, {"%", "percent"}};
  for (const auto& [from, to] : kSpelled) {
    for (size_t at = text.find(from); at != std::string::npos; at = text.find(from)) {
      text.replace(at, from.size(), to);
    }
  }
  return text;
}

/// Lower-case letters, digits and single underscores between them.
std::string slug(const std::string& text) {
  std::string result;
  for (const char c : spelled(text)) {
    const bool capital = c >= 'A' && c <= 'Z';
    if (capital || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      result += capital ? static_cast<char>(c - 'A' + 'a') : c;
    } else if (!result.empty() && result.back() != '_') {
      result += '_';
    }
  }
  if (!result.empty() && result.back() == '_') result.pop_back();
  return result;
}

std::string x_name(const Panel& panel) {
  const std::string name = joined({slug(panel.x.label), slug(panel.x.unit)}, "_");
  return name.empty() ? "x" : name;
}

std::string series_name(const Panel& panel, const Series& series) {
  if (!series.column.empty()) return slug(series.column);
  const std::string name = joined({slug(panel.y.label), slug(series.label)}, "_");
  return name.empty() ? "y" : name;
}

// ---- writing

struct Column {
  std::string name;
  std::vector<std::string> cells;
};

std::string cell_of(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string();
}

/// Text that needs no quotes.
std::string plain(std::string text) {
  for (char& c : text) {
    if (c == ',' || c == '"' || c == '\n') c = ' ';
  }
  return text;
}

std::vector<std::string> numbers(const std::vector<double>& values) {
  std::vector<std::string> cells;
  cells.reserve(values.size());
  for (const double value : values) cells.push_back(cell_of(value));
  return cells;
}

/// Cells of a column, and whether they are names that stand for indices.
struct Cells {
  std::vector<std::string> cells;
  bool named = false;
};

bool are_indices(const std::vector<double>& values, size_t size) {
  return std::all_of(values.begin(), values.end(), [&](double v) {
    return v >= 0 && v < static_cast<double>(size) && v == std::floor(v);
  });
}

/// Indices as the names they stand for, if every one has a name of its own; else numbers.
Cells named_or_numbers(const std::vector<double>& values, const std::vector<std::string>& names) {
  const bool distinct = std::set<std::string>(names.begin(), names.end()).size() == names.size();
  if (names.empty() || !distinct || !are_indices(values, names.size())) {
    return {numbers(values), false};
  }
  Cells result{{}, true};
  for (const double value : values) result.cells.push_back(names[static_cast<size_t>(value)]);
  return result;
}

std::vector<std::string> names_of(const std::vector<Category>& categories) {
  std::vector<std::string> names;
  for (const Category& category : categories) names.push_back(plain(category.label));
  return names;
}

/// Names of the places of a category axis; none for other axes.
std::vector<std::string> names_of(const Axis& axis) {
  std::vector<std::string> names;
  if (axis.kind != AxisKind::category) return names;
  for (const std::string& category : axis.categories) names.push_back(plain(category));
  return names;
}

class CsvWriter {
 public:
  /// The name of a column with these cells: an equal one that is there, or a new one.
  std::string add(const std::string& wanted, std::vector<std::string> cells) {
    std::string name = wanted;
    for (int i = 2; names_.count(name) > 0; ++i) {
      const Column& known = columns_[names_[name]];
      if (known.cells == cells) return name;
      name = wanted + "_" + std::to_string(i);
    }
    names_[name] = columns_.size();
    columns_.push_back({name, std::move(cells)});
    return name;
  }

  std::string text() const {
    std::string csv;
    size_t rows = 0;
    for (const Column& column : columns_) {
      csv += (csv.empty() ? "" : ",") + column.name;
      rows = std::max(rows, column.cells.size());
    }
    csv += '\n';
    for (size_t row = 0; row < rows; ++row) {
      for (size_t c = 0; c < columns_.size(); ++c) {
        if (c > 0) csv += ',';
        if (row < columns_[c].cells.size()) csv += columns_[c].cells[row];
      }
      csv += '\n';
    }
    return csv;
  }

 private:
  std::vector<Column> columns_;
  std::map<std::string, size_t> names_;
};

/// Writes the columns of one series and notes in `json` where they are.
class SeriesWriter {
 public:
  SeriesWriter(CsvWriter& csv, Json& json) : csv_(csv), json_(json) {}

  void write(const Panel& panel, const Series& series) {
    const std::string name = series_name(panel, series);
    const std::string unit = slug(panel.y.unit);
    json_["rows"] = series.x.size();
    json_["columns"] = Json::object();
    add("x", x_name(panel), series.x, names_of(panel.x));
    add("y", joined({name, unit}, "_"), series.y, names_of(panel.y));
    add("lower", joined({name, "lower", unit}, "_"), series.lower, {});
    add("upper", joined({name, "upper", unit}, "_"), series.upper, {});
    add("category", joined({name, "kind"}, "_"), series.category, names_of(series.categories));
    add("time", "time_since_start_s", series.time, {});
    add("value", joined({name, slug(panel.colour.label), slug(panel.colour.unit)}, "_"),
        series.value, {});
  }

 private:
  void add(const char* role, const std::string& name, const std::vector<double>& values,
           const std::vector<std::string>& names) {
    if (values.empty()) return;
    Cells cells = named_or_numbers(values, names);
    const std::string column = csv_.add(name, std::move(cells.cells));
    json_["columns"][role] = {{"column", column}, {"named", cells.named}};
  }

  CsvWriter& csv_;
  Json& json_;
};

std::string category_name(const Axis& axis, size_t i) {
  return i < axis.categories.size() ? plain(axis.categories[i]) : std::to_string(i);
}

void write_heat_map(const Panel& panel, CsvWriter& csv, Json& json) {
  const HeatMap& map = *panel.heat_map;
  std::vector<std::string> across, up;
  for (size_t i = 0; i < map.values.size(); ++i) {
    across.push_back(category_name(panel.x, i % map.columns));
    up.push_back(category_name(panel.y, i / map.columns));
  }
  csv.add(x_name(panel), across);
  csv.add(joined({slug(panel.y.label), slug(panel.y.unit)}, "_"), up);
  const std::string value = joined({slug(panel.colour.label), slug(panel.colour.unit)}, "_");
  json["column"] = csv.add(value.empty() ? "value" : value, numbers(map.values));
}

// ---- reading

class CsvReader {
 public:
  CsvReader(std::string_view text, std::string origin) : origin_(std::move(origin)) {
    size_t line = 0;
    while (!text.empty()) {
      const size_t end = std::min(text.find('\n'), text.size());
      read_line(text.substr(0, end), ++line);
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }

  const std::vector<std::string_view>& column(const std::string& name, size_t rows) const {
    const auto found = index_.find(name);
    if (found == index_.end()) throw DataError(origin_ + ": no column '" + name + "'");
    const std::vector<std::string_view>& cells = columns_[found->second];
    if (cells.size() < rows) {
      throw DataError(fmt::format("{}: {} rows, {} expected; the file is cut short", origin_,
                                  cells.size(), rows));
    }
    return cells;
  }

  std::vector<double> read_numbers(const std::string& name, size_t rows,
                                   const std::vector<std::string>& names) const {
    const std::vector<std::string_view>& cells = column(name, rows);
    std::map<std::string, double, std::less<>> place;
    for (size_t i = 0; i < names.size(); ++i) place.emplace(names[i], double(i));
    std::vector<double> values;
    values.reserve(rows);
    for (size_t row = 0; row < rows; ++row) {
      const auto known = place.find(cells[row]);
      values.push_back(known != place.end() ? known->second : number(cells[row], name, row));
    }
    return values;
  }

 private:
  void read_line(std::string_view line, size_t number) {
    size_t c = 0;
    for (bool more = true; more; ++c) {
      const size_t comma = line.find(',');
      more = comma != std::string_view::npos;
      add_cell(line.substr(0, comma), c, number);
      if (more) line.remove_prefix(comma + 1);
    }
    if (c != columns_.size()) {
      throw DataError(
          fmt::format("{}:{}: {} cells, {} expected", origin_, number, c, columns_.size()));
    }
  }

  void add_cell(std::string_view cell, size_t column, size_t line) {
    if (line == 1) {
      index_[std::string(cell)] = column;
      columns_.emplace_back();
    } else if (column < columns_.size()) {
      columns_[column].push_back(cell);
    }
  }

  double number(std::string_view cell, const std::string& name, size_t row) const {
    if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size()) {
      throw DataError(
          fmt::format("{}:{}: '{}' in column '{}' is not a number", origin_, row + 2, cell, name));
    }
    return value;
  }

  std::string origin_;
  std::map<std::string, size_t> index_;
  std::vector<std::vector<std::string_view>> columns_;
};

void read_series(const Panel& panel, const Json& json, const CsvReader& csv, Series& series) {
  const size_t rows = json.at("rows").get<size_t>();
  const Json& columns = json.at("columns");
  const auto read = [&](const char* role, const std::vector<std::string>& names) {
    if (!columns.contains(role)) return std::vector<double>();
    const Json& column = columns.at(role);
    return csv.read_numbers(column.at("column").get<std::string>(), rows,
                            column.at("named").get<bool>() ? names : std::vector<std::string>());
  };
  series.x = read("x", names_of(panel.x));
  series.y = read("y", names_of(panel.y));
  series.lower = read("lower", {});
  series.upper = read("upper", {});
  series.category = read("category", names_of(series.categories));
  series.time = read("time", {});
  series.value = read("value", {});
}

void read_panel(const Json& json, const CsvReader& csv, Panel& panel) {
  for (size_t s = 0; s < panel.series.size(); ++s) {
    read_series(panel, json.at("series").at(s), csv, panel.series[s]);
  }
  if (!panel.heat_map) return;
  const size_t cells = panel.heat_map->rows * panel.heat_map->columns;
  panel.heat_map->values =
      csv.read_numbers(json.at("heat_map").at("column").get<std::string>(), cells, {});
}

}  // namespace

FigureText to_text(const Figure& figure) {
  Json json = figure_to_json(figure);
  CsvWriter csv;
  for (size_t p = 0; p < figure.panels.size(); ++p) {
    const Panel& panel = figure.panels[p];
    Json& panel_json = json.at("panels").at(p);
    if (panel.heat_map) write_heat_map(panel, csv, panel_json.at("heat_map"));
    for (size_t s = 0; s < panel.series.size(); ++s) {
      SeriesWriter(csv, panel_json.at("series").at(s)).write(panel, panel.series[s]);
    }
  }
  return {csv.text(), json.dump(1) + "\n"};
}

Figure from_text(const FigureText& text, const std::string& origin) {
  try {
    const Json json = Json::parse(text.json);
    Figure figure = figure_from_json(json);
    const CsvReader csv(text.csv, origin + ".csv");
    for (size_t p = 0; p < figure.panels.size(); ++p) {
      read_panel(json.at("panels").at(p), csv, figure.panels[p]);
    }
    return figure;
  } catch (const nlohmann::json::exception& error) {
    throw DataError(origin + ".json: " + error.what());
  }
}

Figure save_figure(const Figure& figure, const std::string& folder, Renderer& renderer) {
  const FigureText text = to_text(figure);
  const std::string stem = folder + "/" + figure.name;
  Figure written = from_text(text, stem);
  const std::vector<unsigned char> png = renderer.png(written);
  write_file(stem + ".csv", text.csv);
  write_file(stem + ".json", text.json);
  write_file(stem + ".png", {reinterpret_cast<const char*>(png.data()), png.size()});
  write_file(stem + ".svg", renderer.svg(written));
  return written;
}

Figure load_figure(const std::string& folder, const std::string& name) {
  const std::string stem = folder + "/" + name;
  return from_text({read_file(stem + ".csv"), read_file(stem + ".json")}, stem);
}

}  // namespace foucault::plot
