#include "foucault/rawlog/import_i2nav.h"

#include <fmt/format.h>

#include <deque>
#include <utility>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "import_run.h"

namespace foucault::rawlog {

using rawlog::RecordReader;
using rawlog::Row;
using rawlog::TextTable;

namespace {

TextTable open_table(const std::string& path,
                     TextTable::Separator separator = TextTable::Separator::space) {
  return TextTable(path, separator, "#%");
}

void require_columns(const Row& row, size_t expected) {
  if (row.size() == expected) return;
  row.fail(fmt::format("{} columns, {} expected; correct or remove the row", row.size(), expected));
}

Eigen::Vector3d vector(const Row& row, size_t first) {
  return {row.number(first), row.number(first + 1), row.number(first + 2)};
}

Eigen::Matrix3d variances(const Row& row, size_t first) {
  const Eigen::Vector3d sigma(row.sigma(first), row.sigma(first + 1), row.sigma(first + 2));
  return sigma.cwiseAbs2().asDiagonal();
}

Geodetic position(const Row& row, size_t first) {
  return rawlog::checked_position(row, row.number(first) * kDegree, row.number(first + 1) * kDegree,
                                  row.number(first + 2));
}

/// Second of week to stamps, across the end of a week.
class WeekClock {
 public:
  /// `week` holds near `near_sow_ns`.
  WeekClock(int64_t week, int64_t near_sow_ns)
      : week_(week), rolling_(kNanosecondsPerWeek, near_sow_ns) {}

  int64_t stamp(const Row& row, size_t column) {
    const int64_t sow_ns = row.scaled(column, kNanosecondDecimals);
    if (sow_ns < 0 || sow_ns > kNanosecondsPerWeek) {
      row.fail(fmt::format("second of week {} lies outside 0 to 604800; correct or remove the row",
                           row.text(column)));
    }
    return rawlog::gps_stamp(row, week_, rolling_.unrolled(sow_ns));
  }

 private:
  int64_t week_;
  rawlog::RollingTime rolling_;
};

class I2navImu : public RecordReader {
 public:
  I2navImu(const std::string& path, WeekClock clock) : table_(open_table(path)), clock_(clock) {}

  const TextTable& table() const override { return table_; }

  std::optional<Record> next() override {
    while (ready_.empty()) {
      const Row* row = table_.next();
      if (row == nullptr) return std::nullopt;
      take(*row);
    }
    Record record = ready_.front();
    ready_.pop_front();
    return record;
  }

 private:
  struct Sample {
    int64_t t_ns = 0;
    Eigen::Vector3d dtheta = Eigen::Vector3d::Zero();
    Eigen::Vector3d dvel = Eigen::Vector3d::Zero();
    std::optional<double> speed;
  };

  Sample parse(const Row& row) {
    constexpr size_t kPlain = 7;
    constexpr size_t kTwoWheels = 9;
    if (columns_ == 0 && (row.size() < kPlain || row.size() > kTwoWheels)) {
      row.fail(fmt::format("{} columns, an IMU file has 7, 8 or 9; check the file", row.size()));
    }
    if (columns_ == 0) columns_ = row.size();
    require_columns(row, columns_);
    Sample sample;
    sample.dtheta = vector(row, 1);
    sample.dvel = vector(row, 4);
    if (columns_ == kTwoWheels) sample.speed = 0.5 * (row.number(7) + row.number(8));
    if (columns_ == kPlain + 1) sample.speed = row.number(7);
    sample.t_ns = clock_.stamp(row, 0);
    order_.check(row, sample.t_ns);
    return sample;
  }

  void take(const Row& row) {
    const Sample sample = parse(row);
    const std::optional<int64_t> length_ns = lengths_.ending_at(sample.t_ns);
    if (!length_ns) {
      first_ = sample;
      return;
    }
    if (first_) put(*first_, *length_ns);
    first_.reset();
    put(sample, *length_ns);
  }

  void put(const Sample& sample, int64_t length_ns) {
    if (sample.speed) ready_.push_back(WheelSpeed{sample.t_ns, *sample.speed});
    ImuIncrement increment;
    increment.t_begin_ns = sample.t_ns - length_ns;
    increment.t_end_ns = sample.t_ns;
    increment.dtheta_b = sample.dtheta;
    increment.dvel_b = sample.dvel;
    ready_.push_back(increment);
  }

  TextTable table_;
  WeekClock clock_;
  rawlog::StampOrder order_;
  size_t columns_ = 0;
  rawlog::IntervalLengths lengths_;
  std::optional<Sample> first_;  ///< waits for its length
  std::deque<Record> ready_;
};

class I2navGnss : public RecordReader {
 public:
  I2navGnss(const std::string& path, WeekClock clock, FixQuality quality)
      : table_(open_table(path)), clock_(clock), quality_(quality) {}

  const TextTable& table() const override { return table_; }

  std::optional<Record> next() override {
    const Row* row = table_.next();
    if (row == nullptr) return std::nullopt;
    return parse(*row);
  }

 private:
  GnssFix parse(const Row& row) {
    constexpr size_t kPlain = 7;
    constexpr size_t kWithVelocity = 13;
    if (columns_ == 0 && row.size() != kPlain && row.size() != kWithVelocity) {
      row.fail(fmt::format("{} columns, a GNSS file has 7 or 13; check the file", row.size()));
    }
    if (columns_ == 0) columns_ = row.size();
    require_columns(row, columns_);
    GnssFix fix;
    fix.antenna = position(row, 1);
    fix.position_covariance = variances(row, 4);
    if (columns_ == kWithVelocity) {
      fix.velocity_n = vector(row, 7);
      fix.velocity_covariance = variances(row, 10);
    }
    fix.quality = quality_;
    fix.t_ns = clock_.stamp(row, 0);
    order_.check(row, fix.t_ns);
    return fix;
  }

  TextTable table_;
  WeekClock clock_;
  FixQuality quality_;
  rawlog::StampOrder order_;
  size_t columns_ = 0;
};

class I2navReference : public RecordReader {
 public:
  explicit I2navReference(const std::string& path) : table_(open_table(path)) {}

  const TextTable& table() const override { return table_; }

  std::optional<Record> next() override {
    const Row* row = table_.next();
    if (row == nullptr) return std::nullopt;
    return parse(*row);
  }

 private:
  ReferencePose parse(const Row& row) {
    constexpr size_t kColumns = 11;
    require_columns(row, kColumns);
    const Eigen::Vector3d euler = vector(row, 8) * kDegree;
    ReferencePose pose;
    pose.position = position(row, 2);
    pose.velocity_n = vector(row, 5);
    pose.q_n_v = so3::from_euler({euler.x(), euler.y(), euler.z()});
    pose.t_ns = rawlog::gps_stamp(row, row.integer(0), row.scaled(1, kNanosecondDecimals));
    order_.check(row, pose.t_ns);
    return pose;
  }

  TextTable table_;
  rawlog::StampOrder order_;
};

class I2navWheel : public RecordReader {
 public:
  I2navWheel(const std::string& path, WeekClock clock)
      : table_(open_table(path, TextTable::Separator::space_or_comma)), clock_(clock) {}

  const TextTable& table() const override { return table_; }
  int64_t without_fix() const override { return blank_; }

  std::optional<Record> next() override {
    constexpr size_t kColumns = 2;
    while (const Row* row = table_.next()) {
      if (std::exchange(first_, false) && is_header(*row)) continue;
      require_columns(*row, kColumns);
      if (!row->is_blank(1)) return parse(*row);
      ++blank_;
    }
    return std::nullopt;
  }

 private:
  static bool is_header(const Row& row) {
    constexpr std::string_view kInNumbers = "+-.0123456789";
    return !row.is_blank(0) && kInNumbers.find(row.text(0).front()) == std::string_view::npos;
  }

  WheelSpeed parse(const Row& row) {
    WheelSpeed wheel;
    wheel.forward = row.number(1);
    wheel.t_ns = clock_.stamp(row, 0);
    order_.check(row, wheel.t_ns);
    return wheel;
  }

  TextTable table_;
  WeekClock clock_;
  rawlog::StampOrder order_;
  bool first_ = true;
  int64_t blank_ = 0;
};

/// A number that stands at the beginning of the first good row.
int64_t first_number(const std::string& path, int decimals, bool skip_bad_rows) {
  TextTable table = open_table(path);
  while (const Row* row = table.next()) {
    try {
      return row->scaled(0, decimals);
    } catch (const rawlog::RowError&) {
      if (!skip_bad_rows) throw;
    }
  }
  throw DataError(fmt::format("'{}' has no usable row", path));
}

int64_t first_week(const I2navImport& options) {
  if (options.gps_week) return *options.gps_week;
  if (!options.reference) {
    throw UsageError("the GPS week is not known: give --gps-week, or a --reference that has it");
  }
  return first_number(*options.reference, 0, options.skip_bad_rows);
}

/// The given week is that of the first IMU row.
WeekClock clock_of(const I2navImport& options) {
  return {first_week(options),
          first_number(options.imu, kNanosecondDecimals, options.skip_bad_rows)};
}

}  // namespace

ImportSummary import_i2nav(const I2navImport& options) {
  const WeekClock clock = clock_of(options);
  rawlog::ImportInputs inputs;
  inputs.imu = std::make_unique<I2navImu>(options.imu, clock);
  inputs.gnss = std::make_unique<I2navGnss>(options.gnss, clock, options.quality);
  if (options.reference) inputs.reference = std::make_unique<I2navReference>(*options.reference);
  if (options.wheel) inputs.wheel = std::make_unique<I2navWheel>(*options.wheel, clock);
  inputs.lever_arm_v = options.lever_arm;
  inputs.sensor.samples = "interval_mean";  // increments
  return rawlog::run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
