#include "guess_imu.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "foucault/core/constants.h"
#include "foucault/core/median.h"
#include "import_run.h"
#include "table_units.h"

namespace foucault::rawlog {

namespace {

using Eigen::Vector3d;

/// Where numbers agree as well as sensors and gravity's place on Earth let them.
constexpr double kAgrees = 0.05;
/// Beyond a sensor's errors, but no other unit is as near.
constexpr double kNear = 0.25;
/// Logarithm of a likelihood ratio that is clear: 1e4 to 1.
constexpr double kClear = 9.2;

bool is_near(double value, double of, double part) {
  return std::abs(value - of) <= part * std::abs(of);
}

/// Triples of one stem, by the name.
std::vector<Triple> named_triples(const GuessTable& table, Sensor sensor) {
  std::map<std::string, std::array<std::optional<size_t>, 3>> stems;
  std::vector<std::string> order;
  for (size_t i = 0; i < table.columns.size(); ++i) {
    const GuessColumn& column = table.columns[i];
    if (column.kind != CellKind::number || column.filled == 0) continue;
    if (sensor_of(column.name) != sensor) continue;
    const bool is_turn = column.name.words.find("rate") != std::string::npos &&
                         column.name.words.find("rotation") == std::string::npos;
    const std::string stem = is_turn ? "rate" : column.name.words;
    if (stems.count(stem) == 0) order.push_back(stem);
    auto& place = stems[stem][static_cast<size_t>(*column.name.axis)];
    if (!place) place = i;
  }
  std::vector<Triple> triples;
  for (const std::string& stem : order) {
    const auto& axes = stems[stem];
    if (axes[0] && axes[1] && axes[2]) triples.push_back({*axes[0], *axes[1], *axes[2]});
  }
  return triples;
}

std::vector<bool> rows_with(const GuessTable& table, const std::vector<size_t>& columns) {
  std::vector<bool> rows(table.rows, true);
  for (const size_t column : columns) {
    const std::vector<double>& values = table.columns[column].values;
    for (size_t i = 0; i < rows.size(); ++i) rows[i] = rows[i] && std::isfinite(values[i]);
  }
  return rows;
}

Vector3d vector_at(const GuessTable& table, const Triple& triple, size_t row) {
  return {table.columns[triple[0]].values[row], table.columns[triple[1]].values[row],
          table.columns[triple[2]].values[row]};
}

/// Means of so many rows in a row: their norm is gravity's in an accelerometer.
struct NormFacts {
  double norm = 0, spread = 1;
};
NormFacts norm_facts(const GuessTable& table, const Triple& triple) {
  constexpr size_t kWindow = 50;
  const std::vector<bool> rows = rows_with(table, {triple.begin(), triple.end()});
  std::vector<double> norms;
  Vector3d sum = Vector3d::Zero();
  size_t count = 0;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i]) continue;
    sum += vector_at(table, triple, i);
    if (++count % kWindow != 0) continue;
    norms.push_back((sum / kWindow).norm());
    sum.setZero();
  }
  if (norms.size() < 2) return {};
  NormFacts facts;
  facts.norm = median(norms);
  for (double& norm : norms) norm = std::abs(norm - facts.norm);
  facts.spread = facts.norm > 0 ? median(norms) / facts.norm : 1;
  return facts;
}

/// What gravity is in units that loggers write, counts of common ranges included.
struct GravityUnit {
  const char* unit;
  double gravity;
  double scale;
  bool counts;
};
const std::vector<GravityUnit>& gravity_units() {
  static const std::vector<GravityUnit> units = [] {
    std::vector<GravityUnit> all{{"m_s2", kStandardGravity, 1, false},
                                 {"g", 1, 1, false},
                                 {"mg", 1000, 1, false},
                                 {"cm_s2", 100 * kStandardGravity, 1, false}};
    for (const double counts : {16384.0, 8192.0, 4096.0, 2048.0, 1024.0}) {  // of 16 bits
      all.push_back({"g", counts, 1 / counts, true});
    }
    return all;
  }();
  return units;
}

bool is_gravity(double norm) {
  return std::any_of(gravity_units().begin(), gravity_units().end(),
                     [&](const GravityUnit& unit) { return is_near(norm, unit.gravity, kAgrees); });
}

/// Of several, the one that has gravity in it.
Triple with_gravity(const GuessTable& table, const std::vector<Triple>& triples) {
  const auto distance = [&](const Triple& triple) {
    const NormFacts facts = norm_facts(table, triple);
    return is_gravity(facts.norm) ? facts.spread : 1 + facts.spread;
  };
  return *std::min_element(triples.begin(), triples.end(), [&](const Triple& a, const Triple& b) {
    return distance(a) < distance(b);
  });
}

bool is_plain(const GuessTable& table, size_t i) {
  const GuessColumn& column = table.columns[i];
  return column.kind == CellKind::number && column.filled > 0 && !role_of(column.name) &&
         !(table.header && is_time_name(column.name));
}

/// Three columns beside each other that have nothing to do with those in `taken`.
std::vector<Triple> plain_triples(const GuessTable& table, const std::vector<size_t>& taken) {
  std::vector<Triple> triples;
  const auto is_free = [&](size_t i) {
    return is_plain(table, i) && std::find(taken.begin(), taken.end(), i) == taken.end();
  };
  for (size_t i = 0; i + 2 < table.columns.size(); ++i) {
    if (is_free(i) && is_free(i + 1) && is_free(i + 2)) triples.push_back({i, i + 1, i + 2});
  }
  return triples;
}

/// Without names: three columns that show a steady gravity, or one over a steady time (increments).
std::optional<Triple> triple_with_gravity(const GuessTable& table) {
  std::optional<Triple> best;
  double steadiest = kAgrees;
  for (const Triple& triple : plain_triples(table, {})) {
    const NormFacts facts = norm_facts(table, triple);
    const bool may_be = is_gravity(facts.norm) || (facts.norm > 0.005 && facts.norm < 2);
    if (!may_be || facts.spread >= steadiest) continue;
    const Triple& t = triple;
    const bool moves = (vector_at(table, t, 0) - vector_at(table, t, table.rows / 2)).norm() > 0;
    if (!moves) continue;
    steadiest = facts.spread;
    best = triple;
  }
  return best;
}

/// Which of the columns left over turn as gravity does; else those before or after.
Triple turning_with(const GuessTable& table, const Triple& accel, bool& sure) {
  const std::vector<Triple> triples = plain_triples(table, {accel.begin(), accel.end()});
  Triple best = triples.front();
  double least = 0;
  for (const Triple& triple : triples) {
    if (triple[2] + 1 == accel[0] && least == 0) best = triple;
    std::vector<double> t(table.rows);
    for (size_t i = 0; i < t.size(); ++i) t[i] = 0.01 * static_cast<double>(i);
    const ImuSeries imu = imu_series(table, {triple, accel, {}, {}}, t);
    const Regression tilt = tilt_match(imu);
    if (!tilt.is_sure() || tilt.log_chance >= least) continue;
    least = tilt.log_chance;
    best = triple;
    sure = true;
  }
  return best;
}

std::optional<ImuColumns> columns_by_data(const GuessTable& table) {
  const std::optional<Triple> accel = triple_with_gravity(table);
  if (!accel || plain_triples(table, {accel->begin(), accel->end()}).empty()) return std::nullopt;
  ImuColumns columns;
  columns.accel = *accel;
  bool sure = false;
  columns.gyro = turning_with(table, *accel, sure);
  columns.remark = {sure, sure ? "by gravity, and by what turns as it does"
                               : "accelerometers by gravity, gyroscopes by their place beside it"};
  return columns;
}

double snapped(double value, const std::vector<double>& known, double part) {
  for (const double k : known) {
    if (is_near(value, k, part)) return k;
  }
  return value;
}

std::string signed_axis(const Vector3d& axis) {
  const NearestAxis nearest = nearest_axis(axis);
  return fmt::format("{}{}", nearest.sign < 0 ? "-" : "", "xyz"[nearest.axis]);
}

/// What turns and accelerations say of the accelerometer's sign.
void decide_sign(AxesGuess& guess, const std::optional<MotionMatch>& match, bool ios) {
  guess.reversed = ios;
  guess.sign = {ios, ios ? "phones of this logger have it so"
                         : "no turns to check it; -1 if an axis that looks up shows -1 g"};
  if (!match) return;
  const double difference =
      match->force.regression.log_chance - match->mirrored.regression.log_chance;
  const bool by_force =
      (match->force.regression.is_sure() || match->mirrored.regression.is_sure()) &&
      std::abs(difference) > kClear;
  const bool by_turn = match->turn.is_sure();
  if (!by_turn && !by_force) return;
  guess.reversed = by_turn ? match->turn.slope < 0 : difference > 0;
  guess.sign = {true,
                by_turn ? "turns agree with the course" : "accelerations to the side in turns"};
}

/// Forward, right, down as sensor axes, if `down` and `forward` are two of them.
std::vector<std::string> axes_of(const Vector3d& forward, const Vector3d& down) {
  return {signed_axis(forward), signed_axis(down.cross(forward)), signed_axis(down)};
}

}  // namespace

std::optional<ImuColumns> imu_columns(const GuessTable& table) {
  const std::vector<Triple> gyros = named_triples(table, Sensor::gyro);
  const std::vector<Triple> accels = named_triples(table, Sensor::accelerometer);
  if (gyros.empty() || accels.empty()) {
    return table.find("latitude") || !gyros.empty() || !accels.empty() ? std::nullopt
                                                                       : columns_by_data(table);
  }
  ImuColumns columns;
  columns.gyro = gyros.front();
  columns.accel = with_gravity(table, accels);
  columns.remark.text = "by name";
  const std::string& words = table.columns[columns.accel[0]].name.words;
  columns.first = words.substr(0, words.find('_'));
  return columns;
}

std::vector<bool> imu_rows(const GuessTable& table, const ImuColumns& columns) {
  std::vector<size_t> all(columns.gyro.begin(), columns.gyro.end());
  all.insert(all.end(), columns.accel.begin(), columns.accel.end());
  return rows_with(table, all);
}

ImuSeries imu_series(const GuessTable& table, const ImuColumns& columns,
                     const std::vector<double>& t) {
  const std::vector<bool> rows = imu_rows(table, columns);
  ImuSeries imu;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i] || !std::isfinite(t[i])) continue;
    if (!drop_ahead(imu.t, t[i], kMostRowsAhead)) continue;
    imu.gyro.resize(imu.t.size());
    imu.accel.resize(imu.t.size());
    imu.t.push_back(t[i]);
    imu.gyro.push_back(vector_at(table, columns.gyro, i));
    imu.accel.push_back(vector_at(table, columns.accel, i));
  }
  return imu;
}

bool are_counts(const std::vector<Vector3d>& values) {
  constexpr double kLeast = 2;  // zeros are whole, too
  double largest = 0;
  for (const Vector3d& value : values) {
    if (value != value.array().round().matrix()) return false;
    largest = std::max(largest, value.cwiseAbs().maxCoeff());
  }
  return largest > kLeast;
}

UnitGuess accel_unit(const std::string& named, const Gravity& gravity, bool counts, double step) {
  UnitGuess guess{named, 1, {}};
  if (!named.empty()) {
    const auto known = std::find_if(gravity_units().begin(), gravity_units().end(),
                                    [&](const auto& u) { return u.unit == named && !u.counts; });
    const double expected =
        known == gravity_units().end() ? kStandardGravity * step : known->gravity;
    if (is_near(gravity.norm, expected, kNear)) {
      guess.remark.text = fmt::format("by name, {:.4g} is gravity", gravity.norm);
      return guess;
    }
  }
  const GravityUnit* best = nullptr;
  const GravityUnit increments{"m_s", kStandardGravity * step, 1, false};
  std::vector<GravityUnit> units = gravity_units();
  units.push_back(increments);
  int near = 0;
  const auto off = [&](const GravityUnit& u) {
    return std::abs(std::log(gravity.norm / u.gravity));
  };
  for (const GravityUnit& unit : units) {
    if (unit.counts && !counts) continue;
    if (is_near(gravity.norm, unit.gravity, kAgrees)) ++near;
    if (best == nullptr || off(unit) < off(*best)) best = &unit;
  }
  guess.unit = best->unit;
  guess.scale = best->scale;
  const bool fits = is_near(gravity.norm, best->gravity, kAgrees);
  guess.remark.sure = fits && near == 1;
  guess.remark.text = fmt::format("{:.4g} is gravity", gravity.norm);
  if (fits && near > 1) {
    guess.remark.text += ", in other units as well";
  } else if (!fits && is_near(gravity.norm, best->gravity, kNear)) {
    guess.remark.text = fmt::format("{:.4g} is {:.0f} % off gravity", gravity.norm,
                                    100 * std::abs(gravity.norm / best->gravity - 1));
  } else if (!fits) {
    guess.unit = "m_s2";
    guess.scale = 1;
    guess.remark.text = fmt::format(
        "{:.4g} is gravity in no unit: {}, or give accel_scale, which would be {:.6g}",
        gravity.norm,
        gravity.norm < 2 ? "an acceleration without gravity is no use" : "a wrong scale",
        kStandardGravity / gravity.norm);
  }
  if (!named.empty()) guess.remark.text += fmt::format("; the name says {}", named);
  return guess;
}

namespace {

/// Of rates, or of increments over `step`: what radians a second one unit is.
struct RateUnit {
  const char* name;
  double factor;
};

UnitGuess rate_by_slope(double slope, double sigma, const char* by, bool counts, bool increments,
                        double step) {
  UnitGuess guess;
  const double over = increments ? 1 / step : 1;
  const std::vector<RateUnit> units{{increments ? "rad" : "rad_s", over},
                                    {increments ? "deg" : "deg_s", over * kDegree}};
  const double part = sigma / slope;
  for (const RateUnit& unit : units) {
    const double ratio = slope / unit.factor;
    constexpr double kSameUnit = 4;  // the other is 57 times as large
    if (std::abs(std::log(ratio)) > std::log(kSameUnit)) continue;
    guess.unit = unit.name;
    guess.remark.sure = std::abs(ratio - 1) < kNear + 3 * part;
    guess.remark.text = fmt::format("{} say {:.3g} +- {:.2g} of it", by, ratio, 3 * part * ratio);
    if (!guess.remark.sure)
      guess.remark.text += fmt::format(": a wrong scale, or gyro_scale: {:.4g}", ratio);
    return guess;
  }
  constexpr double kLeastCounts = 1e-3;
  constexpr double kMostCounts = 1e6;  // more than 32 bits have
  const double exact = kDegree / slope;
  if (!counts || exact < kLeastCounts || exact > kMostCounts) {
    guess.unit = units.front().name;
    guess.remark = {false, fmt::format("{} say that one is {:.4g} rad/s", by, slope)};
    return guess;
  }
  // counts a degree a second of common gyroscopes
  const double counted = snapped(exact, {131, 65.5, 32.8, 16.4, 114.286, 57.143, 14.286, 14.375},
                                 std::max(3 * part, kAgrees));
  guess.unit = increments ? "deg" : "deg_s";
  guess.scale = 1 / counted;
  guess.remark = {part < kAgrees, fmt::format("{} say {:.4g} counts a deg/s, +- {:.2g}", by,
                                              kDegree / slope, 3 * part * kDegree / slope)};
  return guess;
}

/// By what gyroscopes of a table on the desk would show: noise between samples.
UnitGuess rate_by_noise(const ImuSeries& imu, bool counts, bool increments) {
  UnitGuess guess;
  guess.remark.sure = false;
  if (counts) {
    guess.unit = "deg_s";
    guess.scale = 1 / 131.0;
    guess.remark.text =
        "counts, and no turns to tell their scale; 1/131, 1/65.5, 1/32.8 and 1/16.4 "
        "are common";
    return guess;
  }
  constexpr double kBetween = 0.015;  ///< MEMS: to 0.006 rad/s, from 0.035 deg/s a sample
  constexpr double kFastest = 40;     ///< rad/s that such gyroscopes measure
  std::vector<double> steps;
  double largest = 0;
  for (size_t i = 1; i < imu.gyro.size(); ++i) {
    steps.push_back((imu.gyro[i] - imu.gyro[i - 1]).norm() / std::sqrt(6.0));
    largest = std::max(largest, imu.gyro[i].cwiseAbs().maxCoeff());
  }
  const bool degrees = !steps.empty() && (largest > kFastest || median(steps) > kBetween);
  guess.unit = degrees ? (increments ? "deg" : "deg_s") : (increments ? "rad" : "rad_s");
  guess.remark.text = fmt::format("no turns to tell it, by the noise only; {} is possible",
                                  degrees ? "rad_s" : "deg_s");
  return guess;
}

}  // namespace

UnitGuess gyro_unit(const std::string& named, const ImuSeries& imu, const Regression& turn,
                    bool counts, bool increments, double step) {
  const Regression tilt = tilt_match(imu);
  std::optional<UnitGuess> found;
  if (turn.is_sure() && turn.coherence > 0.2) {
    found = rate_by_slope(std::abs(turn.slope), turn.sigma, "turns", counts, increments, step);
  } else if (tilt.is_sure() && tilt.coherence > 0.2) {
    found = rate_by_slope(tilt.slope, tilt.sigma, "tilts", counts, increments, step);
  }
  if (!named.empty()) {
    if (!found || found->unit == named || found->scale != 1) {
      return {named,
              1,
              {true, found && found->unit == named ? "by name; " + found->remark.text : "by name"}};
    }
    found->remark.sure = false;
    found->remark.text += fmt::format("; the name says {}", named);
    return *found;
  }
  return found ? *found : rate_by_noise(imu, counts, increments);
}

AxesGuess guess_axes(const Gravity& gravity, const std::optional<MotionMatch>& match, bool ios) {
  AxesGuess guess;
  decide_sign(guess, match, ios);
  const Vector3d up = guess.reversed ? Vector3d(-gravity.up) : gravity.up;
  const NearestAxis vertical = nearest_axis(up);
  const Vector3d down = -vertical.sign * Vector3d::Unit(vertical.axis);
  constexpr double kMostTilt = 30 * kDegree;
  const std::string tilt = fmt::format("down by gravity, {:.0f} deg off", vertical.angle / kDegree);
  ForceMatch found;
  if (match) found = guess.reversed ? match->mirrored : match->force;
  const Regression& force = found.regression;
  if (!force.is_sure()) {
    const int first = vertical.axis == 0 ? 1 : 0;
    guess.axes = axes_of(Vector3d::Unit(first), down);
    guess.remark = {false,
                    tilt + "; forward is to be told, no accelerations along a track show it"};
    return guess;
  }
  const LevelAxes level = level_axes(up, 0);
  const Vector3d forward =
      std::cos(found.forward) * level.first + std::sin(found.forward) * level.second;
  Vector3d flat = forward;
  flat[vertical.axis] = 0;
  const NearestAxis ahead = nearest_axis(flat);
  const Vector3d axis = ahead.sign * Vector3d::Unit(ahead.axis);
  guess.axes = axes_of(axis, down);
  const Vector3d level_axis = (axis - axis.dot(up) * up).normalized();
  const double off = std::acos(std::clamp(forward.dot(level_axis), -1.0, 1.0));
  const double sigma = force.sigma / force.slope;
  const bool leads = match->lead > kClear;
  guess.remark.sure = vertical.angle < kMostTilt && off + 3 * sigma < kPi / 4 && leads;
  guess.remark.text =
      fmt::format("{}; forward by accelerations along the track, {:.0f} +- {:.0f} deg off", tilt,
                  off / kDegree, 3 * sigma / kDegree);
  if (!leads) guess.remark.text += "; at another lag it looks elsewhere";
  if (vertical.angle >= kMostTilt) guess.remark.text += "; give mounting_rpy_deg";
  return guess;
}

}  // namespace foucault::rawlog
