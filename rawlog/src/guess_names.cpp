#include "guess_names.h"

#include <algorithm>
#include <cctype>
#include <regex>
#include <utility>

namespace foucault::rawlog {

namespace {

using Words = std::vector<std::string>;

bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool is_lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool is_alnum(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// Degree signs, micro and powers in letters.
std::string in_letters(std::string_view text) {
  static const std::vector<std::pair<std::string, std::string>> kSigns{
      {"\xC2\xB0", "deg"}, {"\xC2\xB2", "2"}, {"\xC2\xB5", "u"},
      {"\xCE\xBC", "u"},   {"^-", ""},        {"^", ""}};
  std::string letters(text);
  for (const auto& [sign, letter] : kSigns) {
    for (size_t at = letters.find(sign); at != std::string::npos; at = letters.find(sign)) {
      letters.replace(at, sign.size(), letter);
    }
  }
  return letters;
}

/// Between two words that are written as one: `gyroX`, `GPSTime`.
bool begins_word(std::string_view text, size_t i) {
  if (i == 0 || !is_upper(text[i])) return false;
  if (is_lower(text[i - 1])) return true;
  return is_upper(text[i - 1]) && i + 1 < text.size() && is_lower(text[i + 1]);
}

Words words_in(std::string_view text) {
  Words words(1);
  for (size_t i = 0; i < text.size(); ++i) {
    if (!is_alnum(text[i]) || begins_word(text, i)) words.emplace_back();
    if (is_alnum(text[i])) {
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    }
  }
  words.erase(std::remove(words.begin(), words.end(), ""), words.end());
  return words;
}

std::string joined_words(const Words& words, size_t begin = 0) {
  std::string text;
  for (size_t i = begin; i < words.size(); ++i) text += (i > begin ? "_" : "") + words[i];
  return text;
}

/// What mappings call a unit that is spelled so, as words; empty if it is none.
std::string unit_called(const std::string& spelling) {
  static const std::vector<std::pair<const char*, Words>> kUnits{
      {"rad_s", {"rad_s", "rads", "rad_sec", "rad_s1", "rad_s_1", "rps", "radps"}},
      {"deg_s", {"deg_s", "degs", "dps", "deg_sec", "degps", "degree_s", "degrees_s"}},
      {"rad", {"rad", "radians"}},
      {"deg", {"deg", "degree", "degrees"}},
      {"m_s2", {"m_s2", "m_s_2", "mps2", "m_s_s", "ms2", "mss", "m_sec2"}},
      {"cm_s2", {"cm_s2"}},
      {"g", {"g"}},
      {"mg", {"mg"}},
      {"m_s", {"m_s", "mps", "m_sec"}},
      {"km_h", {"km_h", "kmh", "kph"}},
      {"knots", {"knots", "kn", "kt", "kts"}},
      {"cm_s", {"cm_s"}},
      {"mm_s", {"mm_s"}},
      {"m", {"m", "meters", "metres"}},
      {"cm", {"cm"}},
      {"mm", {"mm"}},
      {"ft", {"ft", "feet"}},
      {"e7", {"e7", "dege7", "deg_e7"}},
      {"s", {"s", "sec", "secs", "seconds"}},
      {"ms", {"ms", "msec", "millis", "milliseconds"}},
      {"us", {"us", "usec", "micros", "microseconds"}},
      {"ns", {"ns", "nsec", "nanos", "nanoseconds"}}};
  for (const auto& [unit, spellings] : kUnits) {
    if (std::find(spellings.begin(), spellings.end(), spelling) != spellings.end()) return unit;
  }
  return {};
}

/// Takes a unit off the end; the first word is never one.
std::string take_unit(Words& words) {
  for (size_t begin = words.size() > 4 ? words.size() - 3 : 1; begin < words.size(); ++begin) {
    std::string unit = unit_called(joined_words(words, begin));
    if (unit.empty()) continue;
    words.resize(begin);
    return unit;
  }
  return {};
}

bool contains_any(const std::string& text, const Words& parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const auto& part) { return text.find(part) != std::string::npos; });
}

bool is_any(const std::string& text, const Words& choices) {
  return std::find(choices.begin(), choices.end(), text) != choices.end();
}

/// The sensor that a name without its axis is of.
std::optional<Sensor> sensor_called(std::string stem) {
  static const Words kOthers{"user", "gravity", "cov", "var", "std",   "sigma",     "bias",
                             "mag",  "temp",    "ned", "enu", "earth", "angularacc"};
  static const Words kGyros{"gyr",          "angvel",   "angularvel", "angularrate", "angrate",
                            "rotationrate", "rotrate",  "omega",      "dtheta",      "deltaangle",
                            "angularspeed", "angleinc", "rollrate",   "pitchrate",   "yawrate"};
  static const Words kGyroStems{"g", "w", "wrs", "rot", "rate", "da", "dang", "av", "gy"};
  static const Words kAccelerometers{"acc", "specificforce", "dvel", "deltavel", "velinc"};
  static const Words kAccelerometerStems{"a", "f", "ac", "ars", "dv", "sf", "xl"};
  stem.erase(std::remove(stem.begin(), stem.end(), '_'), stem.end());
  if (contains_any(stem, kOthers)) return std::nullopt;
  if (contains_any(stem, kGyros) || is_any(stem, kGyroStems)) return Sensor::gyro;
  if (contains_any(stem, kAccelerometers) || is_any(stem, kAccelerometerStems)) {
    return Sensor::accelerometer;
  }
  return std::nullopt;
}

/// Takes x, y, z, or 0, 1, 2 in brackets, off the end; those behind a sensor's name (`gyrox`) too.
std::optional<int> take_axis(Words& words) {
  if (words.empty()) return std::nullopt;
  std::string& last = words.back();
  const char letter = last.back();
  const bool is_index = last.size() == 1 && letter >= '0' && letter <= '2' && words.size() > 1;
  if (!is_index && (letter < 'x' || letter > 'z')) return std::nullopt;
  static const Words kStems{
      "g",          "w",           "a",      "acc",    "accel",  "acceleration", "gyr",
      "gyro",       "gyros",       "omega",  "rot",    "dv",     "dtheta",       "ang",
      "uncompgyro", "uncompaccel", "angvel", "linacc", "imuacc", "imugyro"};
  const bool has_stem = is_any(last.substr(0, last.size() - 1), kStems);
  if (last.size() > 1 && !has_stem) return std::nullopt;
  const int axis = is_index ? letter - '0' : letter - 'x';
  last.pop_back();
  if (last.empty()) words.pop_back();
  return axis;
}

/// Takes what stands in brackets at the end, if it is no index and no axis.
std::string take_bracket(std::string& text) {
  const size_t open = text.find_last_of("([");
  if (open == std::string::npos || open == 0) return {};
  const std::string inner = joined_words(words_in(text.substr(open)));
  const bool is_axis = inner.size() == 1 && (std::isdigit(inner[0]) != 0 || inner[0] >= 'x');
  if (inner.empty() || is_axis) return {};
  text.resize(open);
  return inner;
}

/// roll_rate, pitchrate, yaw_rate.
std::optional<int> axis_of_turn(const std::string& words) {
  static const Words kTurns{"roll", "pitch", "yaw"};
  for (size_t i = 0; i < kTurns.size(); ++i) {
    const std::string& turn = kTurns[i];
    if (words == turn + "rate" || words == turn + "_rate") return static_cast<int>(i);
  }
  return std::nullopt;
}

}  // namespace

ColumnName column_name(std::string_view name, std::string_view unit) {
  std::string text = in_letters(name);
  const std::string bracket = take_bracket(text);
  Words words = words_in(text);
  ColumnName parsed;
  parsed.unit = take_unit(words);
  parsed.axis = take_axis(words);
  if (parsed.unit.empty()) parsed.unit = take_unit(words);
  if (!bracket.empty()) parsed.unit = unit_called(bracket);
  if (!unit.empty()) parsed.unit = unit_called(joined_words(words_in(in_letters(unit))));
  parsed.words = joined_words(words);
  if (!parsed.axis) parsed.axis = axis_of_turn(parsed.words);
  return parsed;
}

std::optional<Sensor> sensor_of(const ColumnName& name) {
  return name.axis ? sensor_called(name.words) : std::nullopt;
}

std::optional<std::string> role_of(const ColumnName& name) {
  // clang-format off
  static const std::vector<std::pair<std::string, std::regex>> kRoles = [] {
    const std::vector<std::pair<std::string, std::string>> texts{
        {"geoid", "(.*_)?(geoid|undulation|geoid_sep.*|geoid_height)"},
        {"sigma_north", "(.*_)?(sd|std|sigma|stdev|stddev|s)_?(n|north|lat|latitude)|"
                        "(lat|latitude|north)_(sd|std|sigma|stdev|acc|accuracy|error)"},
        {"sigma_east", "(.*_)?(sd|std|sigma|stdev|stddev|s)_?(e|east|lon|longitude)|"
                       "(lon|longitude|east)_(sd|std|sigma|stdev|acc|accuracy|error)"},
        {"sigma_down", "(.*_)?(sd|std|sigma|stdev|stddev|s)_?(d|u|down|up|alt|altitude|h|height|hgt)|"
                       "(alt|altitude|height|up|down)_(sd|std|sigma|stdev|acc|accuracy|error)"},
        {"sigma_velocity", "(.*_)?(sd|std|sigma)_?(v|vel|velocity)|sv|(s|speed|vel|velocity)_?(acc|accuracy)|"
                           "(.*_)?(speed_accuracy|velocity_accuracy|speed_acc|s_variance)"},
        {"sigma_vertical", "(.*_)?(v_?acc|vertical_?accuracy|epv|v_?accuracy|vert_?acc|vpe)"},
        {"sigma_horizontal", "(.*_)?(h_?acc|horizontal_?accuracy|eph|epe|h_?accuracy|hor_?acc|hpe|"
                             "pos_?accuracy|position_?accuracy)|(location_|gps_|gnss_)?accuracy"},
        {"latitude_minutes", "(lat|latitude)_(m|min|minutes)"},
        {"latitude_seconds", "(lat|latitude)_(s|sec|seconds)"},
        {"longitude_minutes", "(lon|longitude)_(m|min|minutes)"},
        {"longitude_seconds", "(lon|longitude)_(s|sec|seconds)"},
        {"latitude_hemisphere", "(.*_)?(ns|n_s|lat_dir|lat_hemi.*|latitude_(dir|direction|hemisphere))"},
        {"longitude_hemisphere", "(.*_)?(ew|e_w|lon_dir|lon_hemi.*|longitude_(dir|direction|hemisphere))"},
        {"latitude", "(.*_)?(gps|gnss)?(lat|latitude|latitud)(_(wgs84|gps|gnss|d))?"},
        {"longitude", "(.*_)?(gps|gnss)?(lon|lng|long|longitude)(_(wgs84|gps|gnss|d))?"},
        {"height_msl", "(.*_)?(h|height|alt|altitude|hgt|elevation)_?(msl|amsl|above_mean_sea_level|orth.*)"
                       "(_.*)?|(msl|amsl)_?(alt|altitude|height)|hmsl"},
        {"height_ellipsoidal", "(.*_)?(h|height|alt|altitude|hgt)_?(ell|ellip|ellipsoid|ellipsoidal|hae|wgs84)"
                               "(_.*)?|hae"},
        {"height", "(gps_|gnss_|location_|field_|ref_|true_)?(alt|altitude|height|hgt|h|elevation|ele)"},
        {"velocity_north", "(.*_)?(v|vel|velocity|speed)_?(n|north)(_.*)?|(n|north)_?(vel|velocity|speed)"},
        {"velocity_east", "(.*_)?(v|vel|velocity|speed)_?(e|east)(_.*)?|(e|east)_?(vel|velocity|speed)"},
        {"velocity_down", "(.*_)?(v|vel|velocity|speed)_?(d|down)(_.*)?|(down)_?(vel|velocity|speed)"},
        {"velocity_up", "(.*_)?(v|vel|velocity|speed)_?(u|up)(_.*)?|(up)_?(vel|velocity|speed)"},
        {"speed", "(gps_|gnss_|location_|ground_|g_)*(speed|velocity|gspeed|sog|spd|groundspeed|"
                  "speed_?over_?ground|speed_?2d|vel|ground_?spd)"},
        {"bearing", "(gps_|gnss_|location_|ground_)*(bearing|course|cog|track|head_?mot|heading_?motion|"
                    "course_?over_?ground|heading_of_motion|crs|direction|ground_course|true_course)"},
        {"roll", "(.*_)?roll(_.*)?"},
        {"pitch", "(.*_)?pitch(_.*)?"},
        {"heading", "(.*_)?(yaw|heading|azimuth|hdg)(_.*)?"},
        {"quality", "(gps_|gnss_|location_)*(q|quality|fix|fix_?type|fix_?quality|fix_?mode|fix_?status|status|"
                    "gps_?fix|gps_?qual|mode|pos_?type|sol_?type|q_.*|ins_status|solution|solution_status|fixq)"},
        {"east", "(local_|pos_|p_)?(east|easting|e)"},
        {"north", "(local_|pos_|p_)?(north|northing|n)"},
        {"up", "(local_|pos_|p_)?(up|u)"},
        {"week", "(.*_)?(week|wn|weekno|gpsweek|week_(number|no|num)|wk)"},
        {"date", "(.*_)?(date|utc_date|datum|day)"}};
    std::vector<std::pair<std::string, std::regex>> roles;
    for (const auto& [role, text] : texts) roles.emplace_back(role, std::regex(text));
    return roles;
  }();
  // clang-format on
  if (name.axis) return std::nullopt;
  for (const auto& [role, pattern] : kRoles) {
    if (std::regex_match(name.words, pattern)) return role;
  }
  return std::nullopt;
}

bool has_word(const ColumnName& name, const std::vector<std::string>& starts) {
  const Words words = words_in(name.words);
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::any_of(starts.begin(), starts.end(),
                       [&](const auto& start) { return word.rfind(start, 0) == 0; });
  });
}

bool is_time_name(const ColumnName& name) {
  static const Words kTimes{"time",  "stamp", "tow",      "sow",    "itow",   "epoch",
                            "utime", "utc",   "unix",     "elapse", "milli",  "micro",
                            "nano",  "clock", "datetime", "sinc",   "second", "gpst",
                            "secs",  "sod",   "gpstime",  "uptime"};
  return name.words == "t" || name.words == "sec" || name.words.rfind("t_", 0) == 0 ||
         has_word(name, kTimes) || name.words.find("time") != std::string::npos;
}

}  // namespace foucault::rawlog
