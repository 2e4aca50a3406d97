#include "csv_readers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/median.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/wgs84.h"
#include "imu_counts.h"
#include "imu_halves.h"
#include "nmea_accuracy.h"
#include "position_columns.h"
#include "position_units.h"
#include "shared_stamps.h"
#include "table_units.h"
#include "time_column.h"
#include "unit_search.h"

namespace foucault::rawlog {

namespace fs = std::filesystem;

namespace {

Roles joined(std::initializer_list<Roles> parts) {
  Roles all = time_roles();
  for (const Roles& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Texts of one line, as messages quote them.
void check_line(const std::string& text, const std::string& key) {
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
  if (std::none_of(text.begin(), text.end(), is_control)) return;
  throw UsageError(fmt::format("{} has a control character in it; remove it", key));
}

void check_lines(const std::map<std::string, std::string>& texts, const std::string& key) {
  for (const auto& [name, text] : texts) {
    check_line(name, key);
    check_line(text, key);
  }
}

void check_lines(const TableMapping& mapping, const std::string& section) {
  check_lines(mapping.columns, section + ".columns");
  check_line(mapping.time.date, section + ".time.date");
  check_line(mapping.time.date_format, section + ".time.date_format");
  check_line(mapping.rows.column, section + ".rows.column");
  check_line(mapping.rows.value, section + ".rows.value");
  check_line(mapping.file, section + ".file");
}

using Notices = std::vector<std::string>;

void append(Notices& notices, const Notices& more) {
  notices.insert(notices.end(), more.begin(), more.end());
}

/// What was assumed of a table.
Notices joined(Notices notices, const Columns& columns, const TextTable& table) {
  append(notices, columns.notices());
  append(notices, table.notices());
  return notices;
}

/// Turns seconds of a day that are hhmmss into those.
Notices find_clock(TableMapping& mapping, const std::string& path, const std::string& section) {
  if (!has_hhmmss(mapping, path, section)) return {};
  mapping.time.unit = "hhmmss";
  return {
      fmt::format("{}: its times jump at the end of each minute and are read as hhmmss; give "
                  "{}.time.unit: hhmmss",
                  path, section)};
}

// IMU -------------------------------------------------------------------------------------------

const Roles kGyro{"gyro_x", "gyro_y", "gyro_z"};
const Roles kAccel{"accel_x", "accel_y", "accel_z"};

Roles imu_roles() { return joined({kGyro, kAccel, {"wheel_speed"}}); }

/// A rate, or what came together since the row before.
struct ImuVector {
  std::array<size_t, 3> columns;
  double scale;
  Unit unit;
  CountFormat counts;

  bool is_blank(const Row& row) const {
    return std::all_of(columns.begin(), columns.end(), [&](size_t c) { return row.is_blank(c); });
  }
  Eigen::Vector3d value(const Row& row) const {
    Eigen::Vector3d found;
    for (size_t i = 0; i < 3; ++i) found[static_cast<int>(i)] = count_of(row, columns[i], counts);
    return found * (scale * unit.factor);
  }
  Eigen::Vector3d increment(const Eigen::Vector3d& value, double dt) const {
    return unit.increment ? value : value * dt;
  }
};

/// How an IMU table is to be read, once its first rows were seen.
struct ImuTable {
  ImuMapping mapping;  ///< its units and counts are no longer `auto`
  std::vector<std::string> notices;
  std::optional<SharedStamps> shared;
};

class ImuReader : public RecordReader {
 public:
  ImuReader(const ImuTable& found, const std::string& path)
      : notices_(found.notices),
        table_(open_mapped_table(path)),
        columns_(found.mapping, table_, "imu", imu_roles()),
        time_(found.mapping.time, columns_),
        gyro_{three(columns_, kGyro), found.mapping.gyro_scale,
              unit_of(rate_units(), found.mapping.gyro_unit), *count_format(found.mapping.counts)},
        accel_{three(columns_, kAccel),
               (found.mapping.accel_sign == "-1" ? -1 : 1) * found.mapping.accel_scale,
               unit_of(acceleration_units(), found.mapping.accel_unit), gyro_.counts},
        wheel_speed_(columns_.find("wheel_speed")),
        wheel_factor_(unit_of(speed_units(), found.mapping.wheel_speed_unit).factor),
        shared_(found.shared) {}

  const TextTable& table() const override { return table_; }
  int64_t without_fix() const override { return blank_ + halves_.alone(); }
  Notices notices() const override {
    Notices all = joined(notices_, columns_, table_);
    if (halves_seen_) {
      all.push_back(fmt::format(
          "{}: gyroscope and accelerometer have rows of their own: joined at the stamps "
          "of the gyroscope",
          table_.path()));
    }
    return all;
  }

  std::optional<Record> next() override {
    while (ready_.empty()) {
      const Row* row = table_.next();
      if (row == nullptr) {
        if (over_) return std::nullopt;
        finish();
      } else {
        take_row(*row);
      }
    }
    Record record = std::move(ready_.front());
    ready_.pop_front();
    return record;
  }

 private:
  struct Sample {
    imu::ImuSample imu;
    std::optional<double> wheel_speed;
  };

  bool has_increments() const { return gyro_.unit.increment || accel_.unit.increment; }

  void take_row(const Row& row) {
    columns_.check_width(row);
    const bool gyro = !gyro_.is_blank(row);
    const bool accel = !accel_.is_blank(row);
    if (!gyro && !accel) {
      ++blank_;
    } else if (!halves_seen_ && gyro && accel) {
      take(parse(row));
    } else {
      take_halves(row, gyro, accel);
    }
  }

  void finish() {
    over_ = true;
    for (const imu::ImuSample& sample : halves_.take(std::numeric_limits<int64_t>::max())) {
      take(with_wheel(sample));
    }
    end_group(std::nullopt);
  }

  Sample parse(const Row& row) {
    Sample sample;
    imu::ImuSample& imu = sample.imu;
    imu.gyro_b = gyro_.value(row);
    imu.accel_b = accel_.value(row);
    if (wheel_speed_) sample.wheel_speed = row.number(*wheel_speed_) * wheel_factor_;
    imu.t_ns = time_.stamp(row);
    // Of one stamp but another sample: a burst, see BurstStamps. Increments need their interval.
    const bool differs = imu.gyro_b != last_.gyro_b || imu.accel_b != last_.accel_b;
    order_.check(row, imu.t_ns, shared_ || (differs && !has_increments()));
    last_ = imu;
    return sample;
  }

  /// A row of one of the two, or of both where others are of one.
  void take_halves(const Row& row, bool gyro, bool accel) {
    if (has_increments()) {
      row.fail(
          "its gyroscope or its accelerometer is blank, and increments cannot be joined; correct "
          "or remove the row");
    }
    const Eigen::Vector3d rate = gyro ? gyro_.value(row) : Eigen::Vector3d::Zero();
    const Eigen::Vector3d force = accel ? accel_.value(row) : Eigen::Vector3d::Zero();
    const bool wheel = wheel_speed_ && !row.is_blank(*wheel_speed_);
    const double speed = wheel ? row.number(*wheel_speed_) * wheel_factor_ : 0;
    const int64_t t_ns = time_.stamp(row);
    if (gyro) order_.check(row, t_ns);
    if (accel) accel_order_.check(row, t_ns);
    halves_seen_ = true;
    if (gyro) halves_.add_gyro(t_ns, rate);
    if (gyro && wheel) wheels_[t_ns] = speed;
    if (!accel) return;
    halves_.add_accel(t_ns, force);
    for (const imu::ImuSample& sample : halves_.take(t_ns)) take(with_wheel(sample));
  }

  Sample with_wheel(const imu::ImuSample& sample) {
    const auto found = wheels_.find(sample.t_ns);
    if (found == wheels_.end()) return {sample, {}};
    const double speed = found->second;
    wheels_.erase(wheels_.begin(), std::next(found));
    return {sample, speed};
  }

  void take(const Sample& sample) {
    if (!shared_) return convert(sample);
    if (!group_.empty() && group_.front().imu.t_ns != sample.imu.t_ns) end_group(sample.imu.t_ns);
    group_.push_back(sample);
  }

  /// Of rows that share a stamp; those that follow have the stamp `next_ns`.
  void end_group(std::optional<int64_t> next_ns) {
    if (group_.empty()) return;
    const int64_t t_ns = group_.front().imu.t_ns;
    const std::vector<int64_t> even =
        shared_->spread(t_ns, group_.size(), shared_->of_first ? next_ns : last_group_ns_);
    for (size_t i = 0; i < even.size(); ++i) {
      group_[i].imu.t_ns = even[i];
      convert(group_[i]);
    }
    last_group_ns_ = t_ns;
    group_.clear();
  }

  void convert(const Sample& sample) {
    if (!has_increments()) return put(sample, sample.imu);
    const std::optional<int64_t> length_ns = lengths_.ending_at(sample.imu.t_ns);
    if (!length_ns) {
      first_ = sample;
      return;
    }
    if (first_) put(*first_, increment(first_->imu, *length_ns));
    first_.reset();
    put(sample, increment(sample.imu, *length_ns));
  }

  ImuIncrement increment(const imu::ImuSample& sample, int64_t length_ns) const {
    ImuIncrement increment;
    increment.t_begin_ns = sample.t_ns - length_ns;
    increment.t_end_ns = sample.t_ns;
    increment.dtheta_b = gyro_.increment(sample.gyro_b, increment.dt());
    increment.dvel_b = accel_.increment(sample.accel_b, increment.dt());
    return increment;
  }

  void put(const Sample& sample, Record record) {
    if (sample.wheel_speed) ready_.push_back(WheelSpeed{sample.imu.t_ns, *sample.wheel_speed});
    ready_.push_back(std::move(record));
  }

  Notices notices_;
  TextTable table_;
  Columns columns_;
  TimeColumn time_;
  ImuVector gyro_;
  ImuVector accel_;
  std::optional<size_t> wheel_speed_;
  double wheel_factor_;
  StampOrder order_, accel_order_;
  imu::ImuSample last_;
  ImuHalves halves_;
  bool halves_seen_ = false;
  std::map<int64_t, double> wheels_;  ///< of rows that wait for their accelerometer
  std::optional<SharedStamps> shared_;
  std::vector<Sample> group_;  ///< rows of the last stamp, if stamps are shared
  std::optional<int64_t> last_group_ns_;
  IntervalLengths lengths_;
  std::optional<Sample> first_;  ///< of increments, waits for its length
  std::deque<Record> ready_;
  int64_t blank_ = 0;
  bool over_ = false;
};

/// Lengths of the forces of the first rows, read as m/s^2, and their stamps.
struct FirstRows {
  std::vector<double> lengths;
  std::vector<int64_t> stamps_ns;

  /// Time between rows [s].
  double step() const {
    if (stamps_ns.size() < 2) return 0;
    return seconds_between(stamps_ns.front(), stamps_ns.back()) /
           static_cast<double>(stamps_ns.size() - 1);
  }
};

FirstRows first_rows(ImuMapping mapping, const std::string& path) {
  constexpr size_t kEnough = 5000;
  mapping.accel_unit = "m_s2";
  mapping.gyro_unit = "rad_s";
  ImuReader reader({mapping, {}, {}}, path);
  FirstRows first;
  for (bool over = false; !over && first.lengths.size() < kEnough;) {
    try {
      const std::optional<Record> record = reader.next();
      over = !record;
      const auto* sample = over ? nullptr : std::get_if<imu::ImuSample>(&*record);
      if (sample == nullptr || !sample->accel_b.allFinite()) continue;
      first.lengths.push_back(sample->accel_b.norm());
      first.stamps_ns.push_back(sample->t_ns);
    } catch (const RowError&) {  // told when the table is read
    }
  }
  return first;
}

void find_counts(ImuTable& found, const std::string& path) {
  std::string& counts = found.mapping.counts;
  if (counts != "auto") return;
  counts = "decimal";
  TextTable table = open_mapped_table(path);
  const Columns columns(found.mapping, table, "imu", imu_roles());
  std::vector<size_t> cells;
  for (const Roles& roles : {kGyro, kAccel}) {
    for (const size_t column : three(columns, roles)) cells.push_back(column);
  }
  const CountFormat format = count_format_of(table, cells);
  if (format == CountFormat::decimal) return;
  counts = format == CountFormat::hex ? "hex" : "uint16";
  found.notices.push_back(
      fmt::format("{}: its counts are read as {}; if that is wrong, give imu.counts", path,
                  format == CountFormat::hex ? "hexadecimal numbers (two's complement)"
                                             : "unsigned numbers of 16 bits (two's complement)"));
}

void find_units(ImuTable& found, const FirstRows& first, const std::string& path) {
  std::string& accel = found.mapping.accel_unit;
  std::string& gyro = found.mapping.gyro_unit;
  if (accel == "auto") {
    accel = unit_by_gravity(first.lengths, first.step()).value_or("m_s2");
    if (accel != "m_s2") {
      found.notices.push_back(
          fmt::format("{}: gravity is {:.4g} in it, so that its accelerometer is read in {}; if "
                      "that is wrong, give imu.accel_unit",
                      path, median(first.lengths), accel));
    }
  }
  if (gyro != "auto") return;
  const bool increments = unit_of(acceleration_units(), accel).increment;
  gyro = increments ? "rad" : "rad_s";
  if (increments) {
    found.notices.push_back(
        fmt::format("{}: beside increments of velocity its gyroscope is read as increments in rad; "
                    "if that is wrong, give imu.gyro_unit",
                    path));
  }
}

/// With what the mapping leaves to the data.
ImuTable look_at(const ImuMapping& mapping, const std::string& path) {
  ImuTable found{mapping, {}, {}};
  found.notices = find_clock(found.mapping, path, "imu");
  find_counts(found, path);
  const FirstRows first = first_rows(found.mapping, path);
  find_units(found, first, path);
  const bool increments = unit_of(rate_units(), found.mapping.gyro_unit).increment ||
                          unit_of(acceleration_units(), found.mapping.accel_unit).increment;
  found.shared = SharedStamps::of(first.stamps_ns, increments);
  if (found.shared) found.notices.push_back(fmt::format("{}: {}", path, found.shared->notice()));
  return found;
}

// GNSS ------------------------------------------------------------------------------------------

/// Fix quality of a row; none where the receiver has no position.
class QualityColumn {
 public:
  QualityColumn(const GnssMapping& mapping, const Columns& columns)
      : constant_(fix_quality(mapping.quality).value_or(FixQuality::unknown)) {
    if (!columns.has("quality")) return;
    column_ = columns.of("quality");
    if (mapping.quality_table.empty()) {
      throw UsageError(
          "gnss.quality_table is missing; the quality column needs it, e.g. "
          "{1: fixed_rtk, 2: float_rtk, 5: single, 0: none}");
    }
    for (const auto& [value, name] : mapping.quality_table) {
      const std::optional<FixQuality> quality = fix_quality(name);
      if (!quality && name != "none") {
        throw UsageError(
            fmt::format("gnss.quality_table: '{}' is no quality; known: none, unknown, "
                        "single, differential, ppp, float_rtk, fixed_rtk",
                        name));
      }
      table_[value] = quality;
    }
  }

  std::optional<FixQuality> quality(const Row& row) const {
    if (!column_) return constant_;
    const std::string value(row.text(*column_));
    const auto found = table_.find(value);
    if (found == table_.end()) {
      row.fail(
          fmt::format("quality '{}' is not in gnss.quality_table; add it to the mapping", value));
    }
    return found->second;
  }

 private:
  FixQuality constant_;
  std::optional<size_t> column_;
  std::map<std::string, std::optional<FixQuality>> table_;
};

/// A sigma where it is told: not blank, not zero.
std::optional<double> told_sigma(const Row& row, size_t column) {
  const bool told = !row.is_blank(column) && row.number(column) != 0;
  return told ? std::optional(row.sigma(column)) : std::nullopt;
}

[[noreturn]] void fail_without_sigma(const Row& row, size_t column, const char* constant) {
  row.fail(
      fmt::format("the sigma in column {} is '{}', it must be greater than zero; give {}: [north, "
                  "east, down] for rows like this or, if all are unknown, leave the columns out "
                  "and give it; else correct or remove the row",
                  column + 1, row.text(column), constant));
}

/// Position sigmas of a row, along north, east, down or along the axes of the Earth-fixed frame.
class SigmaColumns {
 public:
  SigmaColumns(const GnssMapping& mapping, const Columns& columns)
      : factor_(unit_of(length_units(), mapping.sigma_unit).factor) {
    if (mapping.sigma_m.size() == 3) constant_ = Eigen::Vector3d(mapping.sigma_m.data());
    static const Roles kEarthFixed{"sigma_x", "sigma_y", "sigma_z"};
    earth_fixed_ = columns.has_all(kEarthFixed);
    const bool one = !columns.has("sigma_north") && columns.has("sigma_horizontal");
    const Roles roles = earth_fixed_ ? kEarthFixed
                        : one ? Roles{"sigma_horizontal", "sigma_horizontal", "sigma_vertical"}
                              : Roles{"sigma_north", "sigma_east", "sigma_down"};
    for (size_t i = 0; i < 3; ++i) columns_[i] = columns.find(roles[i]);
    const bool whole = std::all_of(columns_.begin(), columns_.end(),
                                   [](const auto& column) { return column.has_value(); });
    if (whole || constant_) return;
    throw UsageError(
        "gnss: sigmas are missing; name columns sigma_north, sigma_east, sigma_down "
        "(or sigma_horizontal, sigma_vertical, or sigma_x, sigma_y, sigma_z), or give sigma_m: "
        "[north, east, down]");
  }

  /// Of a row with that position, along north, east, down.
  Eigen::Matrix3d covariance(const Row& row, const Geodetic& at) const {
    std::array<std::optional<double>, 3> told;
    for (size_t i = 0; i < 3; ++i) {
      if (columns_[i]) told[i] = told_sigma(row, *columns_[i]);
      if (columns_[i] && !told[i] && !constant_) {
        fail_without_sigma(row, *columns_[i], "gnss.sigma_m");
      }
    }
    if (earth_fixed_) return along_ned(told, at);
    Eigen::Vector3d sigma = constant_.value_or(Eigen::Vector3d::Zero());
    for (int i = 0; i < 3; ++i) {
      if (told[static_cast<size_t>(i)]) sigma[i] = *told[static_cast<size_t>(i)] * factor_;
    }
    return sigma.cwiseAbs2().asDiagonal();
  }

 private:
  Eigen::Matrix3d along_ned(const std::array<std::optional<double>, 3>& told,
                            const Geodetic& at) const {
    if (!told[0] || !told[1] || !told[2]) return constant_->cwiseAbs2().asDiagonal();
    const Eigen::Vector3d sigma_e = Eigen::Vector3d(*told[0], *told[1], *told[2]) * factor_;
    const Eigen::Matrix3d R_n_e = geodesy::wgs84::R_e_n(at.latitude, at.longitude).transpose();
    return R_n_e * sigma_e.cwiseAbs2().asDiagonal() * R_n_e.transpose();
  }

  double factor_;
  std::array<std::optional<size_t>, 3> columns_;
  bool earth_fixed_ = false;
  std::optional<Eigen::Vector3d> constant_;  ///< where no column tells
};

/// Velocity of a fix with its covariance: a vector, or a speed along a bearing.
class GnssVelocity {
 public:
  GnssVelocity(const GnssMapping& mapping, const Columns& columns) {
    if (!mapping.velocity) return;
    vector_ = VelocityColumns::find(mapping, columns);
    if (!vector_ && columns.has("speed") && columns.has("bearing")) {
      speed_ = columns.of("speed");
      bearing_ = columns.of("bearing");
    }
    if (!vector_ && !speed_) return;
    bearing_scale_ = unit_of(bearing_units(), mapping.bearing_unit).factor;
    factor_ = unit_of(speed_units(), mapping.velocity_unit).factor;
    sigma_column_ = columns.find("sigma_velocity");
    if (mapping.velocity_sigma_m_s.size() == 3) {
      sigma_ = Eigen::Vector3d(mapping.velocity_sigma_m_s.data());
    } else if (!sigma_column_) {
      throw UsageError(
          "gnss: the velocity's sigmas are missing; name a column sigma_velocity, give "
          "velocity_sigma_m_s: [north, east, down], or leave the velocity out with "
          "velocity: false");
    }
  }

  /// A row may have none.
  void add_to(GnssFix& fix, const Row& row) const {
    if ((!vector_ && !speed_) || is_blank(row)) return;
    fix.velocity_n = vector_ ? vector_->velocity(row, fix.antenna) : along_ground(row);
    fix.velocity_covariance = sigma(row).cwiseAbs2().asDiagonal();
  }

 private:
  bool is_blank(const Row& row) const {
    if (sigma_column_ && row.is_blank(*sigma_column_) && !sigma_) return true;
    return vector_ ? vector_->is_blank(row) : row.is_blank(*speed_) || row.is_blank(bearing_);
  }

  Eigen::Vector3d along_ground(const Row& row) const {
    const double speed = row.number(*speed_) * factor_;
    const double bearing = row.number(bearing_) * bearing_scale_;
    constexpr double kTurn = 2 * kPi + 1e-9;
    if (std::abs(bearing) > kTurn) {
      row.fail(
          fmt::format("column {} is '{}', no bearing; give gnss.bearing_unit (deg, rad, or e5 for "
                      "1e-5 deg), else correct or remove the row",
                      bearing_ + 1, row.text(bearing_)));
    }
    return {speed * std::cos(bearing), speed * std::sin(bearing), 0};
  }

  Eigen::Vector3d sigma(const Row& row) const {
    const std::optional<double> told =
        sigma_column_ ? told_sigma(row, *sigma_column_) : std::nullopt;
    if (!told && !sigma_) fail_without_sigma(row, *sigma_column_, "gnss.velocity_sigma_m_s");
    if (!told) return *sigma_;
    const double sigma = *told * factor_;
    return {sigma, sigma, speed_ ? kOpenVerticalSigma : sigma};
  }

  std::optional<VelocityColumns> vector_;
  std::optional<size_t> speed_;
  size_t bearing_ = 0;
  double bearing_scale_ = kDegree;
  double factor_ = 1;
  std::optional<size_t> sigma_column_;
  std::optional<Eigen::Vector3d> sigma_;  ///< where no column tells
};

/// Heading of two antennas of a row with its sigma.
class HeadingColumns {
 public:
  HeadingColumns(const GnssMapping& mapping, const Columns& columns)
      : column_(columns.find("heading")),
        sigma_column_(columns.find("sigma_heading")),
        to_radians_(mapping.heading_unit == "rad" ? 1 : kDegree) {
    if (mapping.heading_sigma_deg) sigma_ = *mapping.heading_sigma_deg * kDegree;
    if (!column_ || sigma_column_ || sigma_) return;
    throw UsageError(
        "gnss: the heading's sigma is missing; name a column sigma_heading, or give "
        "heading_sigma_deg");
  }

  /// A row may have none.
  void add_to(GnssFix& fix, const Row& row) const {
    if (!column_ || row.is_blank(*column_)) return;
    const std::optional<double> told =
        sigma_column_ ? told_sigma(row, *sigma_column_) : std::nullopt;
    if (!told && !sigma_) return;
    fix.heading = GnssHeading{so3::wrap(row.number(*column_) * to_radians_),
                              told ? *told * to_radians_ : *sigma_};
  }

 private:
  std::optional<size_t> column_, sigma_column_;
  double to_radians_;
  std::optional<double> sigma_;  ///< where no column tells [rad]
};

Roles gnss_roles() {
  return joined({position_roles(),
                 velocity_roles(),
                 {"speed", "bearing", "sigma_velocity", "sigma_north", "sigma_east", "sigma_down",
                  "sigma_horizontal", "sigma_vertical", "heading", "sigma_heading", "sigma_x",
                  "sigma_y", "sigma_z", "quality", "satellites", "hdop", "correction_age"}});
}

class GnssReader : public RecordReader {
 public:
  /// The mapping's units are no longer `auto`.
  GnssReader(const GnssMapping& mapping, const std::string& path, std::vector<std::string> notices)
      : notices_(std::move(notices)),
        table_(open_mapped_table(path)),
        columns_(mapping, table_, "gnss", gnss_roles()),
        time_(mapping.time, columns_),
        position_(mapping, columns_, path),
        sigma_(mapping, columns_),
        velocity_(mapping, columns_),
        heading_(mapping, columns_),
        quality_(mapping, columns_),
        details_{columns_.find("satellites"), columns_.find("hdop"),
                 columns_.find("correction_age")} {}

  const TextTable& table() const override { return table_; }
  int64_t without_fix() const override { return without_fix_; }
  Notices notices() const override { return joined(notices_, columns_, table_); }

  std::optional<Record> next() override {
    while (const Row* row = table_.next()) {
      columns_.check_width(*row);
      const std::optional<FixQuality> quality =
          position_.is_blank(*row) ? std::nullopt : quality_.quality(*row);
      if (quality) return parse(*row, *quality);
      ++without_fix_;
    }
    return std::nullopt;
  }

 private:
  GnssFix parse(const Row& row, FixQuality quality) {
    GnssFix fix;
    fix.quality = quality;
    fix.antenna = position_.position(row);
    fix.position_covariance = sigma_.covariance(row, fix.antenna);
    velocity_.add_to(fix, row);
    heading_.add_to(fix, row);
    fix.details = details(row);
    fix.t_ns = time_.stamp(row);
    order_.check(row, fix.t_ns);
    return fix;
  }

  /// Blank and zero: not told.
  FixDetails details(const Row& row) const {
    std::array<std::optional<double>, 3> told;
    for (size_t i = 0; i < told.size(); ++i) {
      if (!details_[i] || row.is_blank(*details_[i])) continue;
      const double value = row.number(*details_[i]);
      if (value > 0) told[i] = value;
    }
    FixDetails details;
    if (told[0]) details.satellites = static_cast<int>(std::min(*told[0], 255.0));
    details.hdop = told[1];
    details.correction_age = told[2];
    return details;
  }

  std::vector<std::string> notices_;
  TextTable table_;
  Columns columns_;
  TimeColumn time_;
  PositionColumns position_;
  SigmaColumns sigma_;
  GnssVelocity velocity_;
  HeadingColumns heading_;
  QualityColumn quality_;
  std::array<std::optional<size_t>, 3> details_;  ///< satellites, HDOP, age of corrections
  StampOrder order_;
  int64_t without_fix_ = 0;
};

// Reference -------------------------------------------------------------------------------------

const Roles kEuler{"roll", "pitch", "heading"};

Roles reference_roles() { return joined({position_roles(), velocity_roles(), kEuler}); }

class ReferenceReader : public RecordReader {
 public:
  /// The mapping's units are no longer `auto`.
  ReferenceReader(const ReferenceMapping& mapping, const std::string& path,
                  std::vector<std::string> notices)
      : notices_(std::move(notices)),
        table_(open_mapped_table(path)),
        columns_(mapping, table_, "reference", reference_roles()),
        time_(mapping.time, columns_),
        position_(mapping, columns_, path),
        velocity_(VelocityColumns::find(mapping, columns_)),
        to_radians_(angle_factor(mapping.angle_unit)) {
    if (columns_.has_all(kEuler)) euler_ = three(columns_, kEuler);
  }

  const TextTable& table() const override { return table_; }
  int64_t without_fix() const override { return blank_; }
  Notices notices() const override { return joined(notices_, columns_, table_); }

  std::optional<Record> next() override {
    while (const Row* row = table_.next()) {
      columns_.check_width(*row);
      if (!position_.is_blank(*row)) return parse(*row);
      ++blank_;
    }
    return std::nullopt;
  }

 private:
  ReferencePose parse(const Row& row) {
    ReferencePose pose;
    pose.position = position_.position(row);
    if (velocity_ && !velocity_->is_blank(row))
      pose.velocity_n = velocity_->velocity(row, pose.position);
    if (euler_) {
      const Eigen::Vector3d euler = vector(row, *euler_) * to_radians_;
      pose.q_n_v = so3::from_euler({euler.x(), euler.y(), euler.z()});
    }
    pose.t_ns = time_.stamp(row);
    order_.check(row, pose.t_ns);
    return pose;
  }

  std::vector<std::string> notices_;
  TextTable table_;
  Columns columns_;
  TimeColumn time_;
  PositionColumns position_;
  std::optional<VelocityColumns> velocity_;
  std::optional<std::array<size_t, 3>> euler_;
  double to_radians_;
  StampOrder order_;
  int64_t blank_ = 0;
};

// Wheels ----------------------------------------------------------------------------------------

class WheelReader : public RecordReader {
 public:
  WheelReader(const WheelMapping& mapping, const std::string& path,
              std::vector<std::string> notices)
      : notices_(std::move(notices)),
        table_(open_mapped_table(path)),
        columns_(mapping, table_, "wheel", joined({{"speed"}})),
        time_(mapping.time, columns_),
        speed_(columns_.of("speed")),
        factor_(unit_of(speed_units(), mapping.speed_unit).factor) {}

  const TextTable& table() const override { return table_; }
  int64_t without_fix() const override { return blank_; }
  Notices notices() const override { return joined(notices_, columns_, table_); }

  std::optional<Record> next() override {
    while (const Row* row = table_.next()) {
      columns_.check_width(*row);
      if (!row->is_blank(speed_)) return parse(*row);
      ++blank_;
    }
    return std::nullopt;
  }

 private:
  WheelSpeed parse(const Row& row) {
    WheelSpeed wheel;
    wheel.forward = row.number(speed_) * factor_;
    wheel.t_ns = time_.stamp(row);
    order_.check(row, wheel.t_ns);
    return wheel;
  }

  std::vector<std::string> notices_;
  TextTable table_;
  Columns columns_;
  TimeColumn time_;
  size_t speed_;
  double factor_;
  StampOrder order_;
  int64_t blank_ = 0;
};

}  // namespace

ImportMapping load_mapping(const MappingSource& source) {
  ImportMapping mapping;
  load_config(source.mapping, mapping);
  naming_mapping(source.mapping, [&] {
    check_lines(mapping.imu, "imu");
    check_lines(mapping.gnss, "gnss");
    check_lines(mapping.reference, "reference");
    check_lines(mapping.wheel, "wheel");
    check_lines(mapping.gnss.quality_table, "gnss.quality_table");
    for (const std::string& axis : mapping.imu.axes) check_line(axis, "imu.axes");
  });
  return mapping;
}

std::optional<std::string> input_path(const MappingSource& source,
                                      const std::optional<std::string>& given,
                                      const std::string& file) {
  if (given) return given;
  if (file.empty()) return std::nullopt;
  const fs::path folder =
      source.data_dir ? fs::path(*source.data_dir) : fs::path(source.mapping).parent_path();
  return (folder / file).string();  // an absolute `file` stays what it is
}

ImportMapping add_tables(const MappingSource& source, const TableFiles& given,
                         ImportInputs& inputs) {
  if (source.mapping.empty() && (given.imu || given.reference || given.wheel)) {
    throw UsageError("--imu, --reference and --wheel need --mapping, which names their columns");
  }
  ImportMapping mapping = source.mapping.empty() ? ImportMapping{} : load_mapping(source);
  const auto imu_path = input_path(source, given.imu, mapping.imu.file);
  const auto reference_path = input_path(source, given.reference, mapping.reference.file);
  const auto wheel_path = input_path(source, given.wheel, mapping.wheel.file);
  naming_mapping(source.mapping, [&] {
    if (imu_path) inputs.imu = make_imu_reader(mapping.imu, *imu_path);
    if (reference_path) {
      inputs.reference = make_reference_reader(mapping.reference, *reference_path);
    }
    if (wheel_path) inputs.wheel = make_wheel_reader(mapping.wheel, *wheel_path);
    inputs.mounting = mapping.imu.mounting();
    inputs.lever_arm_v = mapping.lever_arm();
  });
  inputs.sensor = mapping.imu.sensor;
  inputs.mapping = source.mapping;
  return mapping;
}

std::unique_ptr<RecordReader> make_imu_reader(const ImuMapping& mapping, const std::string& path) {
  return std::make_unique<ImuReader>(look_at(mapping, path), path);
}

std::unique_ptr<RecordReader> make_gnss_reader(const GnssMapping& mapping,
                                               const std::string& path) {
  GnssMapping found = mapping;
  Notices notices = find_clock(found, path, "gnss");
  append(notices, find_units(found, &found.bearing_unit, "gnss", gnss_roles(), path));
  return std::make_unique<GnssReader>(found, path, notices);
}

std::unique_ptr<RecordReader> make_reference_reader(const ReferenceMapping& mapping,
                                                    const std::string& path) {
  ReferenceMapping found = mapping;
  Notices notices = find_clock(found, path, "reference");
  append(notices, find_units(found, nullptr, "reference", reference_roles(), path));
  return std::make_unique<ReferenceReader>(found, path, notices);
}

std::unique_ptr<RecordReader> make_wheel_reader(const WheelMapping& mapping,
                                                const std::string& path) {
  WheelMapping found = mapping;
  Notices notices = find_clock(found, path, "wheel");
  return std::make_unique<WheelReader>(found, path, notices);
}

double height_offset(const std::string& height, const std::optional<double>& separation,
                     const std::string& section) {
  if (height == "ellipsoidal") return 0;
  if (separation) return *separation;
  throw UsageError(fmt::format(
      "{}.geoid_separation_m is missing; heights above mean sea level need it (ellipsoidal = msl + "
      "separation; 50 m off do no harm, 0 is allowed)",
      section));
}

}  // namespace foucault::rawlog
