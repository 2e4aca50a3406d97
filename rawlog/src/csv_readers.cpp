#include "csv_readers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <filesystem>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/median.h"
#include "foucault/core/so3.h"
#include "nmea_accuracy.h"
#include "position_columns.h"
#include "table_units.h"
#include "time_column.h"
#include "unit_search.h"

namespace foucault::rawlog {

namespace fs = std::filesystem;

namespace {

/// What GNSS tables and references have in common.
const Roles kPosition{"latitude",
                      "longitude",
                      "height",
                      "latitude_minutes",
                      "latitude_seconds",
                      "latitude_hemisphere",
                      "longitude_minutes",
                      "longitude_seconds",
                      "longitude_hemisphere",
                      "east",
                      "north",
                      "up"};

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

/// What was assumed of a table.
Notices joined(Notices notices, const Columns& columns, const TextTable& table) {
  const Notices of_table = table.notices();
  notices.insert(notices.end(), columns.notices().begin(), columns.notices().end());
  notices.insert(notices.end(), of_table.begin(), of_table.end());
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

class ImuReader : public RecordReader {
 public:
  /// The mapping's units are no longer `auto`.
  ImuReader(const ImuMapping& mapping, const std::string& path, Notices notices)
      : notices_(std::move(notices)),
        table_(open_mapped_table(path)),
        columns_(mapping, table_, "imu",
                 joined({{"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z",
                          "wheel_speed"}})),
        time_(mapping.time, columns_),
        gyro_{three(columns_, {"gyro_x", "gyro_y", "gyro_z"}), mapping.gyro_scale,
              unit_of(rate_units(), mapping.gyro_unit)},
        accel_{three(columns_, {"accel_x", "accel_y", "accel_z"}),
               (mapping.accel_sign == "-1" ? -1 : 1) * mapping.accel_scale,
               unit_of(acceleration_units(), mapping.accel_unit)},
        wheel_speed_(columns_.find("wheel_speed")),
        wheel_factor_(unit_of(speed_units(), mapping.wheel_speed_unit).factor) {}

  const TextTable& table() const override { return table_; }
  int64_t without_fix() const override { return blank_; }
  Notices notices() const override { return joined(notices_, columns_, table_); }

  std::optional<Record> next() override {
    while (ready_.empty()) {
      const Row* row = table_.next();
      if (row == nullptr) return std::nullopt;
      columns_.check_width(*row);
      if (gyro_.is_blank(*row) && accel_.is_blank(*row)) {
        ++blank_;
      } else {
        take(parse(*row));
      }
    }
    Record record = std::move(ready_.front());
    ready_.pop_front();
    return record;
  }

 private:
  /// A rate, or what came together since the row before.
  struct Vector {
    std::array<size_t, 3> columns;
    double scale;
    Unit unit;

    bool is_blank(const Row& row) const {
      return std::all_of(columns.begin(), columns.end(), [&](size_t c) { return row.is_blank(c); });
    }
    Eigen::Vector3d value(const Row& row) const {
      return vector(row, columns) * (scale * unit.factor);
    }
    Eigen::Vector3d increment(const Eigen::Vector3d& value, double dt) const {
      return unit.increment ? value : value * dt;
    }
  };

  struct Sample {
    imu::ImuSample imu;
    std::optional<double> wheel_speed;
  };

  bool has_increments() const { return gyro_.unit.increment || accel_.unit.increment; }

  Sample parse(const Row& row) {
    Sample sample;
    imu::ImuSample& imu = sample.imu;
    imu.gyro_b = gyro_.value(row);
    imu.accel_b = accel_.value(row);
    if (wheel_speed_) sample.wheel_speed = row.number(*wheel_speed_) * wheel_factor_;
    imu.t_ns = time_.stamp(row);
    // Of one stamp but another sample: a burst, see BurstStamps. Increments need their interval.
    order_.check(row, imu.t_ns,
                 !has_increments() && (imu.gyro_b != last_.gyro_b || imu.accel_b != last_.accel_b));
    last_ = imu;
    return sample;
  }

  void take(const Sample& sample) {
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
  Vector gyro_;
  Vector accel_;
  std::optional<size_t> wheel_speed_;
  double wheel_factor_;
  StampOrder order_;
  imu::ImuSample last_;
  IntervalLengths lengths_;
  std::optional<Sample> first_;  ///< of increments, waits for its length
  std::deque<Record> ready_;
  int64_t blank_ = 0;
};

/// Lengths of the forces of the first rows, read as m/s^2, and the time between rows [s].
struct FirstForces {
  std::vector<double> lengths;
  double step = 0;
};

FirstForces first_forces(ImuMapping mapping, const std::string& path) {
  constexpr size_t kEnough = 5000;
  mapping.accel_unit = "m_s2";
  mapping.gyro_unit = "rad_s";
  ImuReader reader(mapping, path, {});
  FirstForces first;
  std::optional<int64_t> begin_ns;
  int64_t end_ns = 0;
  for (bool over = false; !over && first.lengths.size() < kEnough;) {
    try {
      const std::optional<Record> record = reader.next();
      over = !record;
      const auto* sample = over ? nullptr : std::get_if<imu::ImuSample>(&*record);
      if (sample == nullptr || !sample->accel_b.allFinite()) continue;
      first.lengths.push_back(sample->accel_b.norm());
      if (!begin_ns) begin_ns = sample->t_ns;
      end_ns = sample->t_ns;
    } catch (const RowError&) {  // told when the table is read
    }
  }
  if (first.lengths.size() > 1) {
    first.step = seconds_between(*begin_ns, end_ns) / static_cast<double>(first.lengths.size() - 1);
  }
  return first;
}

struct FoundUnits {
  ImuMapping mapping;
  Notices notices;
};

/// With the units that are left to the data.
FoundUnits with_units(const ImuMapping& mapping, const std::string& path) {
  FoundUnits out{mapping, {}};
  out.notices = find_clock(out.mapping, path, "imu");
  std::string& accel = out.mapping.accel_unit;
  std::string& gyro = out.mapping.gyro_unit;
  const bool found = accel == "auto";
  if (found) {
    const FirstForces first = first_forces(out.mapping, path);
    accel = unit_by_gravity(first.lengths, first.step).value_or("m_s2");
    if (accel != "m_s2") {
      out.notices.push_back(
          fmt::format("{}: gravity is {:.4g} in it, so that its accelerometer is read in {}; if "
                      "that is wrong, give imu.accel_unit",
                      path, median(first.lengths), accel));
    }
  }
  if (gyro != "auto") return out;
  const bool increments = unit_of(acceleration_units(), accel).increment;
  gyro = increments ? "rad" : "rad_s";
  if (increments) {
    out.notices.push_back(
        fmt::format("{}: beside increments of velocity its gyroscope is read as increments in rad; "
                    "if that is wrong, give imu.gyro_unit",
                    path));
  }
  return out;
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

/// Position sigmas north, east, down of a row.
class SigmaColumns {
 public:
  SigmaColumns(const GnssMapping& mapping, const Columns& columns)
      : factor_(unit_of(length_units(), mapping.sigma_unit).factor) {
    const bool is_constant = mapping.sigma_m.size() == 3;
    if (is_constant) constant_ = Eigen::Vector3d(mapping.sigma_m.data());
    const bool one = !columns.has("sigma_north") && columns.has("sigma_horizontal");
    columns_ = {columns.find(one ? "sigma_horizontal" : "sigma_north"),
                columns.find(one ? "sigma_horizontal" : "sigma_east"),
                columns.find(one ? "sigma_vertical" : "sigma_down")};
    const bool whole = std::all_of(columns_.begin(), columns_.end(),
                                   [](const auto& column) { return column.has_value(); });
    if (whole || is_constant) return;
    throw UsageError(
        "gnss: sigmas are missing; name columns sigma_north, sigma_east, sigma_down "
        "(or sigma_horizontal, sigma_vertical), or give sigma_m: [north, east, "
        "down]");
  }

  Eigen::Matrix3d covariance(const Row& row) const {
    Eigen::Vector3d sigma = constant_;
    for (size_t i = 0; i < 3; ++i) {
      if (!columns_[i]) continue;
      sigma[static_cast<int>(i)] = row.sigma(*columns_[i], "gnss.sigma_m") * factor_;
    }
    return sigma.cwiseAbs2().asDiagonal();
  }

 private:
  double factor_;
  std::array<std::optional<size_t>, 3> columns_;
  Eigen::Vector3d constant_ = Eigen::Vector3d::Zero();  ///< where there is no column
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
    bearing_scale_ = angle_factor(mapping.angle_unit);
    factor_ = unit_of(speed_units(), mapping.velocity_unit).factor;
    sigma_column_ = columns.find("sigma_velocity");
    if (sigma_column_) return;
    if (mapping.velocity_sigma_m_s.size() == 3) {
      sigma_ = Eigen::Vector3d(mapping.velocity_sigma_m_s.data());
    } else {
      throw UsageError(
          "gnss: the velocity's sigmas are missing; name a column sigma_velocity, give "
          "velocity_sigma_m_s: [north, east, down], or leave the velocity out with "
          "velocity: false");
    }
  }

  /// A row may have none.
  void add_to(GnssFix& fix, const Row& row) const {
    if ((!vector_ && !speed_) || is_blank(row)) return;
    fix.velocity_n = vector_ ? vector_->velocity(row) : along_ground(row);
    fix.velocity_covariance = sigma(row).cwiseAbs2().asDiagonal();
  }

 private:
  bool is_blank(const Row& row) const {
    if (sigma_column_ && row.is_blank(*sigma_column_)) return true;
    return vector_ ? vector_->is_blank(row) : row.is_blank(*speed_) || row.is_blank(bearing_);
  }

  Eigen::Vector3d along_ground(const Row& row) const {
    const double speed = row.number(*speed_) * factor_;
    const double bearing = row.number(bearing_) * bearing_scale_;
    return {speed * std::cos(bearing), speed * std::sin(bearing), 0};
  }

  Eigen::Vector3d sigma(const Row& row) const {
    if (!sigma_column_) return sigma_;
    const double sigma = row.sigma(*sigma_column_, "gnss.velocity_sigma_m_s") * factor_;
    return {sigma, sigma, speed_ ? kOpenVerticalSigma : sigma};
  }

  std::optional<VelocityColumns> vector_;
  std::optional<size_t> speed_;
  size_t bearing_ = 0;
  double bearing_scale_ = kDegree;
  double factor_ = 1;
  std::optional<size_t> sigma_column_;
  Eigen::Vector3d sigma_ = Eigen::Vector3d::Zero();
};

class GnssReader : public RecordReader {
 public:
  GnssReader(const GnssMapping& mapping, const std::string& path, Notices notices)
      : notices_(std::move(notices)),
        table_(open_mapped_table(path)),
        columns_(mapping, table_, "gnss",
                 joined({kPosition,
                         velocity_roles(),
                         {"speed", "bearing", "sigma_velocity", "sigma_north", "sigma_east",
                          "sigma_down", "sigma_horizontal", "sigma_vertical", "quality",
                          "satellites", "hdop", "correction_age"}})),
        time_(mapping.time, columns_),
        position_(mapping, columns_, path),
        sigma_(mapping, columns_),
        velocity_(mapping, columns_),
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
    fix.position_covariance = sigma_.covariance(row);
    velocity_.add_to(fix, row);
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

  Notices notices_;
  TextTable table_;
  Columns columns_;
  TimeColumn time_;
  PositionColumns position_;
  SigmaColumns sigma_;
  GnssVelocity velocity_;
  QualityColumn quality_;
  std::array<std::optional<size_t>, 3> details_;  ///< satellites, HDOP, age of corrections
  StampOrder order_;
  int64_t without_fix_ = 0;
};

// Reference -------------------------------------------------------------------------------------

class ReferenceReader : public RecordReader {
 public:
  ReferenceReader(const ReferenceMapping& mapping, const std::string& path, Notices notices)
      : notices_(std::move(notices)),
        table_(open_mapped_table(path)),
        columns_(mapping, table_, "reference",
                 joined({kPosition, velocity_roles(), {"roll", "pitch", "heading"}})),
        time_(mapping.time, columns_),
        position_(mapping, columns_, path),
        velocity_(VelocityColumns::find(mapping, columns_)),
        to_radians_(angle_factor(mapping.angle_unit)) {
    static const Roles kEuler{"roll", "pitch", "heading"};
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
    if (velocity_ && !velocity_->is_blank(row)) pose.velocity_n = velocity_->velocity(row);
    if (euler_) {
      const Eigen::Vector3d euler = vector(row, *euler_) * to_radians_;
      pose.q_n_v = so3::from_euler({euler.x(), euler.y(), euler.z()});
    }
    pose.t_ns = time_.stamp(row);
    order_.check(row, pose.t_ns);
    return pose;
  }

  Notices notices_;
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

}  // namespace

ImportMapping load_mapping(const MappingSource& source) {
  ImportMapping mapping;
  load_config(source.mapping, mapping);
  naming_mapping(source.mapping, [&] {
    check_lines(mapping.imu, "imu");
    check_lines(mapping.gnss, "gnss");
    check_lines(mapping.reference, "reference");
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

ImportMapping add_tables(const MappingSource& source, const std::optional<std::string>& imu,
                         const std::optional<std::string>& reference, ImportInputs& inputs) {
  if (source.mapping.empty() && (imu || reference)) {
    throw UsageError("--imu and --reference need --mapping, which names their columns");
  }
  ImportMapping mapping = source.mapping.empty() ? ImportMapping{} : load_mapping(source);
  const auto imu_path = input_path(source, imu, mapping.imu.file);
  const auto reference_path = input_path(source, reference, mapping.reference.file);
  naming_mapping(source.mapping, [&] {
    if (imu_path) inputs.imu = make_imu_reader(mapping.imu, *imu_path);
    if (reference_path) {
      inputs.reference = make_reference_reader(mapping.reference, *reference_path);
    }
    inputs.mounting = mapping.imu.mounting();
    inputs.lever_arm_v = mapping.lever_arm();
  });
  inputs.sensor = mapping.imu.sensor;
  inputs.mapping = source.mapping;
  return mapping;
}

std::unique_ptr<RecordReader> make_imu_reader(const ImuMapping& mapping, const std::string& path) {
  const FoundUnits found = with_units(mapping, path);
  return std::make_unique<ImuReader>(found.mapping, path, found.notices);
}

std::unique_ptr<RecordReader> make_gnss_reader(const GnssMapping& mapping,
                                               const std::string& path) {
  GnssMapping found = mapping;
  const Notices notices = find_clock(found, path, "gnss");
  return std::make_unique<GnssReader>(found, path, notices);
}

std::unique_ptr<RecordReader> make_reference_reader(const ReferenceMapping& mapping,
                                                    const std::string& path) {
  ReferenceMapping found = mapping;
  const Notices notices = find_clock(found, path, "reference");
  return std::make_unique<ReferenceReader>(found, path, notices);
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
