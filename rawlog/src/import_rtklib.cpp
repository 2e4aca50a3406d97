#include "foucault/rawlog/import_rtklib.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <ctime>
#include <map>

#include "csv_readers.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"

namespace foucault::rawlog {

using rawlog::Row;
using rawlog::RowError;
using rawlog::TextTable;

namespace {

/// What the comment lines at the head of a .pos file say.
struct PosHeader {
  std::map<std::string, size_t> columns;  ///< name without unit -> column of the rows
  bool utc = false;
  std::optional<std::string> height;  ///< ellipsoidal | msl
};

/// "%  GPST   latitude(deg) longitude(deg) ...": the time takes two columns in the rows.
void parse_names(std::string_view line, PosHeader& header) {
  constexpr size_t kTimeColumns = 2;
  constexpr const char* kBlanks = " \t\r,%";
  size_t column = kTimeColumns;
  size_t begin = line.find_first_not_of(kBlanks);
  header.utc = line.substr(begin, 3) == "UTC";
  begin = line.find_first_of(kBlanks, begin);
  begin = line.find_first_not_of(kBlanks, begin);
  while (begin != std::string_view::npos) {
    const size_t end = line.find_first_of(kBlanks, begin);
    const std::string_view name = line.substr(begin, end - begin);
    header.columns[std::string(name.substr(0, name.find('(')))] = column++;
    begin = line.find_first_not_of(kBlanks, end);
  }
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

[[noreturn]] void fail_format(const std::string& path, const std::string& what) {
  throw DataError(
      fmt::format("'{}': {}; export with lat/lon/height in degrees, in GPST or UTC", path, what));
}

PosHeader read_header(const std::string& path) {
  TextTable table(path, TextTable::Separator::space_or_comma, "");
  PosHeader header;
  while (const std::optional<std::string_view> line = table.next_line()) {
    if (line->empty()) continue;
    if (line->front() != '%') break;
    if (contains(*line, "WGS84/ellipsoidal")) header.height = "ellipsoidal";
    if (contains(*line, "WGS84/geodetic")) header.height = "msl";
    if (contains(*line, "latitude(deg)")) parse_names(*line, header);
    if (contains(*line, "latitude(d'")) fail_format(path, "positions in degrees, minutes, seconds");
    if (contains(*line, "x-ecef")) fail_format(path, "positions in ECEF");
    if (contains(*line, "e-baseline")) fail_format(path, "positions as a baseline");
    if (contains(*line, "  JST")) fail_format(path, "times in JST");
  }
  if (header.columns.empty()) fail_format(path, "no header line with the names of the columns");
  return header;
}

/// Days from 1970-01-01 to a date yyyy/mm/dd, as nanoseconds.
int64_t date_ns(const Row& row) {
  const std::string date(row.text(0));
  std::tm day{};
  const char* end = strptime(date.c_str(), "%Y/%m/%d", &day);
  if (end == nullptr || *end != '\0' || day.tm_year < 50 || day.tm_year > 250) {
    row.fail(fmt::format("'{}' is no date; correct or remove the row", date));
  }
  return static_cast<int64_t>(timegm(&day)) * kNanosecondsPerSecond;
}

/// Takes a number of [0, end) off the front, and the delimiter behind it; without one, the number
/// is all there is.
template <class Number>
std::optional<Number> take(std::string_view& text, std::string_view delimiter, Number end) {
  Number value{};
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc{} || !(value >= 0 && value < end)) return std::nullopt;
  text.remove_prefix(static_cast<size_t>(read.ptr - text.data()));
  if (delimiter.empty() ? !text.empty() : text.substr(0, delimiter.size()) != delimiter) {
    return std::nullopt;
  }
  text.remove_prefix(delimiter.size());
  return value;
}

/// hh:mm:ss.sss as nanoseconds; the last second of a day may be a leap second.
int64_t time_of_day_ns(const Row& row) {
  std::string_view text = row.text(1);
  const std::optional<int> hours = take(text, ":", 24);
  const std::optional<int> minutes = hours ? take(text, ":", 60) : std::nullopt;
  const std::optional<double> seconds = minutes ? take(text, "", 61.0) : std::nullopt;
  if (!seconds) {
    row.fail(fmt::format("'{}' is no time of day; correct or remove the row", row.text(1)));
  }
  return (*hours * kSecondsPerHour + *minutes * 60) * kNanosecondsPerSecond + nanoseconds(*seconds);
}

/// +-sqrt(|covariance|), as RTKLIB writes it, to the covariance.
double signed_square(double root) { return root * std::abs(root); }

FixQuality quality_of(int64_t q, const Row& row) {
  switch (q) {
    case 1:
      return FixQuality::fixed_rtk;
    case 2:
      return FixQuality::float_rtk;
    case 3:  // SBAS
    case 4:  // DGPS
      return FixQuality::differential;
    case 5:
      return FixQuality::single;
    case 6:
      return FixQuality::ppp;
    default:
      row.fail(
          fmt::format("quality {} is none of RTKLIB's (1 to 6); correct or remove the row", q));
  }
}

class PosReader : public rawlog::RecordReader {
 public:
  PosReader(const GnssMapping& mapping, const std::string& path)
      : table_(path, TextTable::Separator::space_or_comma, "%"),
        header_(read_header(path)),
        height_offset_(rawlog::height_offset(header_.height.value_or(mapping.height),
                                             mapping.geoid_separation_m, "gnss")),
        offset_ns_(nanoseconds(mapping.time.offset_s)),
        velocity_(mapping.velocity && has("vn") && has("ve") && has("vu")) {
    for (const char* name : {"latitude", "longitude", "height", "sdn", "sde", "sdu"}) column(name);
    if (!velocity_ || has("sdvn")) return;
    if (mapping.velocity_sigma_m_s.size() != 3) {
      throw UsageError(
          fmt::format("'{}' has velocities without sigmas; give "
                      "gnss.velocity_sigma_m_s: [north, east, down] or velocity: false",
                      path));
    }
    velocity_sigma_ = Eigen::Vector3d(mapping.velocity_sigma_m_s.data());
  }

  const TextTable& table() const override { return table_; }
  int64_t without_fix() const override { return without_fix_; }

  std::optional<Record> next() override {
    while (const Row* row = table_.next()) {
      if (columns_ == 0) columns_ = row->size();
      if (row->size() != columns_) {
        row->fail(fmt::format("{} columns, {} expected; correct or remove the row", row->size(),
                              columns_));
      }
      const int64_t q = has("Q") ? row->integer(column("Q")) : -1;
      if (q != 0) return parse(*row, q);
      ++without_fix_;
    }
    return std::nullopt;
  }

 private:
  bool has(const std::string& name) const { return header_.columns.count(name) > 0; }

  size_t column(const std::string& name) const {
    const auto found = header_.columns.find(name);
    if (found != header_.columns.end()) return found->second;
    throw DataError(
        fmt::format("'{}' has no column '{}'; export it with RTKLIB", table_.path(), name));
  }

  int64_t stamp(const Row& row) const {
    if (row.text(0).find('/') == std::string_view::npos) {
      const int64_t tow_ns = row.scaled(1, kNanosecondDecimals) + offset_ns_;
      return rawlog::gps_stamp(row, row.integer(0), tow_ns);
    }
    const int64_t t_ns = date_ns(row) + time_of_day_ns(row) + offset_ns_;
    return header_.utc ? rawlog::checked_stamp(row, t_ns)
                       : rawlog::gps_stamp(row, 0, t_ns - kGpsEpochNs);
  }

  /// North, east, down from columns like sdn, sde, sdu and, if there, sdne, sdeu, sdun.
  Eigen::Matrix3d covariance(const Row& row, const std::string& prefix) const {
    const Eigen::Vector3d sigma(row.sigma(column(prefix + "n")), row.sigma(column(prefix + "e")),
                                row.sigma(column(prefix + "u")));
    Eigen::Matrix3d covariance = sigma.cwiseAbs2().asDiagonal();
    if (!has(prefix + "ne") || !has(prefix + "eu") || !has(prefix + "un")) return covariance;
    covariance(0, 1) = signed_square(row.number(column(prefix + "ne")));
    covariance(1, 2) = -signed_square(row.number(column(prefix + "eu")));  // up to down
    covariance(0, 2) = -signed_square(row.number(column(prefix + "un")));
    covariance.triangularView<Eigen::StrictlyLower>() = covariance.transpose();
    if (covariance.determinant() <= 0) {
      row.fail("the covariance is not positive; correct or remove the row");
    }
    return covariance;
  }

  GnssFix parse(const Row& row, int64_t q) {
    GnssFix fix;
    fix.quality = q < 0 ? FixQuality::unknown : quality_of(q, row);
    fix.antenna = rawlog::checked_position(row, row.number(column("latitude")) * kDegree,
                                           row.number(column("longitude")) * kDegree,
                                           row.number(column("height")) + height_offset_);
    fix.position_covariance = covariance(row, "sd");
    if (velocity_) {
      fix.velocity_n = Eigen::Vector3d(row.number(column("vn")), row.number(column("ve")),
                                       -row.number(column("vu")));
      fix.velocity_covariance = velocity_sigma_
                                    ? Eigen::Matrix3d(velocity_sigma_->cwiseAbs2().asDiagonal())
                                    : covariance(row, "sdv");
    }
    fix.t_ns = stamp(row);
    order_.check(row, fix.t_ns);
    return fix;
  }

  TextTable table_;
  PosHeader header_;
  double height_offset_;
  int64_t offset_ns_;
  bool velocity_;
  std::optional<Eigen::Vector3d> velocity_sigma_;
  size_t columns_ = 0;
  rawlog::StampOrder order_;
  int64_t without_fix_ = 0;
};

}  // namespace

ImportSummary import_rtklib(const RtklibImport& options) {
  const rawlog::MappingSource source{options.mapping, options.data_dir};
  const ImportMapping mapping = rawlog::load_mapping(source);
  const auto imu = rawlog::input_path(source, options.imu, mapping.imu.file);
  const auto gnss = rawlog::input_path(source, options.gnss, mapping.gnss.file);
  const auto reference = rawlog::input_path(source, options.reference, mapping.reference.file);
  if (!imu || !gnss) {
    throw UsageError(fmt::format("no {} file: give --{}, or {}.file in '{}'", imu ? ".pos" : "IMU",
                                 imu ? "gnss" : "imu", imu ? "gnss" : "imu", options.mapping));
  }
  rawlog::ImportInputs inputs;
  rawlog::naming_mapping(options.mapping, [&] {
    inputs.imu = rawlog::make_imu_reader(mapping.imu, *imu);
    inputs.gnss = std::make_unique<PosReader>(mapping.gnss, *gnss);
    if (reference) inputs.reference = rawlog::make_reference_reader(mapping.reference, *reference);
    inputs.mounting = mapping.imu.mounting();
  });
  inputs.mapping = options.mapping;
  inputs.lever_arm_v = options.lever_arm.value_or(mapping.lever_arm_m);
  return rawlog::run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
