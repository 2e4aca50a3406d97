#include "guess_gnss.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/median.h"
#include "foucault/geodesy/local_frame.h"
#include "import_run.h"
#include "table_units.h"

namespace foucault::rawlog {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Horizontal scatter that receivers without corrections have [m].
constexpr double kStandardSigma = 2;

std::vector<double> known_values(const GuessTable& table, size_t column) {
  std::vector<double> known;
  for (const double value : table.columns[column].values) {
    if (std::isfinite(value)) known.push_back(value);
  }
  return known;
}

double largest_of(const GuessTable& table, size_t column) {
  double largest = 0;
  for (const double value : known_values(table, column)) {
    largest = std::max(largest, std::abs(value));
  }
  return largest;
}

/// Columns of numbers that may be latitude and longitude: they move, but over a degree at most,
/// and each step is one that a vehicle can do.
bool moves_like_degrees(const std::vector<double>& values, double most) {
  constexpr double kMostRange = 3, kMostStep = 0.01;
  if (values.size() < 5) return false;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (*high - *low > kMostRange || *high == *low || std::abs(*low) < 1e-3) return false;
  if (std::max(std::abs(*low), std::abs(*high)) > most) return false;
  std::vector<double> steps;
  for (size_t i = 1; i < values.size(); ++i) steps.push_back(std::abs(values[i] - values[i - 1]));
  return *std::max_element(steps.begin(), steps.end()) < kMostStep &&
         *high - *low < kMostStep * 100 && (*high - *low) / std::abs(*low) < 0.05;
}

/// Without names: two columns beside each other that move like degrees; latitude comes first
/// unless it is beyond 90.
std::optional<FixColumns> positions_by_data(const GuessTable& table) {
  for (size_t i = 0; i + 1 < table.columns.size(); ++i) {
    const auto is_plain = [&](size_t c) {
      const GuessColumn& column = table.columns[c];
      return column.kind == CellKind::number && !sensor_of(column.name) &&
             moves_like_degrees(known_values(table, c), 180);
    };
    if (!is_plain(i) || !is_plain(i + 1)) continue;
    const bool exchanged = largest_of(table, i) > 90;
    FixColumns found;
    found.roles["latitude"] = exchanged ? i + 1 : i;
    found.roles["longitude"] = exchanged ? i : i + 1;
    found.remark = {exchanged, exchanged
                                   ? "only a longitude is beyond 90"
                                   : "they move like fixes; which is the latitude is by order"};
    if (i + 2 < table.columns.size() && table.columns[i + 2].kind == CellKind::number) {
      found.roles["height"] = i + 2;
    }
    return found;
  }
  return std::nullopt;
}

/// Without names of headers columns stand in the order of the i2Nav format.
void add_unnamed(const GuessTable& table, FixColumns& columns) {
  if (table.header || !columns.has("height")) return;
  const size_t height = columns.roles.at("height");
  const bool may_be_sigmas = height + 4 == table.columns.size();
  if (!may_be_sigmas) return;
  for (size_t i = 0; i < 3; ++i) {
    const std::vector<double> values = known_values(table, height + 1 + i);
    if (values.empty() || *std::min_element(values.begin(), values.end()) <= 0) return;
  }
  columns.roles["sigma_north"] = height + 1;
  columns.roles["sigma_east"] = height + 2;
  columns.roles["sigma_down"] = height + 3;
  columns.remark = {false, "without names, in the order that is usual"};
}

bool all_positive(const GuessTable& table, size_t column) {
  const std::vector<double> values = known_values(table, column);
  return !values.empty() && *std::min_element(values.begin(), values.end()) > 0;
}

double without_sign_to_degrees(double value, const std::string& unit) {
  if (unit == "rad") return value / kDegree;
  if (unit == "e7") return value * 1e-7;
  if (unit != "ddmm") return value;
  const double whole = std::trunc(value / 100);
  return whole + (value - 100 * whole) / 60;
}

bool has_ddmm(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double v) { return std::fmod(std::abs(v), 100.0) < 60; });
}

/// Of latitude and longitude.
void guess_angle_unit(const GuessTable& table, const FixColumns& columns, PositionMapping& mapping,
                      Remarks& remarks) {
  const size_t latitude = columns.roles.at("latitude");
  const size_t longitude = columns.roles.at("longitude");
  const double largest = std::max(largest_of(table, latitude), largest_of(table, longitude));
  const std::string& named = table.columns[latitude].name.unit;
  Remark& remark = remarks["angle_unit"];
  constexpr double kLargestDdmm = 18060;
  mapping.angle_unit = "deg";
  if (largest > kLargestDdmm) {
    mapping.angle_unit = "e7";
    remark.text = "1e-7 deg, by their size";
  } else if (largest > 360) {
    mapping.angle_unit = "ddmm";
    const bool fits =
        has_ddmm(known_values(table, latitude)) && has_ddmm(known_values(table, longitude));
    remark = {fits, "degrees and minutes, by their size"};
  } else if (named == "rad" ||
             (named != "deg" && largest_of(table, latitude) < kPi / 2 && largest < kPi)) {
    mapping.angle_unit = "rad";
    remark.text = named == "rad" ? "by name" : "in degrees it would be off the coast of Africa";
  } else {
    remark.text = named == "deg" ? "by name" : "by their size";
  }
}

void guess_height(const GuessTable& table, FixColumns& columns, PositionMapping& mapping,
                  Remarks& remarks) {
  mapping.height_unit = "m";
  const bool ellipsoidal = columns.has("height_ellipsoidal");
  const bool msl = columns.has("height_msl");
  for (const char* role : {"height_msl", "height_ellipsoidal"}) {  // the latter if there are both
    if (columns.has(role)) columns.roles["height"] = columns.roles.at(role);
  }
  if (!columns.has("height")) {
    mapping.height_m = 0;
    remarks["height_m"] = {false, "no column of heights; write about how high it is"};
    return;
  }
  const GuessColumn& column = table.columns[columns.roles.at("height")];
  constexpr double kHighest = 20'000;
  const std::vector<double> heights = known_values(table, columns.roles.at("height"));
  const std::string& named = column.name.unit;
  const bool has_unit = named == "cm" || named == "mm" || named == "ft";
  const bool is_large = !heights.empty() && std::abs(median(heights)) > kHighest;
  if (has_unit || is_large) mapping.height_unit = has_unit ? named : "mm";
  if (is_large && !has_unit) remarks["height_unit"] = {false, "too large for metres"};
  mapping.height = msl && !ellipsoidal ? "msl" : "ellipsoidal";
  if (mapping.height == "ellipsoidal") {
    remarks["height"] = {ellipsoidal,
                         ellipsoidal ? "by name" : "nothing tells it; many receivers give msl"};
    return;
  }
  remarks["height"].text = "by name";
  mapping.geoid_separation_m = 0;
  remarks["geoid_separation_m"] = {false, "to be told, e.g. of EGM2008; heights are off by it"};
  if (!columns.has("geoid")) return;
  mapping.geoid_separation_m = median(known_values(table, columns.roles.at("geoid")));
  remarks["geoid_separation_m"] = {true, "median of its column"};
}

void name_role(const GuessTable& table, const FixColumns& columns, PositionMapping& mapping,
               const std::string& role) {
  if (columns.has(role)) mapping.columns[role] = table.columns[columns.roles.at(role)].key;
}

/// Velocities north, east and down or up; all three or none.
bool has_vector(const FixColumns& columns) {
  return columns.has("velocity_north") && columns.has("velocity_east") &&
         (columns.has("velocity_down") || columns.has("velocity_up"));
}

void name_velocity(const GuessTable& table, const FixColumns& columns, PositionMapping& mapping,
                   bool along) {
  if (has_vector(columns)) {
    const char* vertical = columns.has("velocity_down") ? "velocity_down" : "velocity_up";
    for (const char* role : {"velocity_north", "velocity_east", vertical}) {
      name_role(table, columns, mapping, role);
    }
  } else if (along && columns.has("speed") && columns.has("bearing")) {
    name_role(table, columns, mapping, "speed");
    name_role(table, columns, mapping, "bearing");
  }
}

/// Velocity of a row, level where only that is known; none where the table has none.
std::optional<Vector3d> velocity_at(const GuessTable& table, const FixColumns& columns,
                                    size_t row) {
  const auto value = [&](const char* role) {
    return table.columns[columns.roles.at(role)].values[row];
  };
  Vector3d v;
  if (has_vector(columns)) {
    const bool down = columns.has("velocity_down");
    v = {value("velocity_north"), value("velocity_east"),
         down ? value("velocity_down") : -value("velocity_up")};
  } else if (columns.has("speed") && columns.has("bearing")) {
    const double bearing = value("bearing") * kDegree;
    if (value("speed") < 0 || bearing < 0) return std::nullopt;
    v = value("speed") * Vector3d(std::cos(bearing), std::sin(bearing), 0);
  } else {
    return std::nullopt;
  }
  return v.allFinite() ? std::optional(v) : std::nullopt;
}

/// Place of a row in the local frame [m]: north, east, down.
Vector3d place_at(const GuessTable& table, const FixColumns& columns,
                  const PositionMapping& mapping, size_t row, std::optional<Geodetic>& origin) {
  const auto value = [&](const char* role) {
    return table.columns[columns.roles.at(role)].values[row];
  };
  const auto radians = [&](const char* role) {
    const double v = value(role);
    return (v < 0 ? -1 : 1) * without_sign_to_degrees(std::abs(v), mapping.angle_unit) * kDegree;
  };
  if (columns.is_local()) return {value("north"), value("east"), -value("up")};
  const bool has_height = columns.has("height") && std::isfinite(value("height"));
  const double height =
      has_height ? value("height") * unit_of(length_units(), mapping.height_unit).factor : 0;
  const Geodetic place{radians("latitude"), radians("longitude"), height};
  if (!origin) origin = place;
  return geodesy::ned_offset(*origin, place);
}

/// Way between fixes over some seconds beside the velocity in its midst.
struct WaysAndVelocities {
  std::vector<Vector2d> ways, velocities;
};
WaysAndVelocities ways_and_velocities(const FixSeries& fixes) {
  WaysAndVelocities found;
  constexpr double kWindow = 1;
  size_t begin = 0;
  for (size_t i = 0; i < fixes.t.size(); ++i) {
    if (fixes.t[i] - fixes.t[begin] < kWindow) continue;
    const double dt = fixes.t[i] - fixes.t[begin];
    if (dt < 5 * kWindow && i > begin) {
      Vector2d sum = Vector2d::Zero();
      for (size_t k = begin; k <= i; ++k) sum += fixes.velocity[k].head<2>();
      found.ways.emplace_back((fixes.p[i] - fixes.p[begin]).head<2>() / dt);
      found.velocities.emplace_back(sum / static_cast<double>(i - begin + 1));
    }
    begin = i;
  }
  return found;
}

/// Correlation of two sets of vectors.
double correlation(const std::vector<Vector2d>& a, const std::vector<Vector2d>& b, bool exchanged) {
  double ab = 0, aa = 0, bb = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    ab += a[i].dot(exchanged ? Vector2d(b[i].y(), b[i].x()) : b[i]);
    aa += a[i].squaredNorm();
    bb += b[i].squaredNorm();
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

void guess_velocity_unit(const GuessTable& table, const FixColumns& columns,
                         const WaysAndVelocities& ways, GnssMapping& mapping, Remarks& remarks) {
  const char* role = has_vector(columns) ? "velocity_north" : "speed";
  const std::string& named = table.columns[columns.roles.at(role)].name.unit;
  std::vector<double> ratios;
  constexpr double kMoving = 2;
  for (size_t i = 0; i < ways.ways.size(); ++i) {
    const double v = ways.velocities[i].norm();
    if (ways.ways[i].norm() > kMoving && v > 0) ratios.push_back(ways.ways[i].norm() / v);
  }
  const bool known = std::any_of(speed_units().begin(), speed_units().end(),
                                 [&](const Unit& unit) { return unit.name == named; });
  if (known) mapping.velocity_unit = named;
  Remark& remark = remarks["velocity_unit"];
  remark = {known, known ? "by name" : "too slow to tell it by the way between fixes"};
  constexpr size_t kFewest = 5;
  if (ratios.size() < kFewest) return;
  const double ratio = median(ratios);
  const auto off = [&](const Unit& unit) { return std::abs(std::log(ratio / unit.factor)); };
  const Unit& best =
      *std::min_element(speed_units().begin(), speed_units().end(),
                        [&](const Unit& a, const Unit& b) { return off(a) < off(b); });
  constexpr double kFits = 0.2;
  const bool fits = off(best) < kFits;
  if (known && (best.name == named || !fits)) return;
  if (fits) mapping.velocity_unit = best.name;
  remark = {fits && !known, fmt::format("the way between fixes is {:.3g} m/s for 1 here{}", ratio,
                                        known ? "; the name says " + named : std::string{})};
}

// Qualities -------------------------------------------------------------------------------------

bool has_part(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

std::string quality_by_word(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::vector<std::pair<const char*, const char*>> kWords{
      {"float", "float_rtk"},   {"narrow", "fixed_rtk"},  {"fixed", "fixed_rtk"},
      {"rtk", "fixed_rtk"},     {"ppp", "ppp"},           {"diff", "differential"},
      {"dgps", "differential"}, {"sbas", "differential"}, {"waas", "differential"},
      {"none", "none"},         {"no", "none"},           {"invalid", "none"},
      {"insufficient", "none"}, {"single", "single"},     {"3d", "single"},
      {"2d", "single"},         {"gps", "single"}};
  for (const auto& [word, quality] : kWords) {
    if (has_part(text, word)) return quality;
  }
  return "unknown";
}

using Convention = std::map<int, const char*>;

/// How receivers and programs number qualities.
const Convention& convention_of(const ColumnName& name, const std::map<std::string, size_t>& texts,
                                std::string& called) {
  static const Convention kRtklib{{0, "none"},         {1, "fixed_rtk"},    {2, "float_rtk"},
                                  {3, "differential"}, {4, "differential"}, {5, "single"},
                                  {6, "ppp"}};
  static const Convention kNmea{{0, "none"},   {1, "single"},      {2, "differential"},
                                {3, "single"}, {4, "fixed_rtk"},   {5, "float_rtk"},
                                {6, "none"},   {9, "differential"}};
  static const Convention kDimensions{{0, "none"},     {1, "none"},         {2, "single"},
                                      {3, "single"},   {4, "differential"}, {5, "float_rtk"},
                                      {6, "fixed_rtk"}};
  const bool is_q = name.words == "q" || name.words.rfind("q_", 0) == 0;
  const bool is_quality = has_part(name.words, "qual");
  if (is_q && texts.count("4") == 0) {
    called = "as RTKLIB numbers them; NMEA has 1 single, 4 fixed, 5 float";
    return kRtklib;
  }
  if (is_q || is_quality) {
    called = "as NMEA numbers them; RTKLIB has 1 fixed, 2 float, 5 single";
    return kNmea;
  }
  called = "as dimensions of the fix, 3 is 3D; NMEA has 1 single, 4 fixed, 5 float";
  return kDimensions;
}

void guess_quality(const GuessTable& table, const FixColumns& columns, GnssMapping& mapping,
                   Remarks& remarks) {
  constexpr size_t kMostQualities = 20;
  const auto found = columns.roles.find("quality");
  const GuessColumn* column =
      found == columns.roles.end() ? nullptr : &table.columns[found->second];
  if (column == nullptr || column->texts.size() > kMostQualities) {
    mapping.quality = "single";
    remarks["quality"] = {false, "no column tells it"};
    return;
  }
  mapping.columns["quality"] = column->key;
  std::string called = "by the words";
  const Convention& convention = convention_of(column->name, column->texts, called);
  for (const auto& [text, count] : column->texts) {
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    const bool is_number = end != text.c_str() && *end == '\0';
    const auto entry = convention.find(static_cast<int>(std::clamp(number, -1.0, 99.0)));
    mapping.quality_table[text] = !is_number                  ? quality_by_word(text)
                                  : entry == convention.end() ? "unknown"
                                                              : entry->second;
  }
  remarks["quality_table"] = {false, called};
  if (!table.whole) remarks["quality_table"].text += "; there may be more values in the file";
}

void guess_sigmas(const GuessTable& table, const FixColumns& columns, const FixSeries& fixes,
                  GnssMapping& mapping, Remarks& remarks) {
  const auto usable = [&](const char* role) {
    return columns.has(role) && all_positive(table, columns.roles.at(role));
  };
  const bool vector = usable("sigma_north") && usable("sigma_east") && usable("sigma_down");
  const bool horizontal = usable("sigma_horizontal");
  if (vector) {
    for (const char* role : {"sigma_north", "sigma_east", "sigma_down"})
      name_role(table, columns, mapping, role);
  } else if (horizontal) {
    name_role(table, columns, mapping, "sigma_horizontal");
    mapping.columns["sigma_vertical"] =
        table
            .columns[columns.roles.at(usable("sigma_vertical") ? "sigma_vertical"
                                                               : "sigma_horizontal")]
            .key;
  }
  if (vector || horizontal) {
    const std::string& unit =
        table.columns[columns.roles.at(vector ? "sigma_north" : "sigma_horizontal")].name.unit;
    if (unit == "mm" || unit == "cm") mapping.sigma_unit = unit;
    return;
  }
  constexpr double kWorstSigma = 1000;
  const double sigma = std::clamp(std::round(scatter_of(fixes.p)), kStandardSigma, kWorstSigma);
  mapping.sigma_m = {sigma, sigma, 2 * sigma};
  const bool named = columns.has("sigma_north") || columns.has("sigma_horizontal");
  remarks["sigma_m"] = {
      false, named ? "zeros in its columns mean unknown; those of a receiver without "
                     "corrections; RTK has 0.02"
                   : "no column tells; those of a receiver without corrections; RTK has 0.02"};
}

void guess_velocity_sigmas(const GuessTable& table, const FixColumns& columns, GnssMapping& mapping,
                           Remarks& remarks) {
  const bool along = mapping.columns.count("speed") > 0;
  if (!along && mapping.columns.count("velocity_north") == 0) return;
  if (columns.has("sigma_velocity") && all_positive(table, columns.roles.at("sigma_velocity"))) {
    name_role(table, columns, mapping, "sigma_velocity");
    return;
  }
  mapping.velocity_sigma_m_s =
      along ? std::vector<double>{0.5, 0.5, 5} : std::vector<double>{0.3, 0.3, 0.5};
  remarks["velocity_sigma_m_s"] = {false, "no column tells; those of a common receiver"};
}

}  // namespace

std::optional<FixColumns> fix_columns(const GuessTable& table) {
  FixColumns columns;
  for (size_t i = 0; i < table.columns.size(); ++i) {
    const GuessColumn& column = table.columns[i];
    const std::optional<std::string> role = role_of(column.name);
    const bool is_text = column.kind != CellKind::number;
    if (!role || column.filled == 0 ||
        (is_text && *role != "quality" && role->find("hemi") == std::string::npos)) {
      continue;
    }
    columns.roles.emplace(*role, i);
  }
  columns.remark.text = "by name";
  const bool local = columns.has("east") && columns.has("north") && columns.has("up");
  if (!columns.has("latitude") || !columns.has("longitude")) {
    if (local) {
      columns.roles.erase("latitude");
      columns.roles.erase("longitude");
      return columns;
    }
    std::optional<FixColumns> found = positions_by_data(table);
    if (!found) return std::nullopt;
    columns.roles.insert(found->roles.begin(), found->roles.end());
    columns.remark = found->remark;
    add_unnamed(table, columns);
  }
  return columns;
}

std::vector<bool> fix_rows(const GuessTable& table, const FixColumns& columns) {
  const auto& a = table.columns[columns.roles.at(columns.is_local() ? "east" : "latitude")].values;
  const auto& b =
      table.columns[columns.roles.at(columns.is_local() ? "north" : "longitude")].values;
  std::vector<bool> rows(table.rows);
  for (size_t i = 0; i < rows.size(); ++i) {
    rows[i] = std::isfinite(a[i]) && std::isfinite(b[i]) && (a[i] != 0 || b[i] != 0);
  }
  return rows;
}

void guess_positions(const GuessTable& table, FixColumns& columns, PositionMapping& mapping,
                     Remarks& remarks) {
  if (columns.is_local()) {
    for (const char* role : {"east", "north", "up"}) name_role(table, columns, mapping, role);
    remarks["origin"] = {false,
                         "to be told: {latitude_deg: , longitude_deg: , height_m: } of the "
                         "local frame, 0.1 deg and 100 m are enough"};
  } else {
    guess_angle_unit(table, columns, mapping, remarks);
    guess_height(table, columns, mapping, remarks);
    for (const char* role : {"latitude", "longitude", "height", "latitude_minutes",
                             "latitude_seconds", "latitude_hemisphere", "longitude_minutes",
                             "longitude_seconds", "longitude_hemisphere"}) {
      name_role(table, columns, mapping, role);
    }
  }
  remarks["columns"] = columns.remark;
}

FixSeries fix_series(const GuessTable& table, const FixColumns& columns,
                     const PositionMapping& mapping, const std::vector<double>& t) {
  const std::vector<bool> rows = fix_rows(table, columns);
  const bool has_velocity = has_vector(columns) || (columns.has("speed") && columns.has("bearing"));
  FixSeries fixes;
  std::optional<Geodetic> origin;
  Vector2d last = Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  for (size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i] || !std::isfinite(t[i])) continue;
    if (!drop_ahead(fixes.t, t[i], kMostRowsAhead)) continue;
    fixes.p.resize(fixes.t.size());
    if (!fixes.velocity.empty()) fixes.velocity.resize(fixes.t.size());
    if (!fixes.t.empty() && t[i] == fixes.t.back()) continue;
    const Vector3d p = place_at(table, columns, mapping, i, origin);
    if (p.head<2>() == last) continue;
    const std::optional<Vector3d> v = velocity_at(table, columns, i);
    if (has_velocity && !v) continue;
    last = p.head<2>();
    fixes.t.push_back(t[i]);
    fixes.p.push_back(p);
    if (v) fixes.velocity.push_back(*v);
  }
  return fixes;
}

void check_velocities(const GuessTable& table, FixColumns& columns, FixSeries& fixes,
                      const std::vector<double>& t, GnssMapping& mapping, Remarks& remarks) {
  if (fixes.velocity.empty()) return;
  WaysAndVelocities ways = ways_and_velocities(fixes);
  const double straight = correlation(ways.ways, ways.velocities, false);
  const double exchanged = correlation(ways.ways, ways.velocities, true);
  constexpr double kSame = 0.8;
  constexpr size_t kFewest = 20;  // by chance 0.64 of their variance less often than once in 1e8
  if (!columns.is_local() && ways.ways.size() >= kFewest && exchanged > kSame &&
      exchanged - straight > 0.2) {
    std::swap(columns.roles.at("latitude"), columns.roles.at("longitude"));
    std::swap(mapping.columns.at("latitude"), mapping.columns.at("longitude"));
    fixes = fix_series(table, columns, mapping, t);
    ways = ways_and_velocities(fixes);
    remarks["columns"] = {false,
                          "latitude and longitude are exchanged: what is called so moves with the "
                          "other velocity"};
  }
  guess_velocity_unit(table, columns, ways, mapping, remarks);
  name_velocity(table, columns, mapping, true);
  const double factor = unit_of(speed_units(), mapping.velocity_unit).factor;
  for (Vector3d& v : fixes.velocity) v *= factor;
}

void guess_fixes(const GuessTable& table, const FixColumns& columns, const FixSeries& fixes,
                 GnssMapping& mapping, Remarks& remarks) {
  guess_sigmas(table, columns, fixes, mapping, remarks);
  guess_velocity_sigmas(table, columns, mapping, remarks);
  guess_quality(table, columns, mapping, remarks);
}

}  // namespace foucault::rawlog
