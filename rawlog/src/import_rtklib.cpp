#include "foucault/rawlog/import_rtklib.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include "csv_readers.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/wgs84.h"
#include "pos_reader.h"

namespace foucault::rawlog {

using rawlog::Row;
using rawlog::RowError;
using rawlog::TextTable;

namespace {

/// What stands in the three columns of a position, and along which axes covariances are.
enum class Positions { geodetic, ecef, baseline };

/// Names of the columns follow from the axes: sdn, sdne, vn, sdvn, sdvne ...
struct Layout {
  Positions positions;
  std::array<const char*, 3> names;
  std::string_view axes;
};
const std::array<Layout, 3> kLayouts{{
    {Positions::geodetic, {"latitude", "longitude", "height"}, "neu"},
    {Positions::ecef, {"x-ecef", "y-ecef", "z-ecef"}, "xyz"},
    {Positions::baseline, {"e-baseline", "n-baseline", "u-baseline"}, "enu"},
}};

/// What the comment lines at the head of a .pos file say.
struct PosHeader {
  std::map<std::string, size_t> columns;  ///< name without unit -> column of the rows
  const Layout* layout = nullptr;
  bool dms = false;                   ///< latitude and longitude take three columns each
  bool utc = false;                   ///< else GPS time
  int64_t zone_ns = 0;                ///< clock minus UTC
  std::optional<std::string> height;  ///< ellipsoidal | msl
  std::optional<Geodetic> base;       ///< "ref pos"
  std::optional<std::string> notice;
  bool told = false;  ///< a line names the columns
};

constexpr size_t kTimeColumns = 2;
constexpr size_t kDmsColumns = 3;

void set_columns(const std::vector<std::string_view>& names, PosHeader& header) {
  size_t column = kTimeColumns;
  for (const std::string_view title : names) {
    const size_t unit = title.find('(');
    const bool dms = title.substr(std::min(unit, title.size()), 3) == "(d'";
    header.columns[std::string(title.substr(0, unit))] = column;
    header.dms |= dms;
    column += dms ? kDmsColumns : 1;
  }
  for (const Layout& layout : kLayouts) {
    if (header.columns.count(layout.names[0]) > 0) header.layout = &layout;
  }
}

std::vector<std::string_view> words(std::string_view line) {
  constexpr const char* kBlanks = " \t\r,;%";
  std::vector<std::string_view> found;
  size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const size_t end = line.find_first_of(kBlanks, begin);
    found.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return found;
}

/// "%  GPST   latitude(deg) longitude(deg) ...": the time takes two columns in the rows.
void parse_names(std::string_view line, PosHeader& header) {
  std::vector<std::string_view> names = words(line);
  const bool japan = names[0] == "JST";
  header.utc = names[0] == "UTC" || japan;
  header.zone_ns = japan ? 9 * kSecondsPerHour * kNanosecondsPerSecond : 0;
  names.erase(names.begin());
  header.columns.clear();
  header.dms = false;
  header.told = true;
  set_columns(names, header);
}

/// Degrees, minutes, seconds; the sign is that of the degrees, which may be "-0".
double from_dms(double degrees, double minutes, double seconds) {
  return std::copysign(std::abs(degrees) + minutes / 60 + seconds / kSecondsPerHour, degrees);
}

/// "% ref pos   :  52.1  13.2  75.0", or degrees, minutes, seconds; none if it is in ECEF.
std::optional<Geodetic> parse_base(std::string_view line) {
  std::vector<double> v;
  for (const std::string_view word : words(line.substr(line.find(':') + 1))) {
    double value = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
    if (read.ec != std::errc{} || !std::isfinite(value)) return std::nullopt;
    v.push_back(value);
  }
  if (v.size() == 7) v = {from_dms(v[0], v[1], v[2]), from_dms(v[3], v[4], v[5]), v[6]};
  if (v.size() != 3 || std::abs(v[0]) > 90 || std::abs(v[1]) > 360) return std::nullopt;
  return Geodetic{v[0] * kDegree, v[1] * kDegree, v[2]};
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool is_given(const OriginMapping& origin) {
  return origin.latitude_deg && origin.longitude_deg && origin.height_m;
}

/// Of a file without a header.
[[noreturn]] void fail_without_columns(const std::string& path, const Row& row) {
  if (!row.text(0).empty() && row.text(0).front() == '$') {
    throw DataError(
        fmt::format("'{}' is no .pos file of columns but NMEA; use 'import nmea'", path));
  }
  throw DataError(
      fmt::format("'{}' has no header line with the names of the columns, and not the 15 or 24 "
                  "columns that RTKLIB writes; export with lat/lon/height in degrees and with "
                  "a header, or use 'import csv'",
                  path));
}

/// What a row without a header may be.
enum class Assumed { degrees, dms, ecef, baseline };

Assumed assumed_positions(const std::string& path, const Row& row, bool dms, bool origin) {
  constexpr double kMostDegrees = 720;
  constexpr double kNearest = 6e6;
  if (dms) return Assumed::dms;
  const double x = row.number(kTimeColumns);
  const double y = row.number(kTimeColumns + 1);
  const double z = row.number(kTimeColumns + 2);
  if (std::hypot(x, y, z) > kNearest) return Assumed::ecef;
  if (origin) return Assumed::baseline;
  if (std::abs(x) + std::abs(y) <= kMostDegrees) return Assumed::degrees;
  throw DataError(
      fmt::format("'{}' has no header, and its positions are neither degrees nor ECEF; if they are "
                  "a baseline (east, north, up), give gnss.origin latitude_deg, longitude_deg and "
                  "height_m of the base, else export with lat/lon/height",
                  path));
}

/// The order in which RTKLIB writes its columns, told by their number.
void assume_columns(const std::string& path, const Row& row, bool origin, PosHeader& header) {
  constexpr size_t kDegrees = 15;
  constexpr size_t kVelocity = 9;
  constexpr size_t kDms = kDegrees + 2 * (kDmsColumns - 1);
  const size_t size = row.size();
  const bool dms = size == kDms || size == kDms + kVelocity;
  if (!dms && size != kDegrees && size != kDegrees + kVelocity) fail_without_columns(path, row);
  static const std::map<Assumed, std::array<const char*, 2>> kNames{
      {Assumed::degrees,
       {"lat/lon/height in degrees (if they are a baseline east, north, up, give gnss.origin)",
        "latitude longitude height Q ns sdn sde sdu sdne sdeu sdun age ratio "
        "vn ve vu sdvn sdve sdvu sdvne sdveu sdvun"}},
      {Assumed::dms,
       {"lat/lon/height in degrees, minutes, seconds",
        "latitude(d'\") longitude(d'\") height Q ns sdn sde sdu sdne sdeu sdun age ratio "
        "vn ve vu sdvn sdve sdvu sdvne sdveu sdvun"}},
      {Assumed::ecef,
       {"x/y/z-ecef",
        "x-ecef y-ecef z-ecef Q ns sdx sdy sdz sdxy sdyz sdzx age ratio "
        "vx vy vz sdvx sdvy sdvz sdvxy sdvyz sdvzx"}},
      {Assumed::baseline,
       {"a baseline east, north, up from gnss.origin",
        "e-baseline n-baseline u-baseline Q ns sde sdn sdu sden sdnu sdue age ratio "
        "ve vn vu sdve sdvn sdvu sdven sdvnu sdvue"}}};
  const auto& [what, columns] = kNames.at(assumed_positions(path, row, dms, origin));
  std::vector<std::string_view> names = words(columns);
  if (size < kDegrees + kVelocity) names.resize(names.size() - kVelocity);
  set_columns(names, header);
  header.notice = fmt::format(
      "'{}' has no header: read as RTKLIB's {} in GPS time; if its clock was UTC, give "
      "gnss.time.offset_s (18 since 2017)",
      path, what);
}

void read_comment(std::string_view line, PosHeader& header) {
  if (contains(line, "WGS84/ellipsoidal")) header.height = "ellipsoidal";
  if (contains(line, "WGS84/geodetic")) header.height = "msl";
  if (contains(line, "ref pos")) header.base = parse_base(line);
  for (const Layout& layout : kLayouts) {
    if (contains(line, std::string(layout.names[0]) + "(")) parse_names(line, header);
  }
}

/// The rows of a file, and the header: what its comments say up to them.
class PosRows {
 public:
  explicit PosRows(const std::string& path)
      : table_(path, TextTable::Separator::space_or_comma, "") {}

  /// The next row; none at the end. Columns may be separated by semicolons, too.
  const Row* next() {
    while (const std::optional<std::string_view> line = table_.next_line()) {
      const size_t begin = line->find_first_not_of(" \t\r");
      if (begin == std::string_view::npos) continue;
      if ((*line)[begin] == '%') {
        read_comment(*line, header_);
        continue;
      }
      line_ = *line;
      std::replace(line_.begin(), line_.end(), ';', ' ');
      return &table_.split(line_);
    }
    return nullptr;
  }

  const TextTable& table() const { return table_; }
  PosHeader& header() { return header_; }

 private:
  TextTable table_;
  PosHeader header_;
  std::string line_;
};

/// The header of a file without one, by its first row. Throws DataError if there is no row.
PosHeader first_header(const std::string& path, bool origin) {
  PosRows rows(path);
  const Row* row = rows.next();
  if (row == nullptr) throw DataError(fmt::format("'{}' has no solution in it", path));
  PosHeader& header = rows.header();
  if (!header.told) assume_columns(path, *row, origin, header);
  return header;
}

/// Midnight of a date yyyy/mm/dd.
int64_t pos_date_ns(const Row& row) {
  const std::string date(row.text(0));
  const std::optional<int64_t> midnight = midnight_ns(date, "%Y/%m/%d");
  if (!midnight) row.fail(fmt::format("'{}' is no date; correct or remove the row", date));
  return *midnight;
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
int64_t clock_time_ns(const Row& row) {
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

bool is_positive(const Eigen::Matrix3d& covariance) {
  return covariance.allFinite() && covariance.llt().info() == Eigen::Success;
}

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

/// Where the base of baselines stands: as the mapping says, else as the header does.
std::optional<geodesy::LocalFrame> base_frame(const PosHeader& header, const OriginMapping& origin,
                                              const std::string& path) {
  if (header.layout->positions != Positions::baseline) return std::nullopt;
  if (is_given(origin)) {
    return geodesy::LocalFrame(
        {*origin.latitude_deg * kDegree, *origin.longitude_deg * kDegree, *origin.height_m});
  }
  if (header.base) return geodesy::LocalFrame(*header.base);
  throw DataError(
      fmt::format("'{}' has positions as a baseline and no '% ref pos' with the base's latitude, "
                  "longitude and height; give gnss.origin latitude_deg, longitude_deg, height_m, "
                  "or export with lat/lon/height",
                  path));
}

class PosReader : public rawlog::RecordReader {
 public:
  PosReader(const GnssMapping& mapping, const std::string& path)
      : rows_(path), mapping_(mapping), offset_ns_(nanoseconds(mapping.time.offset_s)) {
    rows_.header() = first_header(path, is_given(mapping.origin));
    if (mapping.sigma_m.size() == 3) sigma_ = Eigen::Vector3d(mapping.sigma_m.data());
    follow_header();
  }

  const TextTable& table() const override { return rows_.table(); }
  int64_t without_fix() const override { return without_fix_; }
  std::vector<std::string> notices() const override {
    return header_.notice ? std::vector{*header_.notice} : std::vector<std::string>{};
  }

  std::optional<Record> next() override {
    while (const Row* row = rows_.next()) {
      if (rows_.header().told) follow_header();
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
  /// As the lines before the row say, where files were joined in their middle, too.
  void follow_header() {
    rows_.header().told = false;
    header_ = rows_.header();
    const bool geodetic = header_.layout->positions == Positions::geodetic;
    const std::string height =
        geodetic ? header_.height.value_or(mapping_.height) : std::string("ellipsoidal");
    height_offset_ = rawlog::height_offset(height, mapping_.geoid_separation_m, "gnss");
    base_ = base_frame(header_, mapping_.origin, table().path());
    velocity_ = mapping_.velocity && has_all("v");
    columns_ = 0;
    for (const char* name : header_.layout->names) column(name);
    for (const char axis : header_.layout->axes) column(std::string("sd") + axis);
    if (!velocity_ || has_all("sdv")) return;
    if (mapping_.velocity_sigma_m_s.size() != 3) {
      throw UsageError(
          fmt::format("'{}' has velocities without sigmas; give "
                      "gnss.velocity_sigma_m_s: [north, east, down] or velocity: false",
                      table().path()));
    }
    velocity_sigma_ = Eigen::Vector3d(mapping_.velocity_sigma_m_s.data());
  }

  bool has(const std::string& name) const { return header_.columns.count(name) > 0; }

  /// Of all three axes.
  bool has_all(const std::string& prefix) const {
    const std::string_view axes = header_.layout->axes;
    return std::all_of(axes.begin(), axes.end(), [&](char axis) { return has(prefix + axis); });
  }

  size_t column(const std::string& name) const {
    const auto found = header_.columns.find(name);
    if (found != header_.columns.end()) return found->second;
    throw DataError(
        fmt::format("'{}' has no column '{}'; export it with RTKLIB", table().path(), name));
  }

  int64_t stamp(const Row& row) const {
    const bool date = row.text(0).find('/') != std::string_view::npos;
    // Week and seconds, like the date, are of the clock that the header names.
    const int64_t week = date ? 0 : row.integer(0);
    const int64_t tow_ns = offset_ns_ + (date ? pos_date_ns(row) + clock_time_ns(row) - kGpsEpochNs
                                              : row.scaled(1, kNanosecondDecimals));
    if (!header_.utc) return gps_stamp(row, week, tow_ns);
    const GpsTime clock = checked_gps_time(row, week, tow_ns);
    return checked_stamp(
        row, kGpsEpochNs + clock.week * kNanosecondsPerWeek + clock.tow_ns - header_.zone_ns);
  }

  Eigen::Vector3d along_axes(const Row& row, const std::string& prefix) const {
    const std::string_view axes = header_.layout->axes;
    return {row.number(column(prefix + axes[0])), row.number(column(prefix + axes[1])),
            row.number(column(prefix + axes[2]))};
  }

  /// The column of what two axes have in common; RTKLIB calls sdun sdue where angles are in
  /// degrees, minutes, seconds.
  std::optional<size_t> common_column(const std::string& prefix, int from, int to) const {
    const std::string_view axes = header_.layout->axes;
    std::string name = prefix + axes[from] + axes[to];
    if (!has(name) && name == "sdun") name = "sdue";
    return has(name) ? std::optional(column(name)) : std::nullopt;
  }

  /// Along the axes of the file: from columns like sdn, sde, sdu and, if there, sdne, sdeu, sdun.
  /// These are rounded, and RTKLIB loses digits: an ambiguity-fixed covariance is what remains of a
  /// variance of (30 m)^2, a sigma among it may be zero. Where small ones do not fit together,
  /// sigmas are that much larger.
  Eigen::Matrix3d covariance(const Row& row, const std::string& prefix) const {
    constexpr double kRounding = 1e-4;
    constexpr double kLostDigits = 3e-3;
    std::array<std::optional<size_t>, 3> common;
    for (int i = 0; i < 3; ++i) common[i] = common_column(prefix, i, (i + 1) % 3);
    const bool full = common[0] && common[1] && common[2];
    const Eigen::Vector3d sigma = sigmas(row, prefix, full);
    Eigen::Matrix3d covariance = sigma.cwiseAbs2().asDiagonal();
    if (!full) return covariance;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      covariance(i, j) = covariance(j, i) = signed_square(row.number(*common[i]));
    }
    if (is_positive(covariance)) return covariance;
    covariance.diagonal() = (sigma.array() + kRounding).square();
    if (is_positive(covariance)) return covariance;
    covariance.diagonal() = sigma.array().square() + kLostDigits * kLostDigits;
    if (is_positive(covariance)) return covariance;
    row.fail("the covariance is not positive; correct or remove the row");
  }

  /// One or two may be zero beside what they have in common with others.
  Eigen::Vector3d sigmas(const Row& row, const std::string& prefix, bool full) const {
    Eigen::Vector3d sigma = along_axes(row, prefix);
    const auto common = [&](int i) { return row.number(*common_column(prefix, i, (i + 1) % 3)); };
    for (int i = 0; i < 3; ++i) {
      const bool may_be_zero = full && sigma.maxCoeff() > 0 && sigma[i] == 0 &&
                               (common(i) != 0 || common((i + 2) % 3) != 0);
      if (!may_be_zero) sigma[i] = row.sigma(column(prefix + header_.layout->axes[i]));
    }
    return sigma;
  }

  Geodetic position(const Row& row) const {
    const auto& names = header_.layout->names;
    if (header_.layout->positions == Positions::geodetic) {
      check_degrees(row);
      return checked_position(row, angle(row, column(names[0])), angle(row, column(names[1])),
                              row.number(column(names[2])) + height_offset_);
    }
    const Eigen::Vector3d p(row.number(column(names[0])), row.number(column(names[1])),
                            row.number(column(names[2])));
    constexpr double kNearest = 6e6;
    constexpr double kFarthest = 1e8;
    if (p.norm() > kFarthest || (!base_ && p.norm() < kNearest)) {
      row.fail(
          fmt::format("{} {:.3f}, {} {:.3f}, {} {:.3f} m are no place on Earth; correct or "
                      "remove the row",
                      names[0], p.x(), names[1], p.y(), names[2], p.z()));
    }
    return base_ ? base_->to_geodetic({p.y(), p.x(), -p.z()}) : geodesy::wgs84::ecef_to_geodetic(p);
  }

  /// Without a header, a baseline of up to 90 m looks like degrees.
  void check_degrees(const Row& row) const {
    constexpr double kPole = 90;
    const double latitude = row.number(column("latitude"));
    if (!header_.notice || std::abs(latitude) <= kPole) return;
    row.fail(fmt::format(
        "latitude {:.4f} is no place on Earth; the file has no header: if its positions "
        "are a baseline (east, north, up), give gnss.origin latitude_deg, longitude_deg "
        "and height_m of the base, else correct or remove the row",
        latitude));
  }

  double angle(const Row& row, size_t first) const {
    if (!header_.dms) return row.number(first) * kDegree;
    return from_dms(row.number(first), row.number(first + 1), row.number(first + 2)) * kDegree;
  }

  /// Axes of the file to north, east, down of a position.
  Eigen::Matrix3d to_ned(const Geodetic& position) const {
    if (header_.layout->positions == Positions::ecef) {
      return geodesy::wgs84::R_e_n(position.latitude, position.longitude).transpose();
    }
    if (!base_) return Eigen::Vector3d(1, 1, -1).asDiagonal();
    Eigen::Matrix3d enu_to_ned;
    enu_to_ned << 0, 1, 0, 1, 0, 0, 0, 0, -1;
    return base_->R_w_n(position).transpose() * enu_to_ned;
  }

  GnssFix parse(const Row& row, int64_t q) {
    GnssFix fix;
    fix.quality = q < 0 ? FixQuality::unknown : quality_of(q, row);
    fix.antenna = position(row);
    const Eigen::Matrix3d R = to_ned(fix.antenna);
    fix.position_covariance = position_covariance(row, R);
    if (velocity_) {
      fix.velocity_n = R * along_axes(row, "v");
      fix.velocity_covariance = velocity_sigma_
                                    ? Eigen::Matrix3d(velocity_sigma_->cwiseAbs2().asDiagonal())
                                    : R * covariance(row, "sdv") * R.transpose();
    }
    fix.details = details(row);
    fix.t_ns = stamp(row);
    order_.check(row, fix.t_ns);
    return fix;
  }

  /// Along north, east, down; sigmas that are all zero were rounded.
  Eigen::Matrix3d position_covariance(const Row& row, const Eigen::Matrix3d& R) const {
    if (!along_axes(row, "sd").isZero(0)) return R * covariance(row, "sd") * R.transpose();
    if (sigma_) return sigma_->cwiseAbs2().asDiagonal();
    row.fail(
        "its sigmas are zero; give gnss.sigma_m: [north, east, down] for rows like this, or "
        "correct or remove the row");
  }

  /// Zero: not told.
  FixDetails details(const Row& row) const {
    FixDetails details;
    const double satellites = has("ns") ? row.number(column("ns")) : 0;
    const double age = has("age") ? row.number(column("age")) : 0;
    if (satellites > 0 && satellites < 256) details.satellites = static_cast<int>(satellites);
    if (age > 0) details.correction_age = age;
    return details;
  }

  PosRows rows_;
  PosHeader header_;  ///< of the rows that are read
  GnssMapping mapping_;
  double height_offset_ = 0;
  std::optional<geodesy::LocalFrame> base_;
  int64_t offset_ns_;
  bool velocity_ = false;
  std::optional<Eigen::Vector3d> sigma_, velocity_sigma_;
  size_t columns_ = 0;
  rawlog::StampOrder order_;
  int64_t without_fix_ = 0;
};

}  // namespace

std::unique_ptr<RecordReader> make_pos_reader(const GnssMapping& mapping, const std::string& path) {
  return std::make_unique<PosReader>(mapping, path);
}

ImportSummary import_rtklib(const RtklibImport& options) {
  const rawlog::MappingSource source{options.mapping, options.data_dir};
  ImportInputs inputs;
  const ImportMapping mapping =
      add_tables(source, {options.imu, options.reference, options.wheel}, inputs);
  const auto gnss = input_path(source, options.gnss, mapping.gnss.file);
  const bool imu = inputs.imu != nullptr;
  if (!imu || !gnss) {
    throw UsageError(fmt::format("no {} file: give --{}, or {}.file in '{}'", imu ? ".pos" : "IMU",
                                 imu ? "gnss" : "imu", imu ? "gnss" : "imu", options.mapping));
  }
  naming_mapping(options.mapping, [&] { inputs.gnss = make_pos_reader(mapping.gnss, *gnss); });
  if (options.lever_arm) inputs.lever_arm_v = options.lever_arm;
  return rawlog::run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
