#include "position_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "foucault/core/constants.h"
#include "foucault/core/median.h"

namespace foucault::rawlog {

namespace {

constexpr double kTurn = 360;  ///< [deg]

/// The numbers of one column.
struct FirstNumbers {
  std::vector<double> values;  ///< without sign
  double least = 0, most = 0;  ///< with it
  bool whole = true;           ///< none has decimals
  size_t digits = 0;           ///< before the point, if they are as many in all; else 0

  bool empty() const { return values.empty(); }
  double usual() const { return empty() ? 0 : median(values); }
  double largest() const { return std::max(std::abs(least), std::abs(most)); }
  template <class Fits>
  bool all(Fits fits) const {
    return !empty() && std::all_of(values.begin(), values.end(), fits);
  }
};

void add_cell(FirstNumbers& numbers, std::string_view cell) {
  const std::optional<CoordinateText> found = coordinate_of(cell);
  if (!found || found->count != 1) return;
  const double value = found->negative ? -found->parts[0] : found->parts[0];
  const size_t first = std::min(cell.find_first_of("0123456789"), cell.size());
  const size_t digits = cell.substr(first).find_first_not_of("0123456789");
  const size_t before = std::min(digits, cell.size() - first);
  numbers.least = numbers.empty() ? value : std::min(numbers.least, value);
  numbers.most = numbers.empty() ? value : std::max(numbers.most, value);
  numbers.digits = numbers.empty() || numbers.digits == before ? before : 0;
  numbers.whole = numbers.whole && cell.find_first_of(".eE") == std::string_view::npos;
  numbers.values.push_back(found->parts[0]);
}

/// What positions are made of.
struct FirstPositions {
  FirstNumbers latitude, longitude, height, bearing;
};

void add_role(const Columns& columns, const char* role, const Row& row, FirstNumbers& numbers) {
  const std::optional<size_t> column = columns.find(role);
  if (column && *column < row.size() && !row.is_blank(*column)) {
    add_cell(numbers, row.text(*column));
  }
}

FirstPositions first_positions(const PositionMapping& mapping, const std::string& section,
                               const Roles& roles, const std::string& path) {
  constexpr int kRows = 5000;
  TextTable table = open_mapped_table(path);
  Columns columns(mapping, table, section, roles);
  FirstPositions first;
  for (int i = 0; i < kRows; ++i) {
    const Row* row = table.next();
    if (row == nullptr) break;
    add_role(columns, "latitude", *row, first.latitude);
    add_role(columns, "longitude", *row, first.longitude);
    add_role(columns, "height", *row, first.height);
    add_role(columns, "bearing", *row, first.bearing);
  }
  return first;
}

/// Degrees like that lie in the open sea where the Greenwich meridian meets the equator.
bool are_radians(const FirstNumbers& latitude, const FirstNumbers& longitude) {
  constexpr double kAtOrigin = 0.05;
  constexpr double kWidest = 0.03;
  const auto near = [](const FirstNumbers& n) { return n.most - n.least < kWidest; };
  return !latitude.whole && !longitude.whole && latitude.largest() < kPi / 2 &&
         longitude.largest() <= kPi && near(latitude) && near(longitude) &&
         std::max(latitude.largest(), longitude.largest()) > kAtOrigin;
}

bool minutes_fit(double value) { return std::fmod(value, 100) < 60; }
bool seconds_fit(double value) {
  return minutes_fit(value) && minutes_fit(std::trunc(value / 100));
}

std::string angle_unit(const FirstNumbers& latitude, const FirstNumbers& longitude) {
  constexpr double kLargestDdmm = 18060;
  constexpr double kLargestDdmmss = 1806060;
  if (latitude.empty() || longitude.empty()) return "deg";
  const bool fits = latitude.all(minutes_fit) && longitude.all(minutes_fit);
  if (fits && latitude.digits == 4 && longitude.digits == 5) return "ddmm";
  const double larger = std::max(latitude.usual(), longitude.usual());
  if (larger <= kTurn) return are_radians(latitude, longitude) ? "rad" : "deg";
  if (latitude.whole && longitude.whole) return larger > kLargestDdmmss ? "e7" : "deg";
  if (larger <= kLargestDdmm) return fits ? "ddmm" : "deg";
  const bool packed = latitude.all(seconds_fit) && longitude.all(seconds_fit);
  return larger <= kLargestDdmmss && packed ? "ddmmss" : "deg";
}

}  // namespace

std::vector<std::string> find_units(PositionMapping& mapping, std::string* bearing_unit,
                                    const std::string& section, const Roles& roles,
                                    const std::string& path) {
  constexpr double kHighest = 20'000;  // [m]
  const FirstPositions first = first_positions(mapping, section, roles, path);
  std::vector<std::string> notices;
  const auto put = [&](std::string& unit, const std::string& found, const std::string& usual,
                       const char* what, const char* key) {
    if (unit != "auto") return;
    unit = found;
    if (found == usual) return;
    notices.push_back(fmt::format("{}: its {} are read in {}; if that is wrong, give {}.{}", path,
                                  what, found, section, key));
  };
  const bool columns = mapping.columns.count("latitude_minutes") > 0;
  put(mapping.angle_unit, columns ? "deg" : angle_unit(first.latitude, first.longitude), "deg",
      "latitudes and longitudes", "angle_unit");
  const bool mm = first.height.whole && first.height.usual() > kHighest;
  put(mapping.height_unit, mm ? "mm" : "m", "m", "heights", "height_unit");
  if (bearing_unit == nullptr) return notices;
  const std::string usual = mapping.angle_unit == "rad" ? "rad" : "deg";
  const bool e5 = first.bearing.whole && first.bearing.usual() > kTurn;
  put(*bearing_unit, e5 ? "e5" : usual, usual, "bearings", "bearing_unit");
  return notices;
}

}  // namespace foucault::rawlog
