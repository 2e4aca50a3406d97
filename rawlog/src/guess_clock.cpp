#include "guess_clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "foucault/core/constants.h"
#include "foucault/core/median.h"
#include "foucault/core/time.h"
#include "guess_motion.h"

namespace foucault::rawlog {

namespace {

constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();
/// Placeholders where no file tells the date: any day does for navigation.
constexpr const char* kAnyDate = "2000-01-01";
constexpr double kAnyWeek = 1042;

struct TimeUnit {
  const char* name;
  double seconds;
};
constexpr TimeUnit kTimeUnits[] = {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};

std::string date_of(double unix_s) { return utc_text(nanoseconds(unix_s)).substr(0, 10); }

/// What the rows that count have in a column.
struct ClockValues {
  std::vector<double> all;    ///< a row each
  std::vector<double> known;  ///< without blanks
  double step = 0;            ///< mean of those forward: bursts do not count
};

/// Without the longest hundredth: holes, and stamps that are wrong.
double mean_step(const std::vector<double>& known) {
  std::vector<double> steps;
  for (size_t i = 1; i < known.size(); ++i) steps.push_back(std::max(0.0, known[i] - known[i - 1]));
  std::sort(steps.begin(), steps.end());
  steps.resize(steps.size() - steps.size() / 100);
  double sum = 0;
  for (const double step : steps) sum += step;
  return steps.empty() ? 0 : sum / static_cast<double>(steps.size());
}

ClockValues clock_values(const GuessColumn& column, const std::vector<bool>& present) {
  ClockValues values;
  values.all = column.values;
  for (size_t i = 0; i < values.all.size(); ++i) {
    if (!present[i]) values.all[i] = kNoTime;
    if (std::isfinite(values.all[i])) values.known.push_back(values.all[i]);
  }
  values.step = mean_step(values.known);
  return values;
}

/// Of a clock: hardly ever back but for the end of a week, and not standing still.
bool is_clock(const std::vector<double>& known) {
  if (known.size() < 3) return false;
  size_t back = 0;
  size_t on = 0;
  for (size_t i = 1; i < known.size(); ++i) {
    back += known[i] < known[i - 1] ? 1 : 0;
    on += known[i] > known[i - 1] ? 1 : 0;
  }
  const size_t allowed = 2 + known.size() / 100;
  return back <= allowed && on > allowed;
}

/// Periods that times begin again after are counted on.
void unroll_times(std::vector<double>& t, double period) {
  double added = 0;
  double last = kNoTime;
  for (double& value : t) {
    if (!std::isfinite(value)) continue;
    if (value + added < last - period / 2) added += period;
    value += added;
    last = value;
  }
}

void scale_times(std::vector<double>& t, double factor) {
  for (double& value : t) value *= factor;
}

/// Names that tell where the time was taken: on the way rather than at the sensor.
double name_score(const GuessColumn& column, const std::string& first) {
  double score = is_time_name(column.name) ? 100 : 0;
  if (has_word(column.name, {"measure", "sensor"})) score += 2;
  if (has_word(column.name, {"msg", "log", "rec", "arriv", "author", "host", "system", "local"})) {
    score -= 3;
  }
  if (has_word(column.name, {"packet", "count", "index", "seq", "number", "num", "sample"}))
    score -= 60;
  if (!first.empty() && has_word(column.name, {first})) score += 20;
  return score;
}

/// Receivers measure on an even grid of their clock; what is stamped on the way is uneven.
double evenness(const std::vector<double>& known, double step) {
  constexpr double kEven = 0.01;
  std::vector<double> off;
  for (size_t i = 1; i < known.size(); ++i) {
    const double steps = (known[i] - known[i - 1]) / step;
    off.push_back(std::abs(steps - std::max(1.0, std::round(steps))));
  }
  return !off.empty() && median(off) < kEven ? 1 : 0;
}

bool within(double value, StepRange range) {
  return value >= range.shortest && value <= range.longest;
}

/// A number as the seconds of a date of our times.
bool is_date(double seconds) {
  constexpr double kFrom = 8e8, kTo = 2.2e9;  // 1995 to 2039
  return seconds > kFrom && seconds < kTo;
}

void read_calendar(ClockGuess& clock) {
  clock.kind = ClockKind::absolute;
  clock.mapping.system = "iso8601";
  clock.remark.text = "dates in UTC, or with their zone";
}

void read_time_of_day(ClockGuess& clock, const GuessTable& table) {
  for (const GuessColumn& column : table.columns) {
    if (column.kind != CellKind::date || column.filled < 0.5) continue;
    clock.columns["date"] = column.key;
    for (size_t i = 0; i < clock.t.size(); ++i) clock.t[i] += column.values[i];
    read_calendar(clock);
    clock.remark = {false, "dates taken for UTC; they may be local"};
    return;
  }
  unroll_times(clock.t, kSecondsPerDay);
  clock.kind = ClockKind::day_seconds;
  clock.mapping.system = "seconds_of_day";
  clock.mapping.date = kAnyDate;
  clock.remark = {false, "the date is to be told; times taken for UTC"};
}

/// Seconds since 1970, or since 1980 where the name says GPS.
bool read_unix(ClockGuess& clock, const GuessColumn& column, const ClockValues& values,
               StepRange steps) {
  for (const TimeUnit& unit : kTimeUnits) {
    const double first = values.known.front() * unit.seconds;
    if (!is_date(first) || values.step * unit.seconds > 10 * steps.longest) continue;
    clock.kind = ClockKind::absolute;
    clock.mapping.unit = unit.name;
    scale_times(clock.t, unit.seconds);
    const bool is_unix = has_word(column.name, {"unix", "utc", "epoch", "posix", "since"});
    const double epoch = static_cast<double>(kGpsEpochNs) / 1e9;
    if (!is_unix && has_word(column.name, {"gps"}) && is_date(first + epoch)) {
      clock.mapping.system = "gps";
      for (double& t : clock.t) t += epoch - gps_utc_offset_s(nanoseconds(first + epoch));
      clock.remark = {false, fmt::format("as GPS seconds {}, as seconds since 1970 {}",
                                         date_of(first + epoch), date_of(first))};
    } else {
      clock.mapping.system = "unix";
      clock.remark.text = fmt::format("{} as {} since 1970; if the clock is GPS's, 18 s off",
                                      date_of(first), unit.name);
    }
    return true;
  }
  return false;
}

const TimeUnit* time_unit_called(const std::string& name) {
  for (const TimeUnit& unit : kTimeUnits) {
    if (name == unit.name) return &unit;
  }
  return nullptr;
}

/// By name if its steps are possible, else by the steps.
const TimeUnit* unit_by_steps(const GuessColumn& column, double step, StepRange steps,
                              bool& by_name) {
  const TimeUnit* named = time_unit_called(column.name.unit);
  by_name = named != nullptr && step * named->seconds <= 10 * steps.longest;
  if (by_name) return named;
  for (const TimeUnit& unit : kTimeUnits) {
    if (within(step * unit.seconds, steps)) return &unit;
  }
  return nullptr;
}

/// Second of the week, where a week stands beside or the name says so.
bool read_week(ClockGuess& clock, const GuessTable& table, const GuessColumn& column,
               const ClockValues& values, const TimeUnit& unit) {
  const auto [low, high] = std::minmax_element(values.known.begin(), values.known.end());
  if (*low * unit.seconds < 0 || *high * unit.seconds > 1.001 * kSecondsPerWeek) return false;
  const bool named = has_word(column.name, {"tow", "sow", "itow", "gps", "week"});
  const bool beyond_days = *high * unit.seconds > kSecondsPerDay &&
                           !has_word(column.name, {"boot", "elapse", "up", "reboot", "record"});
  const std::optional<size_t> week = table.find("week");
  if (!named && (!beyond_days || (table.header && !is_time_name(column.name)))) return false;
  clock.kind = ClockKind::week_seconds;
  unroll_times(clock.t, kSecondsPerWeek);
  if (!week) {
    clock.mapping.system = "gps_sow";
    clock.mapping.gps_week = kAnyWeek;
    clock.remark = {false, named
                               ? "the GPS week is to be told"
                               : "taken for seconds of a GPS week, which is to be told; it may be "
                                 "a time since power-up"};
    return true;
  }
  const GuessColumn& weeks = table.columns[*week];
  const auto first = std::find_if(weeks.values.begin(), weeks.values.end(),
                                  [](double w) { return std::isfinite(w); });
  if (first == weeks.values.end() || *first < 0 || *first > 1e4) return false;
  clock.mapping.system = "gps_week_sow";
  clock.columns["week"] = weeks.key;
  const double start = to_seconds(gps_to_unix_ns(static_cast<int>(*first), 0.0));
  for (double& t : clock.t) t += start;
  clock.kind = ClockKind::absolute;
  clock.remark.text = fmt::format("{} by week and second", date_of(start + *low * unit.seconds));
  constexpr double kTenBits = 1024;
  if (*first < kTenBits) clock.remark = {false, "weeks of ten bits: add 1024 or 2048"};
  return true;
}

void read_relative(ClockGuess& clock, const GuessColumn& column, bool unit_is_sure) {
  clock.kind = ClockKind::relative;
  clock.mapping.system = "seconds_of_day";
  clock.mapping.date = kAnyDate;
  clock.remark = {false, fmt::format("no date in the files; write the day, and {}",
                                     unit_is_sure ? "offset_s to its midnight if it is known"
                                                  : "check the unit, which is by the steps")};
  if (has_word(column.name, {"day", "sod"})) {
    clock.kind = ClockKind::day_seconds;
    clock.remark.text = "the date is to be told";
  }
}

std::optional<ClockGuess> clock_in(const GuessTable& table, const GuessColumn& column,
                                   const std::vector<bool>& present, StepRange steps) {
  if (column.kind == CellKind::text || column.kind == CellKind::date) return std::nullopt;
  if (table.header && role_of(column.name)) return std::nullopt;
  const ClockValues values = clock_values(column, present);
  const auto rows = static_cast<size_t>(std::count(present.begin(), present.end(), true));
  if (2 * values.known.size() < rows || !is_clock(values.known)) return std::nullopt;
  ClockGuess clock;
  clock.columns["time"] = column.key;
  clock.t = values.all;
  if (column.kind == CellKind::calendar) {
    read_calendar(clock);
  } else if (column.kind == CellKind::time_of_day) {
    read_time_of_day(clock, table);
  } else if (!read_unix(clock, column, values, steps)) {
    bool by_name = false;
    const TimeUnit* unit = unit_by_steps(column, values.step, steps, by_name);
    if (unit == nullptr) return std::nullopt;
    clock.mapping.unit = unit->name;
    scale_times(clock.t, unit->seconds);
    if (!read_week(clock, table, column, values, *unit)) read_relative(clock, column, by_name);
  }
  clock.score += evenness(values.known, median_step(values.known));
  return clock;
}

std::pair<double, double> span_of(const std::vector<double>& t) {
  double begin = std::numeric_limits<double>::infinity();
  double end = -begin;
  for (const double value : t) {
    if (!std::isfinite(value)) continue;
    begin = std::min(begin, value);
    end = std::max(end, value);
  }
  return {begin, end};
}

bool clocks_overlap(const ClockGuess& a, const ClockGuess& b) {
  const auto [a_begin, a_end] = span_of(a.t);
  const auto [b_begin, b_end] = span_of(b.t);
  const double common = std::min(a_end, b_end) - std::max(a_begin, b_begin);
  return common > 0.5 * std::min(a_end - a_begin, b_end - b_begin);
}

bool may_pair(const ClockGuess& a, const ClockGuess& b) {
  const bool a_is_absolute = a.kind == ClockKind::absolute;
  return a_is_absolute == (b.kind == ClockKind::absolute) && clocks_overlap(a, b);
}

/// What an absolute clock of the same table is ahead of `relative` [s]; none if they go apart.
std::optional<double> clock_offset(const ClockGuess& absolute, const ClockGuess& relative) {
  std::vector<double> differences;
  for (size_t i = 0; i < relative.t.size() && i < absolute.t.size(); ++i) {
    const double difference = absolute.t[i] - relative.t[i];
    if (std::isfinite(difference)) differences.push_back(difference);
  }
  if (differences.size() < 3) return std::nullopt;
  const double middle = median(differences);
  for (double& difference : differences) difference = std::abs(difference - middle);
  constexpr double kApart = 1;
  return median(differences) < kApart && is_date(middle) ? std::optional(middle) : std::nullopt;
}

/// A clock since power-up beside an absolute one: its zero has a date.
void date_zero(ClockPair& pair, const std::vector<ClockGuess>& others, const ClockGuess& tied) {
  for (const ClockGuess& other : others) {
    if (other.kind != ClockKind::absolute) continue;
    const std::optional<double> offset = clock_offset(other, tied);
    if (!offset) continue;
    const GpsTime zero = unix_to_gps(nanoseconds(*offset));
    const double sow = std::round(static_cast<double>(zero.tow_ns) / 1e6) / 1e3;
    for (ClockGuess* clock : {&pair.imu, &pair.gnss}) {
      clock->mapping.system = "boot";
      clock->mapping.date.clear();
      clock->mapping.gps_week = zero.week;
      clock->mapping.boot_sow = sow;
      clock->remark = {true, fmt::format("zero is {} by column {}, less what that is late",
                                         utc_text(nanoseconds(*offset)), other.columns.at("time"))};
    }
    return;
  }
}

void complete_pair(ClockPair& pair, const std::vector<ClockGuess>& imu,
                   const std::vector<ClockGuess>& gnss) {
  if (!pair.overlap || pair.imu.kind == ClockKind::absolute) return;
  if (pair.imu.kind == ClockKind::week_seconds || pair.gnss.kind == ClockKind::week_seconds) {
    // of one clock, so both are what the surer one is
    ClockGuess& other = pair.imu.kind == ClockKind::week_seconds ? pair.gnss : pair.imu;
    const ClockGuess& known = &other == &pair.gnss ? pair.imu : pair.gnss;
    const std::string unit = other.mapping.unit;
    other.kind = known.kind;
    other.mapping = known.mapping;
    other.mapping.unit = unit;
    other.remark = known.remark;
  }
  date_zero(pair, gnss, pair.gnss);
  if (pair.imu.mapping.system != "boot") date_zero(pair, imu, pair.imu);
}

}  // namespace

std::vector<ClockGuess> clocks_of(const GuessTable& table, const std::vector<bool>& present,
                                  StepRange steps, const std::string& first) {
  std::vector<ClockGuess> clocks;
  for (const GuessColumn& column : table.columns) {
    std::optional<ClockGuess> clock = clock_in(table, column, present, steps);
    if (!clock) continue;
    clock->score += name_score(column, first);
    if (table.header && clock->score < 0) continue;
    clocks.push_back(std::move(*clock));
  }
  const bool named = std::any_of(clocks.begin(), clocks.end(),
                                 [](const ClockGuess& clock) { return clock.score >= 50; });
  if (named) {  // other columns that grow are no clocks
    clocks.erase(std::remove_if(clocks.begin(), clocks.end(),
                                [](const ClockGuess& clock) { return clock.score < 50; }),
                 clocks.end());
  }
  std::stable_sort(clocks.begin(), clocks.end(),
                   [](const ClockGuess& a, const ClockGuess& b) { return a.score > b.score; });
  return clocks;
}

std::optional<ClockPair> paired_clocks(const std::vector<ClockGuess>& imu,
                                       const std::vector<ClockGuess>& gnss) {
  if (imu.empty() || gnss.empty()) return std::nullopt;
  ClockPair best{imu.front(), gnss.front(), false};
  double best_score = -1;
  for (const ClockGuess& a : imu) {
    for (const ClockGuess& b : gnss) {
      if (!may_pair(a, b)) continue;
      const double absolute = a.kind == ClockKind::absolute ? 10 : 0;
      const double same = a.columns == b.columns ? 2 : 0;
      const double score = a.score + b.score + absolute + same + 1000;
      if (score <= best_score) continue;
      best_score = score;
      best = {a, b, true};
    }
  }
  complete_pair(best, imu, gnss);
  return best;
}

}  // namespace foucault::rawlog
