#include "csv_readers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <deque>
#include <filesystem>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::rawlog {

namespace fs = std::filesystem;

namespace {

using Roles = std::vector<std::string>;

const Roles kNed{"velocity_north", "velocity_east", "velocity_down"};
const Roles kNeu{"velocity_north", "velocity_east", "velocity_up"};
const Roles kGeodetic{"latitude", "longitude", "height"};
const Roles kLocal{"east", "north", "up"};

Roles joined(std::initializer_list<Roles> parts) {
  Roles all{"time", "week"};
  for (const Roles& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

TextTable::Separator separator_of(const std::string& name) {
  if (name == "semicolon") return TextTable::Separator::semicolon;
  if (name == "tab") return TextTable::Separator::tab;
  if (name == "space") return TextTable::Separator::space;
  return TextTable::Separator::comma;
}

/// A header line is data for the table, even behind a comment sign.
TextTable open_table(const TableMapping& mapping, const std::string& path) {
  return TextTable(path, separator_of(mapping.separator), mapping.header ? "" : "#%");
}

std::optional<size_t> column_number(const std::string& name) {
  size_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool whole = error == std::errc{} && end == name.data() + name.size();
  return whole && number > 0 ? std::optional(number) : std::nullopt;
}

Roles header_names(TextTable& table) {
  const Row* row = table.next();
  if (row == nullptr) throw DataError(fmt::format("'{}' has no header line", table.path()));
  Roles names;
  for (std::string_view field : row->fields()) {
    while (!field.empty() &&
           (field.front() == '#' || field.front() == '%' || field.front() == ' ')) {
      field.remove_prefix(1);
    }
    names.emplace_back(field);
  }
  return names;
}

Eigen::Vector3d vector(const Row& row, const std::array<size_t, 3>& columns) {
  return {row.number(columns[0]), row.number(columns[1]), row.number(columns[2])};
}

std::array<size_t, 3> three(const Columns& columns, const Roles& roles) {
  return {columns.of(roles[0]), columns.of(roles[1]), columns.of(roles[2])};
}

/// Midnight, UTC.
int64_t parse_date(const std::string& date, const std::string& section) {
  const std::optional<int64_t> midnight = midnight_ns(date, "%Y-%m-%d");
  if (midnight) return *midnight;
  throw UsageError(fmt::format("{}.time.date: '{}' is no date; write YYYY-MM-DD", section, date));
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
  check_line(mapping.file, section + ".file");
}

template <class Value>
Value needed(const std::optional<Value>& value, const std::string& section, const char* key,
             const std::string& system) {
  if (value) return *value;
  throw UsageError(
      fmt::format("{}.time.{} is missing; time system '{}' needs it", section, key, system));
}

/// Positions of a table: geodetic, or in a local frame with an origin.
class PositionColumns {
 public:
  template <class Mapping>
  PositionColumns(const Mapping& mapping, const Columns& columns, const std::string& path)
      : local_(columns.has_all(kLocal)),
        columns_(three(columns, local_ ? kLocal : kGeodetic)),
        to_radians_(mapping.angle_unit == "deg" ? kDegree : 1),
        height_offset_(
            height_offset(mapping.height, mapping.geoid_separation_m, columns.section())) {
    if (local_) frame_.emplace(origin_of(mapping.origin, columns.section(), path));
  }

  Geodetic position(const Row& row) const {
    const Eigen::Vector3d p = vector(row, columns_);
    if (local_) return frame_->to_geodetic({p.y(), p.x(), -p.z()});
    return checked_position(row, p.x() * to_radians_, p.y() * to_radians_, p.z() + height_offset_);
  }

 private:
  static Geodetic origin_of(const OriginMapping& origin, const std::string& section,
                            const std::string& path) {
    if (origin.latitude_deg && origin.longitude_deg && origin.height_m) {
      return {*origin.latitude_deg * kDegree, *origin.longitude_deg * kDegree, *origin.height_m};
    }
    throw UsageError(fmt::format(
        "'{}' has positions in a local frame (east, north, up) and no place on Earth: give "
        "{}.origin latitude_deg, longitude_deg and height_m (0.1 deg and 100 m are enough)",
        path, section));
  }

  bool local_;
  std::array<size_t, 3> columns_;
  double to_radians_;
  double height_offset_;
  std::optional<geodesy::LocalFrame> frame_;
};

/// Velocities north, east, down, from three columns.
class VelocityColumns {
 public:
  /// None if the mapping has no such columns.
  static std::optional<VelocityColumns> find(const Columns& columns) {
    if (columns.has_all(kNed)) return VelocityColumns(three(columns, kNed), 1);
    if (columns.has_all(kNeu)) return VelocityColumns(three(columns, kNeu), -1);
    return std::nullopt;
  }

  Eigen::Vector3d velocity(const Row& row) const {
    return vector(row, columns_).cwiseProduct(Eigen::Vector3d(1, 1, down_sign_));
  }

 private:
  VelocityColumns(const std::array<size_t, 3>& columns, double down_sign)
      : columns_(columns), down_sign_(down_sign) {}

  std::array<size_t, 3> columns_;
  double down_sign_;
};

// IMU -------------------------------------------------------------------------------------------

class ImuReader : public RecordReader {
 public:
  ImuReader(const ImuMapping& mapping, const std::string& path)
      : table_(open_table(mapping, path)),
        columns_(mapping, table_, "imu",
                 joined({{"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z",
                          "wheel_speed"}})),
        time_(mapping.time, columns_),
        gyro_(three(columns_, {"gyro_x", "gyro_y", "gyro_z"})),
        accel_(three(columns_, {"accel_x", "accel_y", "accel_z"})),
        gyro_scale_(mapping.gyro_unit == "deg_s" ? kDegree : 1),
        accel_scale_((mapping.accel_sign == "-1" ? -1 : 1) *
                     (mapping.accel_unit == "g" ? kStandardGravity : 1)) {
    if (columns_.has("wheel_speed")) wheel_speed_ = columns_.of("wheel_speed");
  }

  const TextTable& table() const override { return table_; }

  std::optional<Record> next() override {
    if (pending_) {
      const imu::ImuSample sample = *pending_;
      pending_.reset();
      return sample;
    }
    const Row* row = table_.next();
    if (row == nullptr) return std::nullopt;
    const imu::ImuSample sample = parse(*row);
    if (!wheel_speed_) return sample;
    const double speed = row->number(*wheel_speed_);
    pending_ = sample;
    return WheelSpeed{sample.t_ns, speed};
  }

 private:
  imu::ImuSample parse(const Row& row) {
    columns_.check_width(row);
    imu::ImuSample sample;
    sample.gyro_b = vector(row, gyro_) * gyro_scale_;
    sample.accel_b = vector(row, accel_) * accel_scale_;
    if (wheel_speed_) row.number(*wheel_speed_);
    sample.t_ns = time_.stamp(row);
    // Of one stamp but another sample: a burst, see BurstStamps.
    order_.check(row, sample.t_ns,
                 sample.gyro_b != last_.gyro_b || sample.accel_b != last_.accel_b);
    last_ = sample;
    return sample;
  }

  TextTable table_;
  Columns columns_;
  TimeColumn time_;
  std::array<size_t, 3> gyro_;
  std::array<size_t, 3> accel_;
  double gyro_scale_;
  double accel_scale_;
  std::optional<size_t> wheel_speed_;
  StampOrder order_;
  imu::ImuSample last_;
  std::optional<imu::ImuSample> pending_;
};

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
  SigmaColumns(const GnssMapping& mapping, const Columns& columns) {
    static const Roles kThree{"sigma_north", "sigma_east", "sigma_down"};
    static const Roles kTwo{"sigma_horizontal", "sigma_horizontal", "sigma_vertical"};
    if (columns.has_all(kThree)) {
      columns_ = three(columns, kThree);
    } else if (columns.has_all(kTwo)) {
      columns_ = three(columns, kTwo);
    } else if (mapping.sigma_m.size() == 3) {
      constant_ = Eigen::Vector3d(mapping.sigma_m.data());
    } else {
      throw UsageError(
          "gnss: sigmas are missing; name columns sigma_north, sigma_east, sigma_down "
          "(or sigma_horizontal, sigma_vertical), or give sigma_m: [north, east, "
          "down]");
    }
  }

  Eigen::Matrix3d covariance(const Row& row) const {
    if (!columns_) return constant_.cwiseAbs2().asDiagonal();
    Eigen::Vector3d sigma;
    for (size_t i = 0; i < 3; ++i) {
      sigma[static_cast<int>(i)] = row.sigma((*columns_)[i], "gnss.sigma_m");
    }
    return sigma.cwiseAbs2().asDiagonal();
  }

 private:
  std::optional<std::array<size_t, 3>> columns_;
  Eigen::Vector3d constant_ = Eigen::Vector3d::Zero();
};

/// Velocity of a fix with its covariance: a vector, or a speed along a bearing.
class GnssVelocity {
 public:
  GnssVelocity(const GnssMapping& mapping, const Columns& columns) {
    if (!mapping.velocity) return;
    vector_ = VelocityColumns::find(columns);
    if (!vector_ && columns.has("speed") && columns.has("bearing")) {
      speed_ = columns.of("speed");
      bearing_ = columns.of("bearing");
    }
    if (!vector_ && !speed_) return;
    bearing_scale_ = mapping.angle_unit == "deg" ? kDegree : 1;
    if (columns.has("sigma_velocity")) {
      sigma_column_ = columns.of("sigma_velocity");
    } else if (mapping.velocity_sigma_m_s.size() == 3) {
      sigma_ = Eigen::Vector3d(mapping.velocity_sigma_m_s.data());
    } else {
      throw UsageError(
          "gnss: the velocity's sigmas are missing; name a column sigma_velocity, give "
          "velocity_sigma_m_s: [north, east, down], or leave the velocity out with "
          "velocity: false");
    }
  }

  void add_to(GnssFix& fix, const Row& row) const {
    if (!vector_ && !speed_) return;
    fix.velocity_n = vector_ ? vector_->velocity(row) : along_ground(row);
    fix.velocity_covariance = sigma(row).cwiseAbs2().asDiagonal();
  }

 private:
  Eigen::Vector3d along_ground(const Row& row) const {
    const double speed = row.number(*speed_);
    const double bearing = row.number(bearing_) * bearing_scale_;
    return {speed * std::cos(bearing), speed * std::sin(bearing), 0};
  }

  Eigen::Vector3d sigma(const Row& row) const {
    if (!sigma_column_) return sigma_;
    const double sigma = row.sigma(*sigma_column_, "gnss.velocity_sigma_m_s");
    return {sigma, sigma, speed_ ? kOpenVerticalSigma : sigma};
  }

  std::optional<VelocityColumns> vector_;
  std::optional<size_t> speed_;
  size_t bearing_ = 0;
  double bearing_scale_ = kDegree;
  std::optional<size_t> sigma_column_;
  Eigen::Vector3d sigma_ = Eigen::Vector3d::Zero();
};

class GnssReader : public RecordReader {
 public:
  GnssReader(const GnssMapping& mapping, const std::string& path)
      : table_(open_table(mapping, path)),
        columns_(mapping, table_, "gnss",
                 joined({kGeodetic,
                         kLocal,
                         kNed,
                         {"velocity_up", "speed", "bearing", "sigma_velocity", "sigma_north",
                          "sigma_east", "sigma_down", "sigma_horizontal", "sigma_vertical",
                          "quality"}})),
        time_(mapping.time, columns_),
        position_(mapping, columns_, path),
        sigma_(mapping, columns_),
        velocity_(mapping, columns_),
        quality_(mapping, columns_) {}

  const TextTable& table() const override { return table_; }
  int64_t without_fix() const override { return without_fix_; }

  std::optional<Record> next() override {
    while (const Row* row = table_.next()) {
      columns_.check_width(*row);
      const std::optional<FixQuality> quality = quality_.quality(*row);
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
    fix.t_ns = time_.stamp(row);
    order_.check(row, fix.t_ns);
    return fix;
  }

  TextTable table_;
  Columns columns_;
  TimeColumn time_;
  PositionColumns position_;
  SigmaColumns sigma_;
  GnssVelocity velocity_;
  QualityColumn quality_;
  StampOrder order_;
  int64_t without_fix_ = 0;
};

// Reference -------------------------------------------------------------------------------------

class ReferenceReader : public RecordReader {
 public:
  ReferenceReader(const ReferenceMapping& mapping, const std::string& path)
      : table_(open_table(mapping, path)),
        columns_(mapping, table_, "reference",
                 joined({kGeodetic, kLocal, kNed, {"velocity_up", "roll", "pitch", "heading"}})),
        time_(mapping.time, columns_),
        position_(mapping, columns_, path),
        velocity_(VelocityColumns::find(columns_)),
        to_radians_(mapping.angle_unit == "deg" ? kDegree : 1) {
    static const Roles kEuler{"roll", "pitch", "heading"};
    if (columns_.has_all(kEuler)) euler_ = three(columns_, kEuler);
  }

  const TextTable& table() const override { return table_; }

  std::optional<Record> next() override {
    const Row* row = table_.next();
    if (row == nullptr) return std::nullopt;
    return parse(*row);
  }

 private:
  ReferencePose parse(const Row& row) {
    columns_.check_width(row);
    ReferencePose pose;
    pose.position = position_.position(row);
    if (velocity_) pose.velocity_n = velocity_->velocity(row);
    if (euler_) {
      const Eigen::Vector3d euler = vector(row, *euler_) * to_radians_;
      pose.q_n_v = so3::from_euler({euler.x(), euler.y(), euler.z()});
    }
    pose.t_ns = time_.stamp(row);
    order_.check(row, pose.t_ns);
    return pose;
  }

  TextTable table_;
  Columns columns_;
  TimeColumn time_;
  PositionColumns position_;
  std::optional<VelocityColumns> velocity_;
  std::optional<std::array<size_t, 3>> euler_;
  double to_radians_;
  StampOrder order_;
};

}  // namespace

Columns::Columns(const TableMapping& mapping, TextTable& table, const std::string& section,
                 const Roles& roles)
    : section_(section) {
  const Roles header = mapping.header ? header_names(table) : Roles{};
  width_ = header.size();
  for (const auto& [role, name] : mapping.columns) {
    if (std::find(roles.begin(), roles.end(), role) == roles.end()) {
      throw UsageError(fmt::format("{}.columns: '{}' is no role; known: {}", section, role,
                                   fmt::join(roles, ", ")));
    }
    const auto found = std::find(header.begin(), header.end(), name);
    const std::optional<size_t> number = column_number(name);
    if (found != header.end()) {
      index_[role] = static_cast<size_t>(found - header.begin());
    } else if (number && (width_ == 0 || *number <= width_)) {
      index_[role] = *number - 1;
    } else {
      throw UsageError(fmt::format(
          "{}.columns.{}: '{}' has no column '{}'; {}", section, role, table.path(), name,
          header.empty() ? "without a header give its number from 1"
                         : fmt::format("it has {}", fmt::join(header, ", "))));
    }
  }
}

bool Columns::has_all(const Roles& roles) const {
  return std::all_of(roles.begin(), roles.end(), [this](const std::string& r) { return has(r); });
}

size_t Columns::of(const std::string& role) const {
  const auto found = index_.find(role);
  if (found == index_.end()) {
    throw UsageError(fmt::format("{}.columns.{} is missing; name the column", section_, role));
  }
  return found->second;
}

void Columns::check_width(const Row& row) {
  if (width_ == 0) width_ = row.size();
  if (row.size() == width_) return;
  row.fail(fmt::format("{} columns, {} expected; correct or remove the row", row.size(), width_));
}

TimeColumn::TimeColumn(const TimeMapping& mapping, const Columns& columns)
    : time_(columns.of("time")), offset_ns_(nanoseconds(mapping.offset_s)) {
  static const std::map<std::string, int> kDecimals{{"s", 9}, {"ms", 6}, {"us", 3}, {"ns", 0}};
  decimals_ = kDecimals.at(mapping.unit);
  const std::string& system = mapping.system;
  const std::string& section = columns.section();
  if (system == "gps_week_sow") {
    week_column_ = columns.of("week");
  } else if (system == "gps_sow" || system == "boot") {
    week_ = std::llround(needed(mapping.gps_week, section, "gps_week", system));
    if (system == "boot") {
      origin_ns_ = nanoseconds(needed(mapping.boot_sow, section, "boot_sow", system));
    }
  } else if (system != "gps") {
    gps_ = false;
    if (system == "seconds_of_day") origin_ns_ = parse_date(mapping.date, section);
  }
}

int64_t TimeColumn::stamp(const Row& row) const {
  const int64_t time_ns = row.scaled(time_, decimals_) + origin_ns_ + offset_ns_;
  if (!gps_) return checked_stamp(row, time_ns);
  return gps_stamp(row, week_column_ ? row.integer(*week_column_) : week_, time_ns);
}

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

std::unique_ptr<RecordReader> make_imu_reader(const ImuMapping& mapping, const std::string& path) {
  return std::make_unique<ImuReader>(mapping, path);
}

std::unique_ptr<RecordReader> make_gnss_reader(const GnssMapping& mapping,
                                               const std::string& path) {
  return std::make_unique<GnssReader>(mapping, path);
}

std::unique_ptr<RecordReader> make_reference_reader(const ReferenceMapping& mapping,
                                                    const std::string& path) {
  return std::make_unique<ReferenceReader>(mapping, path);
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
